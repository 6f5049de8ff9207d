"""`Rooms`: the sessions of one server: the only one of a person, or one for each browser of a class."""

import os
import re
import time
import unicodedata
from base64 import urlsafe_b64encode
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from secrets import token_urlsafe
from threading import Lock, Thread

from hydrostat.errors import HydrostatError, InputError
from hydrostat.project import Work, text_of
from hydrostat.robot import load_robot
from hydrostat.studio.face.pulse import Pulse
from hydrostat.studio.face.stream import Stream
from hydrostat.studio.jobs import Slots
from hydrostat.studio.session import Session
from hydrostat.studio.starting.autosave import RecoveredWork, find_left

MAX_ROOMS = 48  # rooms that are open at a time
IDLE_TIMEOUT = 120.0  # a room that nobody looked at for so long [s] may be closed for another; its work is kept

MAX_NAME = 24  # characters of a nickname

RETRY_INTERVAL = 30  # a page that found no room asks again after so long [s]

_KEY = re.compile(r"[A-Za-z0-9_-]{16,64}")


class RoomsFullError(InputError):
    """All rooms are in use."""


@dataclass(eq=False)
class Room:
    """A session with what lets it work and be seen."""

    key: str  # who knows it may work here
    session: Session  # the robot and all that can be done with it
    address: str = ""  # of the computer that first asked for it
    name: str = ""  # nickname of the pupil
    turns: Slots | None = None  # that all rooms share to follow drags; None: there are no others
    stream: Stream = field(init=False)  # to the screens in it
    pulse: Pulse = field(init=False)  # its threads
    seen: float = 0.0  # when somebody came in last, by a clock that only grows [s]
    visited: bool = False  # whether a page of it has connected; a bare request takes no room from others

    def __post_init__(self) -> None:
        self.stream = Stream(self.session)
        self.pulse = Pulse(self.session, self.stream.publish, self.turns)

    @property
    def watch_key(self) -> str:
        """Who knows it may watch, and does not learn the other one from it."""
        return urlsafe_b64encode(sha256(f"watch {self.key}".encode()).digest()[:18]).decode()

    def close(self) -> None:
        """End all work of it; what is not saved is kept."""
        self.pulse.stop()
        self.session.close()


class Rooms:
    """Rooms by their keys. With a session given there is one room, and every key leads into it."""

    def __init__(self, only: Session | None = None, *, state: Path | None = None, first: Path | None = None) -> None:
        """Open the only room, or make others as browsers come.

        Args:
            only: the session of the only room; None: a room for each key.
            state: folder in which rooms remember what is not saved; None: nowhere.
            first: folder of a robot of which each new room has a copy; None: rooms begin empty.
        """
        works = 2  # so many long works run at a time, of all rooms
        self.first = None if first is None else (Work(robot=load_robot(first)), text_of(first))  # with its robot.toml
        self.slots = Slots(works)
        self.locked = False  # whether rooms that open are locked
        self.state, self._turns = state, Slots(os.cpu_count() or 1)
        self._lock, self._open = Lock(), False
        self._rooms: dict[str, Room] = {}
        self._only = None if only is None else Room(new_key(), only)

    @property
    def many(self) -> bool:
        """True if each browser has a room of its own."""
        return self._only is None

    def start(self) -> None:
        """Let rooms work; those that come later work at once."""
        self._open = True
        if self._only is not None:
            self._only.pulse.start()

    def close(self) -> None:
        """Close all rooms."""
        with self._lock:
            rooms = [*self._rooms.values(), *([] if self._only is None else [self._only])]
            self._rooms, self._open = {}, False
        for room in rooms:
            room.close()

    def list_rooms(self) -> list[Room]:
        """Rooms that are open now."""
        return list(self._rooms.values())

    def rename(self, room: Room, name: str) -> None:
        """Give the pupil of a room a nickname; a number follows one that another has (InputError: nothing is left)."""
        name = clean_name(name)
        others = {other.name.casefold() for other in self.list_rooms() if other is not room}
        named = (name if n == 1 else f"{name} {n}" for n in range(1, len(others) + 2))
        room.name = next(each for each in named if each.casefold() not in others)
        room.session.starter.autosave.owner = room.name

    def list_earlier(self) -> list[RecoveredWork]:
        """Work of earlier lessons, or that a hand-out replaced, the newest first; none of it is shown in a room."""
        home = None if self.state is None else self.state / "rooms"
        if home is None or not home.is_dir():
            return []
        return find_left(
            (room / "work" for room in home.iterdir()), clean=False
        )  # rooms that are open have folders here

    def enter(self, key: str = "", *, address: str = "", name: str = "", visit: bool = False) -> Room:
        """The room of a key, made where there is none yet.

        Args:
            key: name of the room.
            address: address of the client; the one with most rooms loses one first.
            name: nickname of the pupil, for a room that is made.
            visit: True for a page that has loaded and connects.

        Raises:
            InputError: the key is none.
            RoomsFullError: all rooms are in use.
        """
        if self._only is not None:
            return self._only
        if not _KEY.fullmatch(key):
            raise InputError("unknown room. Open the address that the studio printed")
        with self._lock:
            room = self._rooms.get(key)
            if room is None:
                self._make_way(address)
                session = self._session(key)
                room = Room(key, session, address, turns=self._turns)
                self._name_first(room, name)
                self._rooms[key] = room
                if self._open:
                    room.pulse.start()
            room.seen, room.visited = time.monotonic(), room.visited or visit
        return room

    def find_watched(self, key: str) -> Room | None:
        """Return the room of a watch key; None if there is none, or nobody has opened it yet."""
        rooms = [self._only] if self._only is not None else list(self._rooms.values())
        return next((room for room in rooms if room.watch_key == key), None)

    def _name_first(self, room: Room, typed: str) -> None:
        """Give a new room the nickname stored with its work, else the typed one, else "Pupil", which is not stored."""
        autosave = room.session.starter.autosave
        for name in (autosave.owner, typed):
            with suppress(InputError):  # it is empty, or its file is damaged
                self.rename(room, name)
                return
        self.rename(room, "Pupil")
        autosave.owner = ""

    def _session(self, key: str) -> Session:
        name = sha256(key.encode()).hexdigest()[:24]
        state = None if self.state is None else self.state / "rooms" / name
        session = Session(state, guest=True, slots=self.slots)
        with suppress(HydrostatError, OSError):  # work that cannot be read stays in Start
            for left in session.starter.autosave.find_recovered()[:1]:
                session.starter.autosave.owner = left.owner
                session.starter.autosave.restore(left)
        if not session.document.is_open and self.first is not None:
            work, text = self.first
            session.document.open(work, text=text)
        if session.document.is_open:
            session.go("pose")
        session.lock(self.locked)
        return session

    def _make_way(self, address: str) -> None:
        """Close a room if there are too many.

        First goes one that no page visited, then one of a computer that has at least two more than the one that asks,
        or one that nobody has looked at for longest.
        """
        if len(self._rooms) < MAX_ROOMS:
            return
        count = Counter(room.address for room in self._rooms.values())
        bare = Counter(room.address for room in self._rooms.values() if not room.visited)
        bare[address] += 1
        oldest = min(
            (room for room in self._rooms.values() if not room.stream.screens),
            key=lambda room: (room.visited, -bare[room.address], room.seen),
            default=None,
        )
        if oldest is None or (oldest.visited and time.monotonic() - oldest.seen < IDLE_TIMEOUT):
            greedy, rooms = count.most_common(1)[0]
            if rooms < count[address] + 2:
                raise RoomsFullError(f"all {MAX_ROOMS} rooms of this studio are in use")
            oldest = min((room for room in self._rooms.values() if room.address == greedy), key=lambda room: room.seen)
        del self._rooms[oldest.key]
        Thread(target=oldest.close, name="closing a room", daemon=True).start()


def new_key() -> str:
    """A key that nobody guesses."""
    return token_urlsafe(18)


def clean_name(text: str) -> str:
    """A nickname of letters that are seen: no controls, no marks that turn the text around or pile up.

    Raises:
        InputError: nothing is left of it.
    """
    seen = [letter for letter in unicodedata.normalize("NFC", text[:1000]) if letter.isprintable()]
    name = "".join(letter for letter in seen if not unicodedata.combining(letter))
    name = " ".join(name.split())[:MAX_NAME].strip()
    if not name:
        raise InputError("nickname missing. Write at least one letter")
    return name
