"""Rooms of a class. Oracles: whose robot a screen is shown, and which folders are touched."""

import json
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import HTTPRedirectHandler, Request, build_opener

import job_works as works
import pytest
from toy_server import Server
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from hydrostat.errors import InputError
from hydrostat.robot import gallery_folder
from hydrostat.studio.face import rooms as rooms_module
from hydrostat.studio.face.rooms import Room, Rooms, RoomsFullError, new_key
from hydrostat.studio.jobs import Jobs, Slots
from hydrostat.studio.posing.cable_proposals import CableProposals
from hydrostat.studio.session import Session
from hydrostat.studio.view.picture import parse_message


@pytest.fixture
def rooms(tmp_path: Path) -> Iterator[Rooms]:
    made = Rooms(state=tmp_path / "state", first=gallery_folder("starfish"))
    yield made
    made.close()


def test_each_key_has_its_own_robot_and_keeps_it(rooms: Rooms, tmp_path: Path) -> None:
    one, two = new_key(), new_key()
    first = rooms.enter(one)
    first.session.editor.rename("marker:top", "tip")
    assert rooms.enter(one) is first
    assert "tip" not in {marker.name for marker in rooms.enter(two).session.document.robot.markers}
    assert rooms.find_watched(first.watch_key) is first
    assert rooms.find_watched(one) is None
    assert first.watch_key not in (one, rooms.enter(two).watch_key)
    rooms.close()
    again = Rooms(state=tmp_path / "state", first=gallery_folder("starfish"))
    assert "tip" in {marker.name for marker in again.enter(one).session.document.robot.markers}
    assert again.enter(two).session.document.is_saved, "nobody is given the work of others"
    assert one not in "".join(str(path) for path in tmp_path.rglob("*")), "a key can be read on the disk"
    again.close()


@pytest.mark.parametrize("key", ["", "short", "../../../../etc/passwd", "x" * 65, "a b c d e f g h i j"])
def test_what_is_no_key_opens_no_room(rooms: Rooms, key: str) -> None:
    with pytest.raises(InputError, match="unknown room"):
        rooms.enter(key)


def test_a_guest_reads_and_writes_no_folder(rooms: Rooms, tmp_path: Path) -> None:
    session = rooms.enter(new_key()).session
    for act in (lambda: session.save(tmp_path / "mine"), lambda: session.open_folder(gallery_folder("squid"))):
        with pytest.raises(InputError, match="guests cannot"):
            act()
    assert not (tmp_path / "mine").exists()
    assert session.document.robot.name == "starfish"


def test_the_room_that_nobody_sees_makes_way(rooms: Rooms, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rooms_module, "MAX_ROOMS", 2)
    one, two = (rooms.enter(new_key(), visit=True) for _ in range(2))
    with pytest.raises(RoomsFullError, match="all 2 rooms of this studio are in use"):
        rooms.enter(new_key())
    one.seen = two.seen = time.monotonic() - 2 * rooms_module.IDLE_TIMEOUT
    one.seen -= 1.0
    rooms.enter(new_key())
    assert (rooms.find_watched(one.watch_key), rooms.find_watched(two.watch_key)) == (None, two)


def test_bare_requests_take_no_room_from_a_class(rooms: Rooms, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: rooms that a page visited stay; of the others the address that asked for most loses its oldest."""
    monkeypatch.setattr(rooms_module, "MAX_ROOMS", 4)
    pupil = rooms.enter(new_key(), address="pupil", visit=True)
    loading = rooms.enter(new_key(), address="next pupil")
    attacks = [rooms.enter(new_key(), address="attacker") for _ in range(6)]
    late = rooms.enter(new_key(), address="late pupil")
    left = [rooms.find_watched(room.watch_key) for room in (pupil, loading, attacks[-1], late)]
    assert left == [pupil, loading, attacks[-1], late]
    assert not any(rooms.find_watched(room.watch_key) for room in attacks[:-1])


def test_who_takes_all_rooms_makes_way(rooms: Rooms, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: of rooms that are all looked at, the computer with most loses its oldest; equal ones wait."""
    monkeypatch.setattr(rooms_module, "MAX_ROOMS", 3)
    pupil, *greedy = (rooms.enter(new_key(), address=address, visit=True) for address in ("a", "b", "b"))
    for room in (pupil, *greedy):
        room.stream._screens["one"] = object()  # type: ignore[assignment]
    late = rooms.enter(new_key(), address="c", visit=True)
    assert [rooms.find_watched(room.watch_key) for room in (pupil, *greedy, late)] == [pupil, None, greedy[1], late]
    late.stream._screens["one"] = object()  # type: ignore[assignment]
    with pytest.raises(RoomsFullError):
        rooms.enter(new_key(), address="d")


def test_long_work_stands_in_line() -> None:
    """Oracle: with one slot works end in the order in which they came; who gives up leaves the line."""
    slots, order, rooms = Slots(1), list[int](), [Session() for _ in range(3)]
    jobs = [Jobs(session.bell, slots) for session in rooms]
    ended = [threading.Event() for _ in jobs]
    assert slots.wait(lambda: False, print), "somebody else works"
    for place, job in enumerate(jobs):
        job.start("Adding", works.add, place, on_done=order.append, on_end=lambda _, own=ended[place]: own.set())
        until(lambda job=job, place=place: job.state is not None and job.state.stage.endswith(_stage(place)))
    jobs[1].stop()
    assert ended[1].wait(60.0)
    assert (jobs[1].is_running, jobs[1].state and jobs[1].state.error) == (False, "stopped")
    until(lambda: jobs[2].state is not None and jobs[2].state.stage.endswith(_stage(1)))
    slots.give()
    assert ended[0].wait(60.0)
    assert ended[2].wait(60.0)
    assert order == [0, 2]
    for session in rooms:
        session.close()


def _stage(before: int) -> str:
    return f"other rooms, {before} before this one" if before else "waiting for other rooms"


def until(true: Callable[[], bool]) -> None:
    """Wait for what another thread does."""
    end = time.monotonic() + 240.0
    while not true():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_proposals_keep_no_line_waiting() -> None:
    slots, session = Slots(1), Session()
    proposals = [CableProposals(session.document, slots) for _ in range(2)]
    proposals[0].switch(True)
    with pytest.raises(InputError, match="other rooms"):
        proposals[1].switch(True)
    assert not proposals[1].on
    assert slots.wait(lambda: True, print), "long work has slots of its own"
    proposals[0].switch(False)
    proposals[1].switch(True)
    proposals[1].switch(False)
    session.close()


class _Stay(HTTPRedirectHandler):
    def redirect_request(self, *_: object, **__: object) -> None:  # pyright: ignore[reportIncompatibleMethodOverride]
        return None


def fetched(server: Server, path: str, cookie: str = "", form: str | None = None) -> tuple[int, dict[str, str], str]:
    """Status, headers and body of a page, redirections not followed."""
    own = f"http://127.0.0.1:{server.port}"
    headers = {"Cookie": cookie, "Origin": own} if cookie else {"Origin": own}
    request = Request(f"{own}{path}", data=None if form is None else form.encode(), headers=headers)
    try:
        with build_opener(_Stay).open(request, timeout=60) as answer:
            return answer.status, dict(answer.headers), answer.read().decode(errors="replace")
    except HTTPError as error:
        return error.code, dict(error.headers), error.read().decode()


@contextmanager
def screen(server: Server, path: str) -> Iterator[ClientConnection]:
    own = f"http://127.0.0.1:{server.port}"
    with connect(f"ws://127.0.0.1:{server.port}{path}", origin=own, max_size=None, close_timeout=1.0) as socket:  # type: ignore[arg-type]
        yield socket


def frames(socket: ClientConnection, until: float) -> list[float]:
    """Stamps of the frames that come until a time."""
    stamps = []
    while (left := until - time.monotonic()) > 0:
        try:
            head, _ = parse_message(bytes(socket.recv(timeout=left)))  # type: ignore[arg-type]
        except TimeoutError:
            break
        socket.send(json.dumps({"kind": "seen"}))
        if "stamp" in head:
            stamps.append(head["stamp"])
    return stamps


def test_a_class_in_browsers(serving: Callable[..., Server]) -> None:
    """Each browser is led into a room of its own, again and again; who watches sees, and moves nothing."""
    server = serving("127.0.0.1", "many")
    status, headers, _ = fetched(server, "/")
    assert status == 307
    cookie, place = headers["set-cookie"].split(";")[0], headers["location"]
    assert fetched(server, "/", cookie)[1]["location"] == place
    assert fetched(server, "/")[1]["location"] != place
    key = place.rpartition("/")[2]
    assert 'name="name"' in fetched(server, place)[2], "who has no nickname is asked for one"
    assert 'role="alert">nickname missing' in fetched(server, "/join", form=f"room={key}&name=%E2%80%AE")[2]
    status, headers, _ = fetched(server, "/join", form=f"room={key}&name=<b>Zo%C3%AB")
    assert (status, headers["location"]) == (303, place)
    named = headers["set-cookie"].split(";")[0]
    status, _, page = fetched(server, place, named)
    assert (status, '<html lang="en' in page, "<b>Zo" in page) == (200, True, False)
    assert fetched(server, f"/join?{key}", form="x" * 5000)[0] == 413
    assert fetched(server, f"/class/{key}")[0] == 404, "a pupil is no teacher"
    wall = fetched(server, f"/class/{'k' * 24}")
    assert (wall[0], "<b>Zo" in wall[2]) == (200, False)
    watch = Room(key, Session()).watch_key
    assert fetched(server, f"/watch/{watch}")[0] == 200
    assert fetched(server, f"/class/{'k' * 24}/picture/{watch}")[1]["content-type"] == "image/webp"
    assert fetched(server, f"/class/{key}/picture/{watch}")[0] == 404
    assert fetched(server, f"/watch/{key}")[0] == 404
    assert fetched(server, "/room/short", named)[0] == 404
    grab = {"kind": "grab", "key": "marker:top", "world": [0, 0.1, 0]}
    drag = {"kind": "drag", "world": [0.0, 0.12, 0]}
    with screen(server, f"/stream/{key}") as own, screen(server, f"/watched/{watch}") as watcher:
        for message in (grab, drag):
            watcher.send(json.dumps({**message, "stamp": 7.0}))
        assert 7.0 not in frames(own, time.monotonic() + 1.5), "who watches has moved it"
        for message in (grab, drag):
            own.send(json.dumps({**message, "stamp": 8.0}))
        until = time.monotonic() + 60
        while 8.0 not in frames(watcher, time.monotonic() + 1.0):
            assert time.monotonic() < until
    with pytest.raises(InvalidStatus), screen(server, f"/watched/{key}"):
        pass


def test_what_a_guest_takes_home_counts_as_saved(rooms: Rooms) -> None:
    session = rooms.enter(new_key()).session
    session.document.change("rename", robot=replace(session.document.robot, name="mine"))
    assert not session.document.is_saved
    assert session.take_home().name == "mine.zip"
    assert session.document.is_saved
    key = rooms.list_rooms()[0].key
    rooms.close()
    assert rooms.enter(key).session.document.robot.name == "mine", "who comes back finds it all the same"
