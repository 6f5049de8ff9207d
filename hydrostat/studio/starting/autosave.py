"""`Autosave`: keeps work that is not saved, so that a crash loses little of it.

Lost is what was done in the last `QUIET_TIME`; of changes without a pause, what was done in the last `MAX_DELAY`; and
in both cases what was done while a copy is written.
"""

import json
import logging
import os
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from secrets import token_hex
from shutil import rmtree
from threading import Lock, Thread
from typing import IO

from hydrostat.errors import HydrostatError, InputError
from hydrostat.files import lock_file, read_stranger
from hydrostat.project import Work, text_of
from hydrostat.studio.document import Document

LOCK = "lock"
_LOCKING = Lock()  # held while a folder is made and locked, or looked at, as rooms of a class share a process
DESIGNS, MAX_DESIGN_BYTES = "designs.json", 20_000_000  # networks that were found; the file may have this many bytes


class HeldFolder:
    """A new folder with a locked file in it. The system ends the lock with the process, even if that is killed."""

    def __init__(self, parent: Path) -> None:
        """Make it (OSError: it cannot be made)."""
        self.path = parent / f"{os.getpid()}-{token_hex(4)}"  # of the folder
        with _LOCKING:
            self.path.mkdir(parents=True)
            self._file: IO[bytes] = (self.path / LOCK).open("wb")
            lock_file(self._file)

    def remove(self) -> None:
        """Remove the folder with all that is in it."""
        self.let_go()
        rmtree(self.path, ignore_errors=True)

    def let_go(self) -> None:
        """Leave the folder behind; another process may have it."""
        self._file.close()


def is_held(folder: Path) -> bool:
    """Return True if a process that lives holds a folder."""
    try:
        with (folder / LOCK).open("r+b") as file:
            lock_file(file)
    except FileNotFoundError:
        return False
    except OSError:
        return True
    return False


QUIET_TIME = 2.0  # work is kept when nothing has changed for so long [s]
MAX_DELAY = 5.0  # and so often while changes go on [s]
AGAIN = 10.0  # what could not be written is tried again after so long [s]
MAX_ASIDE = 10  # copies of a room that a teacher's robots replaced; the oldest goes first


@dataclass(frozen=True, kw_only=True)
class RecoveredWork:
    """Work that was not saved when its studio ended."""

    folder: Path  # where it is kept
    name: str  # of the robot
    time: datetime  # when it was kept
    origin: Path | None  # where the robot had been saved before; None: nowhere
    owner: str = ""  # nickname of the pupil; "": none
    stamp: str = ""  # of that folder when the robot was opened or saved last

    @property
    def words(self) -> str:
        """Line of it such as "14:32: starfish"; with the day if it was not today."""
        today = self.time.date() == datetime.now(self.time.tzinfo).date()
        return f"{self.time:%H:%M}: {self.name}" if today else f"{self.time:%d %b %H:%M}: {self.name}"


class Autosave:
    """Keeps the work of a document in a folder of its own while it is not saved.

    Networks that Design has found are kept too, of saved work as well, as no file has them; what can be undone is not.
    A studio has a folder ID/ with a lock, and in it ID/N/ with meta.json, work/ and perhaps designs.json, N counting. A
    new one is written beside the last under another name and renamed when it is whole, then the last is removed: at any
    moment one whole copy is there.
    """

    def __init__(self, document: Document, folder: Path | None, *, guest: bool = False) -> None:
        """Keep what is changed in the folder that all studios of this person share; None: nothing is kept.

        Of a guest, who has no other folder, saved work is kept too.
        """
        self.owner = ""  # nickname of the pupil whose work it is; "": none
        self._document, self._folder, self._guest = document, folder, guest
        self._held: HeldFolder | None = None
        self._seen = self._kept = (0, True, b"", "")
        self._changed = self._asked = 0.0
        self.problem = ""  # why the work cannot be kept, a line; "" if it can
        self._count = 0
        self._received: Work | None = None
        self._writer: Thread | None = None
        self._lock = Lock()

    def step(self, now: float) -> None:
        """Keep the work if it is time to, by a clock [s] that never goes back. Returns immediately: a thread writes."""
        state = self._state()
        if state != self._seen:
            if self._seen == self._kept and not self.problem:
                self._asked = now
            self._seen, self._changed = state, now
        if self._folder is None or state == self._kept or (self._writer is not None and self._writer.is_alive()):
            return
        if self.problem and now - self._asked < AGAIN:
            return
        if self._is_over(state) or self.problem or now - self._changed >= QUIET_TIME or now - self._asked >= MAX_DELAY:
            self._asked = now
            self._writer = Thread(target=self._keep, name="autosave", daemon=True)
            self._writer.start()

    def close(self) -> None:
        """End with the studio: what is saved is kept no longer, what is not is there next time."""
        is_over = self._document.is_saved and (not self._guest or self._is_over(self._state()))
        if not is_over:
            self._keep()
        with self._lock:
            if is_over:
                self._remove()
            if self._held is not None:
                self._held.let_go()
                self._held = None

    def find_recovered(self) -> list[RecoveredWork]:
        """Return the work recovered from studios that no longer run, the newest first."""
        return [] if self._folder is None else find_left([self._folder])

    def set_aside(self) -> None:
        """Keep a copy of the work that later work does not replace; Start offers it. Nothing of an untouched robot.

        Only the newest `MAX_ASIDE` are kept.

        Raises:
            OSError: it cannot be written.
        """
        with self._lock:
            state = self._state()
            if self._folder is None or not self._document.is_open or self._is_over(state):
                return
            if self._document.work is self._received:
                return
            kept = HeldFolder(self._folder)
            try:
                self._write_copy(kept.path / "1", self._document.work, state[2])
            finally:
                kept.let_go()
        for left in self.find_recovered()[MAX_ASIDE:]:
            self.forget(left)

    def note_received(self) -> None:
        """Note that the work as it is now is a teacher's: `set_aside` keeps no copy until it is changed."""
        self._received = self._document.work

    def restore(self, left: RecoveredWork) -> None:
        """Open what was left; it is kept on as work of this studio (InputError: it cannot be read any more)."""
        home, designs = left.folder / "work", left.folder / DESIGNS
        work = Work.open(home)
        found = read_stranger(designs, name=DESIGNS, most=MAX_DESIGN_BYTES) if designs.is_file() else b""
        self._document.open(work, folder=left.origin, saved=False, stamp=left.stamp, text=text_of(home), designs=found)
        if self._keep():
            self.forget(left)

    def forget(self, left: RecoveredWork) -> None:
        """Remove what was left."""
        rmtree(left.folder.parent, ignore_errors=True)

    def _state(self) -> tuple[int, bool, bytes, str]:
        return (self._document.serial, self._document.is_saved, self._document.designs, self.owner)

    def _is_over(self, state: tuple[int, bool, bytes, str]) -> bool:
        """True if nothing of it is to be kept; the first robot of a guest is there again anyway."""
        serial, is_saved, designs, _ = state
        return is_saved and not designs and not (self._guest and (serial > 1 or self._count))

    def _keep(self) -> bool:
        """Write the work as it is now, or remove what was kept if it is saved; whether that could be done."""
        if self._folder is None:
            return False
        with self._lock:
            state = self._state()
            if state == self._kept:
                return True
            try:
                if self._is_over(state):
                    self._remove()
                else:
                    self._write(self._folder, self._document.work, state[2])
            except (OSError, HydrostatError) as error:
                is_file = isinstance(error, OSError)
                why = f"{error.filename or self._folder}: {error.strerror}" if is_file else str(error)
                problem = f"Autosave failed: {why}".splitlines()[0]
                if not self.problem:
                    logging.getLogger("hydrostat").warning(problem)
                self.problem = problem
                return False
            self._kept, self.problem = state, ""
        return True

    def _write(self, folder: Path, work: Work, designs: bytes) -> None:
        if self._held is None:
            self._held = HeldFolder(folder)
        self._count += 1
        home = self._held.path
        whole = home / str(self._count)
        self._write_copy(whole, work, designs)
        for path in home.iterdir():  # the one before, and what could not be written whole
            if path.is_dir() and path != whole:
                rmtree(path, ignore_errors=True)

    def _write_copy(self, whole: Path, work: Work, designs: bytes) -> None:
        part = whole.with_suffix(".part")
        work.save(part / "work", self._document.text)
        origin, stamp = self._document.folder, self._document.stamp
        meta = {
            "name": work.robot.name,
            "time": datetime.now().astimezone().isoformat(),
            "origin": None if origin is None else str(origin.resolve()),
            "stamp": stamp,
            "process": os.getpid(),
            "owner": self.owner,
        }
        if designs:
            (part / DESIGNS).write_bytes(designs)
        (part / "meta.json").write_text(json.dumps(meta), encoding="utf-8")
        part.rename(whole)

    def _remove(self) -> None:
        if self._held is not None:
            self._held.remove()
            self._held = None


def find_left(folders: Iterable[Path], *, clean: bool = True) -> list[RecoveredWork]:
    """Return the work that no living studio holds in such folders, the newest first; clean: remove empty ones."""
    found = [_left_in(home, clean) for folder in folders for home in _list_folders(folder)]
    return sorted((left for left in found if left is not None), key=lambda left: left.time, reverse=True)


def _list_folders(folder: Path) -> list[Path]:
    """Folders in a folder; none if it is missing or has just been removed."""
    try:
        return [path for path in folder.iterdir() if path.is_dir()]
    except OSError:
        return []


def _left_in(folder: Path, clean: bool) -> RecoveredWork | None:
    """The newest whole copy in the folder of a studio that is gone; clean: one without any is removed."""
    with _LOCKING:
        if is_held(folder):
            return None
        numbers = [path for path in _list_folders(folder) if path.name.isdecimal()]
        for path in sorted(numbers, key=lambda path: int(path.name), reverse=True):
            try:
                return _read(path)
            except (OSError, ValueError, KeyError, TypeError, InputError):
                continue
        if clean:
            rmtree(folder, ignore_errors=True)
    return None


def _read(path: Path) -> RecoveredWork:
    meta = json.loads((path / "meta.json").read_text(encoding="utf-8"))
    if not (path / "work" / "robot.toml").is_file():
        raise InputError(f"{path}: no robot found")
    origin = meta["origin"]
    return RecoveredWork(
        folder=path,
        name=str(meta["name"])[:60],
        time=datetime.fromisoformat(meta["time"]),
        origin=None if origin is None else Path(origin),
        stamp=str(meta.get("stamp", "")),
        owner=str(meta.get("owner", ""))[:60],
    )
