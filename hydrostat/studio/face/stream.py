"""`Stream`: pictures to all screens and pointers back, over one websocket each; the latest wins."""

import asyncio
import itertools
import logging
from collections.abc import Callable
from contextlib import suppress

from starlette.websockets import WebSocket, WebSocketDisconnect

from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.studio.face.messages import LetGo, Pointer, Seen, read_message
from hydrostat.studio.session import Session
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.picture import Shown

MAX_MISTAKES = 20
"""A screen that says so much that is not understood is sent away."""


class Stream:
    """All screens of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._screens: dict[str, _Screen] = {}
        self._numbers = itertools.count(1)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._latest: Shown | None = None
        self.serial = 0  # counts the pictures

    def publish(self, shown: Shown) -> None:
        """Hand a picture to all screens; from any thread."""
        self._latest = shown
        self.serial += 1
        if self._loop is not None:
            with suppress(RuntimeError):  # the loop has ended: there is no screen left
                self._loop.call_soon_threadsafe(self._wake)

    @property
    def screens(self) -> int:
        """Number of connected screens."""
        return len(self._screens)

    async def serve(self, socket: WebSocket, *, watching: bool = False) -> None:
        """One screen, from its first word to its last; of one that only watches no pointer is heeded."""
        self._loop = asyncio.get_running_loop()
        await socket.accept()
        name = f"screen {next(self._numbers)}"
        screen = _Screen(socket, watching)
        self._screens[name] = screen
        writer = asyncio.create_task(screen.write(lambda: self._latest))
        try:
            await self._read(name, screen)
        except WebSocketDisconnect:
            pass
        finally:
            writer.cancel()
            with suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError):
                await writer
            del self._screens[name]
            self._session.release(name)

    def _wake(self) -> None:
        for screen in self._screens.values():
            screen.fresh.set()

    async def _read(self, name: str, screen: "_Screen") -> None:
        mistakes = 0
        while mistakes < MAX_MISTAKES:
            received = await screen.socket.receive()
            if received["type"] == "websocket.disconnect":
                return
            try:
                self._handle_event(name, screen, received.get("text") or "")
            except InputError:
                mistakes += 1
            except Exception:
                logging.getLogger("hydrostat").exception("error in the studio while handling a message")
                mistakes += 1
            await asyncio.sleep(0)  # messages that wait in a row must not keep other screens waiting
        await screen.socket.close(1008)

    def _handle_event(self, name: str, screen: "_Screen", text: str) -> None:
        message = read_message(text)
        if isinstance(message, Pointer) and message.kind == "grab":
            screen.fresh.set()  # a refused grab is answered too, by the latest picture
        if isinstance(message, Seen):
            screen.saw(message.count)
        elif screen.watching:
            return
        elif isinstance(message, LetGo):
            self._session.release(name)
        else:
            hit = self._parse_hit(message)
            if message.kind == "grab":
                self._session.grab(name, hit, message.stamp)
            elif message.kind == "drag":
                self._session.drag(name, hit, message.stamp)
            else:
                self._session.click(name, hit)

    def _parse_hit(self, message: Pointer) -> Hit:
        """Return the object under the pointer, with as many coordinates as the body."""
        dim = 3
        if self._session.document.is_open:
            dim = self._session.document.robot.body.mesh.dim

        def place(numbers: list[float]) -> Point:
            return tuple(numbers[:dim])

        rest = None if message.rest is None else place(message.rest)
        return Hit(key=message.key, rest=rest, world=place(message.world), shift=message.shift)


class _Screen:
    """One screen: a few pictures may be on their way to it, then it is sent the latest when one has arrived."""

    def __init__(self, socket: WebSocket, watching: bool) -> None:
        self.socket, self.watching = socket, watching
        self.fresh, self._room = asyncio.Event(), asyncio.Event()
        self.fresh.set()
        self._flying = 0
        self._serial = -1

    def saw(self, count: int) -> None:
        """Note that so many pictures have arrived."""
        self._flying = max(0, self._flying - count)
        self._room.set()

    async def write(self, latest: Callable[[], Shown | None]) -> None:
        """Send pictures until the connection ends."""
        # So many pictures may be on their way to a screen: one that arrives, and one that comes next
        most_flying = 2
        timeout = 2.0  # A screen that has answered nothing for so long [s], such as a hidden one, gets the next anyway
        while True:
            await self.fresh.wait()
            while self._flying >= most_flying:
                self._room.clear()
                try:
                    await asyncio.wait_for(self._room.wait(), timeout)
                except TimeoutError:
                    self._flying = 0
            self.fresh.clear()
            shown = latest()
            if shown is None:
                continue
            if shown.serial != self._serial:
                self._serial = shown.serial
                await self.socket.send_bytes(shown.scene)
            self._flying += 1
            await self.socket.send_bytes(shown.frame)
