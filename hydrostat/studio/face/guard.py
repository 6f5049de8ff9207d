"""`Guard`: who may talk to the studio."""

from http.cookies import SimpleCookie
from secrets import compare_digest
from urllib.parse import parse_qs, urlsplit

from starlette.responses import PlainTextResponse, RedirectResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
"""Names of this machine that a page may have."""

COOKIE = "hydrostat_token"

LARGEST = 200_000_000
"""No request has more bytes."""


class Guard:
    """Stands before every request: other pages in the same browser, other names of this machine and strangers stay out.

    A page of another site can send requests to 127.0.0.1, or give its own name that address (DNS rebinding): so the
    name asked for (`Host`) and the page that asks (`Origin`) must be ours. Where the studio can be reached from other
    machines, the token must come along: in the address at first, then as a cookie.
    """

    def __init__(self, app: ASGIApp, *, port: int, names: tuple[str, ...] = LOOPBACK, token: str | None = None) -> None:
        """Guard an app.

        Args:
            app: that is guarded.
            port: that it is reached at.
            names: of this machine, as in the address of the page.
            token: that requests must bring; None: none.
        """
        self._app, self._token = app, token
        self._hosts = {f"{name}:{port}" for name in names} | ({*names} if port == 80 else set())

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what is allowed."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = {key.decode("latin-1").lower(): value.decode("latin-1") for key, value in scope["headers"]}
        reason = self._refusal(scope, headers)
        if reason:
            await _refuse(scope, receive, send, reason)
            return
        if self._token is not None and scope["type"] == "http" and "token" in _query(scope):
            response = RedirectResponse(scope["path"], status_code=303)
            response.set_cookie(COOKIE, self._token, httponly=True, samesite="strict")
            await response(scope, receive, send)
            return
        await self._app(scope, _counted(receive), send)

    def _refusal(self, scope: Scope, headers: dict[str, str]) -> str:
        """Why a request is not passed on; "" if it is."""
        if headers.get("host", "").lower() not in self._hosts:
            return "this studio is not reached by that name"
        origin = headers.get("origin")
        if origin is not None and urlsplit(origin).netloc.lower() not in self._hosts:
            return "another page may not use this studio"
        if headers.get("content-length", "0").isdigit() and int(headers.get("content-length", "0")) > LARGEST:
            return "that is too much to send"
        if self._token is not None and not self._brings_token(scope, headers):
            return "open the address that the studio printed: it has a token"
        return ""

    def _brings_token(self, scope: Scope, headers: dict[str, str]) -> bool:
        cookie: SimpleCookie = SimpleCookie()
        try:
            cookie.load(headers.get("cookie", ""))
        except Exception:  # noqa: BLE001 a cookie of whatever kind is no token
            return False
        given = [cookie[COOKIE].value] if COOKIE in cookie else []
        given += _query(scope).get("token", [])
        return any(compare_digest(text.encode(), (self._token or "").encode()) for text in given)


def _query(scope: Scope) -> dict[str, list[str]]:
    return parse_qs(scope.get("query_string", b"").decode("latin-1"))


def _counted(receive: Receive) -> Receive:
    """The same, but a body that never ends is cut off."""
    count = 0

    async def counted() -> Message:
        nonlocal count
        message = await receive()
        if message["type"] == "http.request":
            count += len(message.get("body", b""))
            if count > LARGEST:
                return {"type": "http.disconnect"}
        return message

    return counted


async def _refuse(scope: Scope, receive: Receive, send: Send, reason: str) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008, "reason": reason})
        return
    await PlainTextResponse(f"hydrostat: {reason}\n", status_code=403)(scope, receive, send)
