"""`serve`: the studio as a page of this machine; `build_watch`: a page that only shows a room's robot."""

import socket
import sys
import webbrowser
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from secrets import token_urlsafe
from urllib.parse import quote

import uvicorn
from fastapi import FastAPI
from nicegui import ui
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp
from starlette.websockets import WebSocket

from hydrostat.errors import InputError
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.class_code import recall_code
from hydrostat.studio.face.class_pages import add_class_pages, ask_nickname, read_nickname, remember
from hydrostat.studio.face.classroom import Classroom
from hydrostat.studio.face.guard import LOOPBACK, Guard
from hydrostat.studio.face.page import HEARTBEAT, Toasts, WindowPage
from hydrostat.studio.face.rooms import RETRY_INTERVAL, Room, Rooms, RoomsFullError, new_key
from hydrostat.studio.face.share import Links
from hydrostat.studio.face.tour import STAGES
from hydrostat.studio.face.view_bar import view_bar
from hydrostat.studio.face.viewport import Viewport
from hydrostat.studio.face.window import build_window, dress
from hydrostat.studio.session import Session

TITLE = "hydrostat studio"
CLASS_PORTS = range(8320, 8330)
"""A class takes the first free one, so that it has the same address in the next lesson."""

ROOM = "hydrostat_room"  # the cookie of a browser's own room, followed by the port


def make_app(rooms: Rooms, *, token: str | None = None, port: int = 0, classroom: Classroom | None = None) -> FastAPI:
    """The app of some rooms, without a guard. There can be one in a process, as NiceGUI has one set of pages.

    Links that are shown have the token, if there is one; the cookie of a browser's room has the port in its name. In a
    class, pupils give a nickname before they enter.
    """

    @asynccontextmanager
    async def life(_: FastAPI) -> AsyncIterator[None]:
        rooms.start()
        yield
        if classroom is not None:
            classroom.close()
        rooms.close()

    app = FastAPI(lifespan=life, docs_url=None, redoc_url=None, openapi_url=None)

    _add_streams(app, rooms, port)
    _add_pages(rooms, token, port, classroom)
    if classroom is not None:
        add_class_pages(app, classroom, token, port)
    ui.run_with(app, show_welcome_message=False, reconnect_timeout=30.0)
    return app


def _add_streams(app: FastAPI, rooms: Rooms, port: int) -> None:
    """Pictures to all screens and pointers back, by the key of a room; none to those who watch."""

    async def show(socket: WebSocket, room: Room, *, watching: bool = False) -> None:
        room.pulse.refresh()
        await room.stream.serve(socket, watching=watching)

    @app.websocket("/stream")
    @app.websocket("/stream/{key}")
    async def connect(socket: WebSocket, key: str = "") -> None:
        try:
            room = rooms.enter(key, address=_address(socket), name=read_nickname(socket, port), visit=True)
        except InputError:
            await socket.close(1008)
        else:
            await show(socket, room)

    @app.websocket("/watched/{key}")
    async def watch(socket: WebSocket, key: str) -> None:
        room = rooms.find_watched(key)
        await (socket.close(1008) if room is None else show(socket, room, watching=True))


def _add_pages(rooms: Rooms, token: str | None, port: int, classroom: Classroom | None) -> None:
    """The page of a room, of those who watch, and the front, which leads each browser into its own room."""
    asked = f"?token={token}" if token else ""

    def build(request: Request, room: Room) -> None:
        base = str(request.base_url)
        own = f"room/{room.key}" if rooms.many else ""
        shared = rooms.many or token
        work, watch = (f"{base}{own}{asked}", f"{base}watch/{room.watch_key}{asked}") if shared else ("", "")
        links = Links(work, watch, f"{base}{asked}")
        stream = f"/stream/{room.key}" if rooms.many else "/stream"
        page = build_window(room.session, stream, links, room if classroom else None)
        ui.context.client.on_delete(page.close)

    @ui.page("/", title=TITLE, language="en-US")
    def front(request: Request) -> Response | None:
        if not rooms.many:
            build(request, rooms.enter())
            return None
        key = request.cookies.get(f"{ROOM}_{port}") or new_key()
        response = RedirectResponse(f"/room/{quote(key, safe='')}", headers={"cache-control": "no-store"})
        remember(response, f"{ROOM}_{port}", key)
        return response

    @ui.page("/room/{key}", title=TITLE, language="en-US")
    def window(request: Request, key: str) -> Response | None:
        name = read_nickname(request, port)
        if classroom is not None and not name:
            return ask_nickname(key)
        try:
            build(request, rooms.enter(key, address=_address(request), name=name))
        except RoomsFullError as error:
            return _full(str(error))
        except InputError as error:
            return PlainTextResponse(f"hydrostat: {error}\n", status_code=404)
        return None

    @ui.page("/watch/{key}", title=TITLE, language="en-US")
    def watcher(key: str) -> Response | None:
        room = rooms.find_watched(key)
        if room is None:
            return PlainTextResponse("hydrostat: this room is not in use now\n", status_code=404)
        page = build_watch(room.session, f"/watched/{key}")
        ui.context.client.on_delete(page.close)
        return None


def _address(connection: HTTPConnection) -> str:
    """Address of the computer at the other end; empty where it is not known."""
    return "" if connection.client is None else connection.client.host


def _full(words: str) -> Response:
    """Page that says why there is no room, and asks again by itself."""
    head = f'<meta charset="utf-8"><meta http-equiv="refresh" content="{RETRY_INTERVAL}"><title>{TITLE}</title>'
    style = "font: 18px system-ui, sans-serif; max-width: 30em; margin: 20vh auto; padding: 0 1em; color: #2b2833"
    text = f"{words[0].upper()}{words[1:]}. This page tries again every {RETRY_INTERVAL} seconds."
    page = f'<!doctype html><html lang="en">{head}<p style="{style}">{text}</p></html>'
    return HTMLResponse(page, status_code=503, headers={"retry-after": str(RETRY_INTERVAL)})


def serve(
    rooms: Rooms,
    *,
    host: str = "127.0.0.1",
    port: int = 0,
    show: bool = True,
    classroom: Classroom | None = None,
    announce: Callable[[str], None] = print,
) -> None:
    """Serve rooms until Ctrl-C (InputError: the address cannot be listened at).

    At another address than this machine's own a token is asked for, which is a short code for a class. Port 0 is a
    free one, for a class the first free one of `CLASS_PORTS`; `announce` takes the
    address, that of a class and then that of its teacher; `show` opens the browser, of a class on the teacher's page.
    """
    # threads take turns so often [s]: a solver in one must not keep the pointer waiting in another
    switch = 1e-3
    sys.setswitchinterval(switch)
    coded = classroom is not None
    listener = _class_listener(host) if coded and not port else _listener(host, port)
    own = host in ("127.0.0.1", "localhost", "::1")
    token = None if own else recall_code(rooms.state) if coded else token_urlsafe(16)
    number = listener.getsockname()[1]
    name = host if ":" not in host else f"[{host}]"
    shown = name if host not in ("0.0.0.0", "::") else socket.gethostname()
    app = make_app(rooms, token=token, port=number, classroom=classroom)
    guarded: ASGIApp = Guard(app, port=number, names=LOOPBACK if own else (*LOOPBACK, shown), token=token, coded=coded)
    base, asked = f"http://{shown}:{number}/", f"?token={token}" if token else ""
    address = f"{base}{(token or '') if coded else asked}"
    announce(address)
    if classroom is not None:
        address = f"{base}class/{classroom.key}{asked}"
        announce(address)
    if show:
        webbrowser.open(address)
    config = uvicorn.Config(guarded, log_level="warning", ws_max_size=1 << 20, timeout_graceful_shutdown=2)
    uvicorn.Server(config).run(sockets=[listener])


def _class_listener(host: str) -> socket.socket:
    """Listen at the port of the last lesson if it is free: browsers keep their rooms by address and port."""
    for port in CLASS_PORTS:
        try:
            return _listener(host, port)
        except InputError:
            continue
    return _listener(host, 0)


def _listener(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        listener = socket.socket(family)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((host, port))
        listener.listen()  # who follows the printed address at once must wait, not be refused
    except OSError as error:
        words = f"--host {host} --port {port}: cannot open this address ({error.strerror}). Choose another port or host"
        raise InputError(words) from None
    return listener


def build_watch(session: Session, stream: str) -> WindowPage:
    """Build the page of a browser window that watches a session by the path of its stream."""
    page = WindowPage(session, silent=True)
    dress()
    with ui.header().classes("studio-header"):
        ui.label("hydrostat").classes("studio-brand")
        name = ui.label().classes("studio-name")
        ui.space()
        ui.icon("visibility", size="20px").style("color: var(--muted)")
        stage = ui.label().classes("studio-hint").props('data-testid="watching"')
    with ui.element("div").classes("studio-body"):
        room = ui.element("div").classes("studio-work")
    with room, ui.element("div").classes("studio-view"):
        page.viewport = Viewport(stream=stream).classes("studio-viewport")
        view_bar(page, colors=False)
        page.toasts = Toasts()

    def show() -> None:
        document = session.document
        name.set_text(document.robot.name if document.is_open else "")
        stage.set_text(
            f"View only: {STAGES[session.stage].title}" if document.is_open else "View only: no robot is open"
        )

    page.on((Topic.ROBOT, Topic.STAGE), show, lasting=True)
    ui.timer(HEARTBEAT, page.beat)
    return page
