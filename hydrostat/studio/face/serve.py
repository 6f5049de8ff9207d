"""`serve`: the studio as a page of this machine."""

import socket
import sys
import webbrowser
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from secrets import token_urlsafe

import uvicorn
from fastapi import FastAPI
from nicegui import ui
from starlette.types import ASGIApp
from starlette.websockets import WebSocket

from hydrostat.errors import InputError
from hydrostat.studio.face.guard import LOOPBACK, Guard
from hydrostat.studio.face.pulse import Pulse
from hydrostat.studio.face.stream import Stream
from hydrostat.studio.face.window import build_window
from hydrostat.studio.session import Session

SWITCH = 1e-3  # threads take turns so often [s]: a solver in one must not keep the pointer waiting in another


def make_app(session: Session) -> FastAPI:
    """The app of a session, without a guard. There can be one in a process, as NiceGUI has one set of pages."""
    stream = Stream(session)
    pulse = Pulse(session, stream.publish)

    @asynccontextmanager
    async def life(_: FastAPI) -> AsyncIterator[None]:
        pulse.start()
        yield
        pulse.stop()
        session.close()

    app = FastAPI(lifespan=life, docs_url=None, redoc_url=None, openapi_url=None)

    @app.websocket("/stream")
    async def connect(socket: WebSocket) -> None:
        pulse.refresh()
        await stream.serve(socket)

    @ui.page("/", title="hydrostat studio")
    def window() -> None:
        page = build_window(session)
        ui.context.client.on_delete(page.close)

    ui.run_with(app, show_welcome_message=False, reconnect_timeout=30.0)
    return app


def serve(
    session: Session,
    *,
    host: str = "127.0.0.1",
    port: int = 0,
    show: bool = True,
    announce: Callable[[str], None] = print,
) -> None:
    """Serve a session until Ctrl-C (InputError: the address cannot be listened at).

    At another address than this machine's own a token is asked for. Port 0 is a free one; `announce` is told the
    address, `show` opens the browser.
    """
    sys.setswitchinterval(SWITCH)
    listener = _listener(host, port)
    own = host in ("127.0.0.1", "localhost", "::1")
    token = None if own else token_urlsafe(16)
    number = listener.getsockname()[1]
    name = host if ":" not in host else f"[{host}]"
    shown = name if host not in ("0.0.0.0", "::") else socket.gethostname()
    guarded: ASGIApp = Guard(make_app(session), port=number, names=LOOPBACK if own else (*LOOPBACK, shown), token=token)
    address = f"http://{shown}:{number}/" + (f"?token={token}" if token else "")
    announce(address)
    if show:
        webbrowser.open(address)
    config = uvicorn.Config(guarded, log_level="warning", ws_max_size=1 << 20, timeout_graceful_shutdown=2)
    uvicorn.Server(config).run(sockets=[listener])


def _listener(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        listener = socket.socket(family)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((host, port))
        listener.listen()  # who follows the printed address at once must wait, not be refused
    except OSError as error:
        words = f"--host {host} --port {port}: cannot be listened at ({error.strerror}); try another"
        raise InputError(words) from None
    return listener
