"""Files: reading of untrusted ones, whose size is checked first, and writing of complete ones or none."""

import os
import platform
import re
import shutil
import stat
import threading
from contextlib import suppress
from pathlib import Path

from hydrostat import units
from hydrostat.errors import InputError

_HOST = re.sub(r"\W", "_", platform.node())[:24] or "here"
_NAME = re.compile(rf"\..*\.{_HOST}-(\d+)-\d+\.part", re.DOTALL)


MOST_DRAWN_BYTES = {".svg": 20_000_000, ".dxf": 10_000_000, ".png": 50_000_000, ".jpg": 50_000_000, ".jpeg": 50_000_000}
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
    most = (MOST_DRAWN_BYTES | _MESHES).get(path.suffix.lower(), most_of_any) if most is None else most
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
    **dict.fromkeys(MOST_DRAWN_BYTES, ": save the outline alone, or a smaller picture"),
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


def replace_file(path: Path, content: bytes) -> Path:
    """Write a file whole or not at all (InputError: it cannot be written)."""
    part = temporary_path(path)
    try:
        part.write_bytes(content)
        os.replace(part, path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from None
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
    return path
