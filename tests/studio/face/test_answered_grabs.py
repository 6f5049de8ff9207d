"""Each grab gets a message, also one that is refused: a page without an answer would open its connection again."""

import asyncio
import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import cast

import pytest
from starlette.websockets import WebSocket

from hydrostat.robot import gallery_folder
from hydrostat.studio.face.stream import Stream
from hydrostat.studio.session import Session
from hydrostat.studio.stage import Hit

GRAB = {"kind": "grab", "key": "marker:top", "world": [0.0, 0.13, 0.0], "stamp": 1.0}


class Socket:
    """The websocket of a screen."""

    def __init__(self) -> None:
        self.said: asyncio.Queue[dict[str, str]] = asyncio.Queue()
        self.sent: asyncio.Queue[bytes] = asyncio.Queue()
        self.receive, self.send_bytes = self.said.get, self.sent.put

    async def accept(self) -> None: ...

    def say(self, message: dict[str, object]) -> None:
        self.said.put_nowait({"type": "websocket.receive", "text": json.dumps(message)})


@pytest.fixture
def session() -> Iterator[Session]:
    made = Session()
    made.open_folder(gallery_folder("starfish"))
    yield made
    made.close()


@pytest.mark.parametrize("why", ["locked", "another drags", "watching"])
def test_a_refused_grab_is_answered(session: Session, why: str) -> None:
    """Oracle: a message after the grab, of a session that publishes nothing more."""
    stream = Stream(session)
    if why == "locked":
        session.lock(True)
    elif why == "another drags":
        assert session.grab("other", Hit(key="marker:top", world=(0.0, 0.13)))
    shown = session.current_view()
    assert shown is not None
    stream.publish(shown)

    async def grab() -> bytes:
        socket = Socket()
        serving = asyncio.create_task(stream.serve(cast(WebSocket, socket), watching=why == "watching"))
        assert [await socket.sent.get(), await socket.sent.get()] == [shown.scene, shown.frame]
        socket.say({"kind": "seen"})
        socket.say(GRAB)
        try:
            return await asyncio.wait_for(socket.sent.get(), 5.0)
        finally:
            socket.said.put_nowait({"type": "websocket.disconnect"})
            await serving

    with ThreadPoolExecutor(1) as pool:  # a browser's loop may run in this thread
        assert pool.submit(lambda: asyncio.run(grab())).result() == shown.frame
