"""A hostile screen beside a well-behaved one: the studio lives, and the other still gets its frames."""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import pytest
from toy_server import Server
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from hydrostat.robot import gallery_folder
from hydrostat.studio.face.stream import MAX_MISTAKES
from hydrostat.studio.session import Session
from hydrostat.studio.stage import Hit, StageName
from hydrostat.studio.view.picture import parse_message

pytestmark = pytest.mark.slow

LONGEST = 20.0
"""The most that a test waits for a frame [s]."""

FEW = 20_000_000
"""A studio that takes in no more than so much [bytes] keeps nothing of what it is sent."""


class Screen:
    """One screen: it says what it is told to, and acknowledges what it is sent."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket

    def say(self, kind: str, **values: object) -> None:
        """One message."""
        self.socket.send(json.dumps({"kind": kind, **values}))

    def drag_gets_an_answer(self, stamp: float) -> None:
        """Take hold of the body, and wait for the frame that shows it; again if another screen held it until now."""
        until, shown = time.monotonic() + LONGEST, False
        while not shown:
            assert time.monotonic() < until, "no frame came with the answer"
            self.say("grab", key="body", world=[0, 0, 0], stamp=stamp)
            self.say("drag", world=[0.01, 0, 0], stamp=stamp)
            with suppress(TimeoutError):
                while not shown and time.monotonic() < until:
                    shown = self.stamp(LONGEST / 4) == stamp
            self.say("release")

    def sent_away(self, texts: list[str | bytes]) -> int:
        """Say all of this and read until the studio ends the connection; the code that it gives as its reason."""
        try:
            for text in texts:
                self.socket.send(text)
            while True:
                self.socket.recv(timeout=LONGEST)
        except ConnectionClosed as closed:
            return closed.rcvd.code if closed.rcvd is not None else 0

    def stamp(self, timeout: float = LONGEST) -> float:
        """Of the next frame."""
        packet = self.socket.recv(timeout=timeout)
        assert isinstance(packet, bytes)
        self.say("seen")
        head, _ = parse_message(packet)
        return head.get("stamp", -1.0)


@contextmanager
def screen(server: Server) -> Iterator[Screen]:
    """A screen of the studio's own page."""
    address, own = f"ws://127.0.0.1:{server.port}/stream", f"http://127.0.0.1:{server.port}"
    with connect(address, origin=own, max_size=None, close_timeout=1.0) as socket:  # type: ignore[arg-type]
        yield Screen(socket)


@pytest.fixture
def good(server: Server) -> Iterator[Screen]:
    with screen(server) as one:
        yield one


def test_a_drag_is_answered_and_seen_by_all(server: Server, good: Screen) -> None:
    good.drag_gets_an_answer(1.0)
    with screen(server) as other:
        other.drag_gets_an_answer(2.0)
        while good.stamp() != 2.0:
            pass


@pytest.mark.parametrize(
    "rubbish",
    ["", "hello", b"\x00\x01", b"", "{}", '{"kind": "format disk"}', "[" * 4000, "x" * 900_000,
     '{"kind": "grab", "world": [NaN, 0, 0]}', '{"kind": "drag", "world": [1e400, 0, 0]}',
     '{"kind": "grab", "key": "stumble", "world": [0, 0, 0]}'],
)  # fmt: skip
def test_who_talks_rubbish_is_sent_away_and_nobody_else(server: Server, good: Screen, rubbish: str | bytes) -> None:
    with screen(server) as bad:
        assert bad.sent_away(MAX_MISTAKES * [rubbish]) == 1008
    good.drag_gets_an_answer(3.0)


def test_a_few_mistakes_are_forgiven(good: Screen) -> None:
    for _ in range(MAX_MISTAKES - 1):
        good.socket.send("what")
    good.drag_gets_an_answer(4.0)


def test_a_message_larger_than_any_ends_the_connection(server: Server, good: Screen) -> None:
    with screen(server) as bad:
        assert bad.sent_away(["x" * 5_000_000]) == 1009
    good.drag_gets_an_answer(5.0)


def test_messages_out_of_order_do_nothing(good: Screen) -> None:
    for _ in range(3):
        good.say("drag", world=[0, 0, 0])
        good.say("release")
        good.say("release")
        good.say("seen")
        good.say("seen")
        good.say("grab", key="body", world=[0, 0, 0])
        good.say("grab", key="body", world=[0, 0, 0])
        good.say("click", world=[0, 0, 0])
        good.say("release")
    good.drag_gets_an_answer(6.0)


def test_a_screen_that_leaves_lets_go(server: Server, good: Screen) -> None:
    with screen(server) as other:
        other.say("grab", key="body", world=[0, 0, 0], stamp=7.0)
        while other.stamp() != 7.0:
            pass
    good.drag_gets_an_answer(8.0)


def test_a_flood_keeps_nobody_waiting_and_nothing_is_kept(server: Server, good: Screen) -> None:
    with screen(server) as bad:
        drag = json.dumps({"kind": "drag", "world": [0, 0, 0], "stamp": 9})
        bad.socket.send(drag)
        before = server.memory
        for burst in range(10):
            for _ in range(1000):
                bad.socket.send(drag)
            good.drag_gets_an_answer(100.0 + burst)
        assert server.memory - before < FEW


def test_a_screen_that_never_reads_is_not_waited_for(server: Server, good: Screen) -> None:
    with screen(server) as deaf:
        before = server.memory
        for stamp in range(200, 260):
            deaf.say("seen")
            good.drag_gets_an_answer(float(stamp))
        assert server.memory - before < FEW


@pytest.mark.parametrize("name", list(StageName))
def test_no_stage_stumbles_over_what_is_not_there(name: StageName) -> None:
    session = Session()
    session.open_folder(gallery_folder("starfish"))
    session.go(name)
    try:
        keys = ["", "body", "ghost", "marker:", "marker:none", "winch:none", "cable:99", "cable:-1", "cable:x", "cable",
                "via:0:99", "via:x:y", "via:0", "via:-1:-1", "pin:99", "pin:-1", "pin:x", "zone:99", "zone:x",
                "target:", "target:none", "stopper:7", ":", "via:::", "marker:\0", "handle:" + "9" * 150]  # fmt: skip
        for key in keys:
            for rest in (None, (0.0, 0.0), (99.0, -99.0)):
                hit = Hit(key=key, rest=rest, world=(99.0, -99.0))
                session.drag("one", hit)
                session.click("one", hit)
                session.grab("one", hit)
                session.drag("one", hit)
                session.grab("one", hit)
                assert session.current_view() is not None
                session.release("one")
                session.release("one")
    finally:
        session.close()
