"""`Guard`: who may talk to the studio."""

import re
from ipaddress import ip_address
from secrets import compare_digest
from urllib.parse import parse_qs

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from hydrostat.studio.face.class_code import CODE_LIFETIME

LOOPBACK = ("127.0.0.1", "localhost", "[::1]")  # names of this machine that a page may have
COOKIE = "hydrostat_token"  # followed by the port: cookies do not know ports, and two studios may run on one machine
MAX_REQUEST_BYTES = 200_000_000  # no request has more bytes

_ROOM = re.compile(r"/(room|watch|class)/[A-Za-z0-9_-]+")  # what a link with a token may lead to, beside the front
_TYPED = re.compile(r"/[^/.]+")  # a path that may be meant as a code

SAFE_HEADERS = {
    "content-security-policy": (
        "default-src 'self' data: blob: 'unsafe-inline' 'unsafe-eval'; object-src 'none'; base-uri 'none'; "
        "form-action 'self'; frame-ancestors 'none'"
    ),
    "cross-origin-resource-policy": "same-origin",
    "referrer-policy": "same-origin",
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
}
"""No other page may frame this one or read of it, and it loads nothing from elsewhere. The page needs scripts within
it and evaluation of templates. A policy of no referrer at all would make browsers hide the origin of our own forms."""

NO_TOKEN = "token missing. Open the address that the studio printed"

WELCOME = """<!doctype html><meta charset="utf-8"><title>hydrostat</title>
<noscript><meta http-equiv="refresh" content="0;url={0}"></noscript>
<script>location.replace("{0}" + location.hash)</script>"""
"""Goes on to the page. A redirection would not do: after a link of another page it goes without the strict cookie.
What stands after "#" goes along."""


ASK_CODE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>hydrostat</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<body style="font: 18px system-ui, sans-serif; max-width: 320px; margin: 20vh auto; padding: 0 24px">
<form><p><label for="code">Class code, from the board</label></p>
<input id="code" name="token" required autofocus autocomplete="off" autocapitalize="off" spellcheck="false"
 style="font: inherit; padding: 10px; width: 9em"> <button style="font: inherit; padding: 10px">Start</button>
<p role="alert">{0}</p></form></html>"""
"""Asks for the code of a class, at the address that was asked for, so that a link of a room leads there."""


class Guard:
    """Stands before every request: other pages in the same browser, other names of this machine and strangers stay out.

    A page of another site can send requests to 127.0.0.1, or give its own name that address (DNS rebinding): so the
    name asked for (`Host`) must be ours, and the page that asks (`Origin`, `Sec-Fetch-Site`) this one. Where the studio
    can be reached from other machines, the token must come along: in the address at first, then as a cookie.
    """

    def __init__(
        self,
        app: ASGIApp,
        *,
        port: int,
        names: tuple[str, ...] = LOOPBACK,
        token: str | None = None,
        coded: bool = False,
        largest: int = MAX_REQUEST_BYTES,
    ) -> None:
        """Guard an app at a port, by names of this machine in its address; no request has more bytes than `largest`.

        With a token, which requests must bring then, any numeric address will do as a name: only what has letters can
        be made to mean another machine. If `coded`, the token is a code: the path of the address may be the code, its
        letters may be large, and browsers without it see a form.
        """
        self._coded = coded
        self._app, self._token, self._port, self._largest = app, token, port, largest
        self._cookie = f"{COOKIE}_{port}"
        self._names = {name.lower() for name in names}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what is allowed."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        reason = "Bad request" if scope["type"] not in ("http", "websocket") else ""
        reason = reason or self._refusal(scope, headers)
        if reason == NO_TOKEN and self._coded and scope["type"] == "http":
            is_wrong = "token" in _query(scope) or _TYPED.fullmatch(scope["path"])
            words = "Wrong code. Try again." if is_wrong else ""
            page = HTMLResponse(ASK_CODE.format(words), status_code=403, headers={"cache-control": "no-store"})
            await page(scope, receive, _with_headers(send))
        elif reason:
            await _refuse(scope, receive, send, reason)
        elif scope["type"] == "websocket":
            await self._app(scope, receive, send)
        elif self._token is not None and ("token" in _query(scope) or self._is_code(scope["path"][1:])):
            await self._welcome(scope["path"])(scope, receive, _with_headers(send))
        else:
            body = _Body(receive, _with_headers(send), self._largest)
            await body.serve(self._app, scope)

    def _refusal(self, scope: Scope, headers: Headers) -> str:
        """Why a request is not passed on; "" if it is."""
        hosts, origins = headers.getlist("host"), headers.getlist("origin")
        if len(hosts) != 1 or not self._is_ours(hosts[0].lower()):
            return "unknown host name. Open the address that the studio printed"
        if origins not in ([], [f"http://{hosts[0].lower()}"]) or not _is_near(scope, headers):
            return "request from another page rejected"
        lengths = headers.getlist("content-length")
        if len(lengths) > 1 or any(not _is_count(text) or int(text) > self._largest for text in lengths):
            return "request too large"
        if self._token is not None and not self._brings_token(scope, headers):
            return NO_TOKEN
        return ""

    def _is_ours(self, host: str) -> bool:
        """Return True if a host, such as "localhost:8000", is this studio."""
        name, port = host, "80"
        if not host.endswith("]") and ":" in host:
            name, _, port = host.rpartition(":")
        known = name in self._names or (self._token is not None and _is_number(name))
        return known and port == str(self._port)

    def _brings_token(self, scope: Scope, headers: Headers) -> bool:
        cookies = [part.strip() for text in headers.getlist("cookie") for part in text.split(";")]
        given = [part.partition("=")[2] for part in cookies if part.partition("=")[0] == self._cookie]
        given += [*_query(scope).get("token", []), *([scope["path"][1:]] if self._coded else [])]
        return any(self._is_token(text) for text in given)

    def _is_token(self, text: str) -> bool:
        text = text.strip().lower() if self._coded else text
        return compare_digest(text.encode(errors="replace"), (self._token or "").encode())

    def _is_code(self, text: str) -> bool:
        return self._coded and self._is_token(text)

    def _welcome(self, path: str) -> Response:
        """Keeps the token as a cookie and goes to the page, so that it does not stay in the address."""
        here = path if _ROOM.fullmatch(path) else "/"
        response = HTMLResponse(WELCOME.format(here), headers={"cache-control": "no-store"})
        lasts = CODE_LIFETIME if self._coded else None  # pupils need not type the code again in the next lesson
        response.set_cookie(self._cookie, self._token or "", httponly=True, samesite="strict", max_age=lasts)
        return response


class _Body:
    """A request whose body is counted: one that never ends is cut off."""

    def __init__(self, receive: Receive, send: Send, largest: int) -> None:
        self._receive, self._send, self._left = receive, send, largest
        self._began, self._cut = False, False

    async def serve(self, app: ASGIApp, scope: Scope) -> None:
        """Answer it."""
        try:
            await app(scope, self._read, self._answer)
        except Exception:
            if not self._cut:
                raise

    async def _read(self) -> Message:
        if self._cut:
            return {"type": "http.disconnect"}
        message = await self._receive()
        self._left -= len(message.get("body", b""))
        if self._left >= 0:
            return message
        self._cut = True
        if not self._began:
            start = {"type": "http.response.start", "status": 413, "headers": [(b"connection", b"close")]}
            await self._send(start)
            await self._send({"type": "http.response.body", "body": b"hydrostat: that is too much to send\n"})
        return {"type": "http.disconnect"}

    async def _answer(self, message: Message) -> None:
        self._began = True
        if not self._cut:
            await self._send(message)


def _is_near(scope: Scope, headers: Headers) -> bool:
    """Return True if, as a browser says, our own page asks, or nobody, or a person who follows a link to the page."""
    sites = headers.getlist("sec-fetch-site")
    follows = scope["type"] == "http" and scope["method"] == "GET" and headers.get("sec-fetch-dest") == "document"
    return all(site in ("same-origin", "none") for site in sites) or (follows and "origin" not in headers)


def _is_count(text: str) -> bool:
    return text.isascii() and text.isdecimal() and len(text) < 16


def _is_number(name: str) -> bool:
    """Return True if a name of a machine is an address in numbers."""
    try:
        ip_address(name[1:-1] if name.startswith("[") and name.endswith("]") else name)
    except ValueError:
        return False
    return True


def _query(scope: Scope) -> dict[str, list[str]]:
    return parse_qs(scope.get("query_string", b"").decode("latin-1"), errors="replace")


def _with_headers(send: Send) -> Send:
    """The same, with headers that keep other pages out."""

    async def add_headers(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(raw=list(message.get("headers", [])))
            headers.update(SAFE_HEADERS)
            message = {**message, "headers": headers.raw}
        await send(message)

    return add_headers


async def _refuse(scope: Scope, receive: Receive, send: Send, reason: str) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008, "reason": reason})
    elif scope["type"] == "http":
        await PlainTextResponse(f"hydrostat: {reason}\n", status_code=403)(scope, receive, _with_headers(send))
