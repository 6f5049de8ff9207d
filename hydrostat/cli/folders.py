"""Folders that commands read and write: `RobotFolder`, `OwnRobotFolder`, `OutFolder`, `folder_of`, `result_folder`."""

import os
import re
import shutil
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from hydrostat.errors import InputError

_TABLES = (".csv", ".json")
"""Endings of tables and poses, which some commands take after the robot."""


def found_folder(robot: Path) -> Path:
    """The folder that is meant, also of a robot of the gallery (InputError: no such robot, or a folder of results)."""
    if not str(robot).startswith("gallery:"):
        if not (robot / "robot.toml").exists() and (robot / "robot" / "robot.toml").is_file():
            raise InputError(f"{robot}: results of a design. The robot is {robot / 'robot'}")
        if not robot.exists() and robot.suffix != ".toml":
            begin = f"Begin a robot: hydrostat new {quote(str(robot))} --from gallery:starfish"
            give = "Give the folder of a robot, or gallery:NAME"
            raise InputError(f"{robot}: there is no such file. {give if robot.suffix in _TABLES else begin}")
        return robot
    from hydrostat.robot import GALLERY, gallery_folder

    return gallery_folder(str(robot).removeprefix(GALLERY))


def _own(robot: Path) -> Path:
    """The folder that is meant, to be written to (InputError: it is that of the gallery)."""
    if (folder := found_folder(robot)) != robot:
        name = folder.name
        copy = f"hydrostat new my_{name} --from {robot}"
        raise InputError(f"{robot}: the gallery is read-only. Make a copy: {copy}")
    return robot


_HELP = "Robot folder, its robot.toml"
RobotFolder = Annotated[
    Path, typer.Argument(metavar="ROBOT", help=f"{_HELP}, or gallery:NAME.", callback=found_folder)
]  # to read from
OwnRobotFolder = Annotated[
    Path, typer.Argument(metavar="ROBOT", help=f"{_HELP.replace(',', ', or')}.", callback=_own)
]  # to write to
OutFolder = Annotated[Path, typer.Option("--out", metavar="DIR", help="Output folder (created if missing).")]


def folder_of(robot: Path) -> Path:
    """The folder of a robot that is named by it, or by its robot.toml."""
    return robot if robot.is_dir() else robot.parent


def require_files(files: Iterable[Path]) -> None:
    """Check that files exist, before what reads them is loaded (InputError: the first that does not)."""
    for file in files:
        if not file.is_file():
            raise InputError(f"{file}: there is no such file")


_FILE_ENDINGS = (
    *(".csv", ".gif", ".glb", ".html", ".jpg", ".json", ".mp4", ".npz", ".pdf"),
    *(".png", ".stl", ".svg", ".toml", ".txt", ".usda", ".xml", ".zip"),
)  # endings of files, which no new output folder has


def require_folder(out: Path, *, shared: bool = False, option: str = "--out") -> None:
    """Before long work begins: the results can go there, and what killed runs left unfinished there is cleared.

    Raises:
        InputError: something that is no folder is in the way, a new folder is named like a file, nothing can be
            written there, or, unless it is shared, another process writes there.
    """
    from hydrostat.files import clear_unfinished, hold_folder

    if out.suffix.lower() in _FILE_ENDINGS and not out.exists():
        raise InputError(
            f"{option} {out}: {out.suffix} is the ending of a file. Name a folder, e.g. {out.with_suffix('')}."
        )
    for folder in (out, out.parent):
        clear_unfinished(folder)
    for folder in (out, *out.parents):
        if folder.exists() and not folder.is_dir():
            raise InputError(f"{option} {out}: {'' if folder == out else f'{folder} '}is a file. Name a folder.")
    require_writable(out, f"{option} {out}")
    if not shared:
        hold_folder(out)


def note_others(out: Path, own: Iterable[str]) -> None:
    """Print a note if an output folder holds files, and none of the names that earlier results have."""
    names = set(os.listdir(out)) if out.is_dir() else set[str]()
    if names and not names & set(own):
        print(f"note: {out} holds other files ({len(names)}). They stay", file=sys.stderr, flush=True)


def require_writable(folder: Path, what: str) -> None:
    """Before long work begins: this process may write into a folder, or make it (InputError: it may not)."""
    from hydrostat.files import temporary_path

    there = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    trial = temporary_path(there / "trial")
    try:
        if not os.access(there, os.W_OK | os.X_OK):
            raise PermissionError
        trial.mkdir()  # where a root may do all, as in /proc, permissions do not tell
        trial.rmdir()
    except OSError:
        told = f"{what}: cannot write to {there.absolute()}. Name another folder or change its permissions."
        raise InputError(told) from None


@contextmanager
def result_folder(out: Path, *, stale: str | None = None, kept: Iterable[str] = ()) -> Iterator[Path]:
    """A folder to write to, whose files come to `out` at the end; nowhere if an error or Ctrl-C comes first.

    A new folder is renamed as a whole, also where `out` has only files with the names in `kept`, which come along. In
    another that exists each file takes the place of the one of its name, and others stay, but for folders of earlier
    results that match the pattern `stale`.
    """
    from hydrostat.files import temporary_path

    out, names = out.resolve(), set(kept)
    is_new = not out.exists() or (bool(names) and set(os.listdir(out)) <= names)
    beside = out.parent if is_new else out
    beside.mkdir(parents=True, exist_ok=True)
    part = temporary_path(beside / out.name)
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir()
    try:
        yield part
        if is_new:
            with suppress(OSError):  # another wrote to it meanwhile, or folders cannot be replaced
                _replace_empty(out, part, names)
        if part.exists():
            _remove(out, stale)
            _move_files(part, out)
    except InputError as error:
        if str(part) not in str(error):
            raise
        raise InputError(str(error).replace(str(part), str(out))) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _replace_empty(out: Path, part: Path, names: Iterable[str]) -> None:
    """Move the files of these names from a folder into another, which takes the place of the first (OSError)."""
    present = [name for name in names if (out / name).is_file()]
    for name in present:
        shutil.copy2(out / name, part / name)
    for name in present:
        (out / name).unlink()
    part.rename(out)


def _remove(out: Path, stale: str | None) -> None:
    if stale is None:
        return
    old = [folder for folder in out.glob("*/*") if folder.is_dir() and not folder.is_symlink()]
    for folder in old:
        if re.fullmatch(stale, folder.relative_to(out).as_posix()):
            shutil.rmtree(folder)


def _move_files(part: Path, out: Path) -> None:
    for folder, _, files in os.walk(part):
        place = out / Path(folder).relative_to(part)
        place.mkdir(parents=True, exist_ok=True)
        for name in files:
            os.replace(Path(folder) / name, place / name)
