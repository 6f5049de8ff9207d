"""`add_class_pages`: the form that asks for a nickname, the teacher's page and its pictures."""

from html import escape
from secrets import compare_digest
from urllib.parse import parse_qs, quote, unquote

from fastapi import FastAPI
from nicegui import run, ui
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, PlainTextResponse, RedirectResponse, Response

from hydrostat.errors import InputError
from hydrostat.studio.face.class_code import CODE_LIFETIME
from hydrostat.studio.face.classroom import Classroom
from hydrostat.studio.face.rooms import MAX_NAME, clean_name
from hydrostat.studio.face.teacher import build_teacher

NAME = "hydrostat_name"  # the cookie of a nickname, followed by the port
MAX_BYTES = 4096  # of the form


def remember(response: Response, cookie: str, value: str) -> None:
    """Set a cookie that no script reads."""
    response.set_cookie(cookie, value, httponly=True, samesite="lax", max_age=CODE_LIFETIME)


def read_nickname(connection: HTTPConnection, port: int) -> str:
    """Nickname that a browser has; empty if it has none yet."""
    try:
        return clean_name(unquote(connection.cookies.get(f"{NAME}_{port}", "")))
    except InputError:
        return ""


def ask_nickname(key: str, problem: str = "") -> Response:
    """Page that asks for a nickname, then leads into the room of a key. It needs no script, so it is there at once."""
    page = _FORM.format(key=escape(key), problem=escape(problem), most=MAX_NAME)
    return HTMLResponse(page, headers={"cache-control": "no-store"})


def add_class_pages(app: FastAPI, classroom: Classroom, token: str | None, port: int) -> None:
    """Add them; who has no key of the teacher is told that there is nothing."""

    def is_teacher(key: str) -> bool:
        return compare_digest(key.encode(), classroom.key.encode())

    @app.post("/join")
    async def join(request: Request) -> Response:
        body = b""
        async for part in request.stream():
            body += part
            if len(body) > MAX_BYTES:
                return PlainTextResponse("hydrostat: that is too much to send\n", status_code=413)
        given = parse_qs(body.decode(errors="replace"))
        key = given.get("room", [""])[0]
        try:
            name = clean_name(given.get("name", [""])[0])
        except InputError as error:
            return ask_nickname(key, str(error))
        response = RedirectResponse(f"/room/{quote(key, safe='')}", status_code=303)
        remember(response, f"{NAME}_{port}", quote(name))
        return response

    @app.get("/class/{key}/picture/{watch_key}")
    async def picture(key: str, watch_key: str) -> Response:
        room = classroom.rooms.find_watched(watch_key) if is_teacher(key) else None
        drawn = await run.io_bound(room.session.thumbnail) if room is not None else b""
        return Response(drawn, media_type="image/webp", status_code=200 if drawn else 404)

    @ui.page("/class/{key}", title="hydrostat class", language="en-US")
    def teacher(request: Request, key: str) -> Response | None:
        if not is_teacher(key):
            return PlainTextResponse("hydrostat: not found\n", status_code=404)
        build_teacher(classroom, f"{request.base_url}{token or ''}", f"/class/{key}/picture")
        return None


_FORM = """<!doctype html><html lang="en"><head><meta charset="utf-8"><title>hydrostat studio</title>
<meta name="viewport" content="width=device-width, initial-scale=1"><style>
:root {{ color-scheme: light dark; --paper: #faf8f6; --ink: #2b2833; --accent: #0b5fa5; --on: #ffffff; }}
@media (prefers-color-scheme: dark) {{
  :root {{ --paper: #1a1820; --ink: #efecf2; --accent: #6db3ec; --on: #1a1820; --bad: #ff8a9a; }} }}
body {{ font: 18px system-ui, sans-serif; margin: 0; min-height: 100vh; display: grid; place-items: center;
  background: var(--paper); color: var(--ink); }}
form {{ width: min(320px, calc(100vw - 48px)); display: grid; gap: 14px; }}
h1 {{ font-size: 22px; margin: 0; }}
p {{ margin: 0; color: var(--bad, #c8243f); }} p:empty {{ display: none; }}
input, button {{ font: inherit; padding: 12px 14px; border-radius: 12px; border: 1px solid var(--accent); }}
button {{ background: var(--accent); color: var(--on); font-weight: 600; cursor: pointer; }}
</style></head><body><form method="post" action="/join"><h1>hydrostat</h1>
<label for="name">Nickname, which your class sees</label>
<input id="name" name="name" maxlength="{most}" required autofocus autocomplete="off">
<input type="hidden" name="room" value="{key}"><p role="alert">{problem}</p><button>Start</button></form>
<script>document.forms[0].action += location.hash</script></body></html>
"""
