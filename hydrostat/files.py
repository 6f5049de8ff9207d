"""Files: reading of untrusted ones, whose size is checked first, and writing of complete ones or none."""

import csv
import os
import platform
import re
import shutil
import stat
import sys
import tempfile
import threading
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from errno import EISDIR
from hashlib import sha256
from io import StringIO
from pathlib import Path
from typing import IO

from hydrostat import units
from hydrostat.errors import InputError

_HOST = re.sub(r"\W", "_", platform.node())[:24] or "here"
_NAME = re.compile(rf"\..*\.{_HOST}-(\d+)-\d+\.part", re.DOTALL)


MAX_DRAWN_BYTES = {".svg": 20_000_000, ".dxf": 10_000_000, ".png": 50_000_000, ".jpg": 50_000_000, ".jpeg": 50_000_000}
"""The most bytes of a drawing or a picture, by the ending of its name."""


_MESHES = dict.fromkeys((".vtk", ".vtu", ".msh"), 60_000_000)


def read_stranger(path: str | Path, *, name: str | None = None, most: int | None = None) -> bytes:
    """Bytes of a file.

    Args:
        path: path of the file.
        name: name of the file in errors; None: the path.
        most: bytes that it may have; by the ending of its name if left out.

    Raises:
        InputError: there is no such file, it is a folder, a device or a pipe, or it is too large.
    """
    path, said = Path(path), name or str(path)
    most_of_any = 120_000_000  # The most bytes of any other file
    most = (MAX_DRAWN_BYTES | _MESHES).get(path.suffix.lower(), most_of_any) if most is None else most
    try:
        known = path.stat()
        if not stat.S_ISREG(known.st_mode):
            raise InputError(f"{said}: is not a file")
        if known.st_size > most:
            raise InputError(
                f"{said}: the file has {known.st_size / 1e6:.0f} MB, at most {most / 1e6:g} MB are read"
                f"{_HINTS.get(path.suffix.lower(), '')}"
            )
        with path.open("rb") as file:
            content = file.read(most + 1)
            if len(content) > most:  # it has grown meanwhile
                raise InputError(f"{said}: the file has more than {most / 1e6:g} MB, no more are read")
            return content
    except FileNotFoundError:
        raise InputError(f"{said}: there is no such file") from None
    except (OSError, ValueError) as error:
        words = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(f"{said}: cannot be read ({words})") from None


_HINTS = {
    **dict.fromkeys(MAX_DRAWN_BYTES, ": save the outline alone, or a smaller picture"),
    **dict.fromkeys(_MESHES, ": save it as bytes, or a coarser mesh"),
    **dict.fromkeys((".stl", ".obj", ".ply", ".off", ".3mf"), ": save it as binary, or simplify the surface"),
}


def read_text(file: Path) -> str:
    """Read the text of a file in UTF-8 (InputError: it cannot be read, is too large, or is no such text)."""
    largest_text = 1_000_000  # the file may have this many bytes
    content = read_stranger(file, name=units.printable(str(file)), most=largest_text)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError(f"{file}, line {line}: not UTF-8 text; save the file again as UTF-8") from None


def temporary_path(path: Path) -> Path:
    """Return the hidden path next to a path at which it is written first: unique to each writer on each machine."""
    longest = 40  # letters of the name that are kept, as no name has more than 255 bytes
    return path.with_name(f".{path.name[:longest]}.{_HOST}-{os.getpid()}-{threading.get_native_id()}.part")


def clear_unfinished(folder: Path) -> None:
    """Remove from a folder the unfinished files of this machine's writers that no longer run, such as killed ones."""
    try:
        found = [(entry, _NAME.fullmatch(entry.name)) for entry in os.scandir(folder)]
    except OSError:
        return
    for entry, named in found:
        if named is None or _lives(int(named[1])):
            continue
        with suppress(OSError):
            if entry.is_dir(follow_symlinks=False):
                shutil.rmtree(entry.path, ignore_errors=True)
            else:
                os.unlink(entry.path)


_HELD: dict[Path, IO[bytes]] = {}


def hold_folder(folder: Path) -> None:
    """Hold a folder that this process writes to until the process ends; it need not exist yet.

    The lock is a file in this user's temporary folder; where it cannot be made, nothing is held.

    Raises:
        InputError: another process holds it.
    """
    place, user = folder.resolve(), getattr(os, "getuid", int)()
    if place in _HELD:
        return
    locks = Path(tempfile.gettempdir()) / f"hydrostat-{user}"
    try:
        locks.mkdir(mode=0o700, exist_ok=True)
        if locks.is_symlink() or locks.stat().st_uid != user:
            return  # another user made it
        path = locks / sha256(str(place).encode()).hexdigest()[:32]
        file = os.fdopen(os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o600), "r+b")
    except OSError:
        return
    try:
        lock_file(file)
    except OSError:
        file.close()
        raise InputError(
            f"{folder.absolute()}: another hydrostat writes there. Wait for it, or name another folder."
        ) from None
    _HELD[place] = file


def lock_file(file: IO[bytes]) -> None:
    """Lock a file until it is closed (OSError: another has locked it)."""
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)


def _lives(process: int) -> bool:
    if os.name != "posix":
        return True  # there a signal 0 would end it
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True


def replace_file(path: Path, content: bytes, *, mode: int = 0o666) -> Path:
    """Write a file whole or not at all, with at most these rights (InputError: it cannot be written)."""
    replace_files({path: content}, mode=mode)
    return path


def replace_files(contents: Mapping[Path, bytes], *, outdated: Path | None = None, mode: int = 0o666) -> None:
    """Write files, all or none of them, once all are on the disk; the last one comes last.

    They have their rights, `mode` without those that the umask takes, from their first byte. The file `outdated` is
    removed before the first one is replaced. InputError: a file cannot be written.
    """
    parts = {
        path: temporary_path(path.with_name(f"{number}-{path.name}")) for number, path in enumerate(contents, start=1)
    }
    path = next(iter(contents), Path())
    try:
        for path, part in parts.items():
            if path.is_dir():
                raise IsADirectoryError(EISDIR, os.strerror(EISDIR))
            part.unlink(missing_ok=True)
            part.touch(mode=mode, exist_ok=False)
            part.write_bytes(contents[path])
        if outdated is not None:
            outdated.unlink(missing_ok=True)
        for path, part in parts.items():
            os.replace(part, path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from None
    finally:
        for part in parts.values():
            with suppress(OSError):
                part.unlink(missing_ok=True)


def csv_text(head: Sequence[str], rows: Iterable[Iterable[str]]) -> bytes:
    """CSV in UTF-8, a line for the names of the columns and one for each row."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(rows)
    return text.getvalue().encode()
