"""Cache of bodies: results of reading, healing and meshing a file, kept between commands.

An entry is a file in the user's cache folder, named by a hash of all that its content depends on: the bytes of the
drawing or scan, the numbers asked for, the code that meshes, and the versions of the libraries it calls. Entries are
checked by a digest when they are read, written whole or not at all, and may be deleted at any time.
"""

import hashlib
import io
import json
import os
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from hydrostat.files import temporary_path

VARIABLE = "HYDROSTAT_CACHE"
"""Environment variable: the folder of the cache; no cache where it is set and empty."""

MAX_BYTES = 200_000_000
"""Size of the cache; the entries that were read longest ago are deleted beyond it."""

Arrays = Mapping[str, np.ndarray]


def keep_body(asked: tuple[object, ...], content: bytes, make: Callable[[], Arrays]) -> Arrays:
    """Arrays of the cache, or newly made ones, which are kept.

    Args:
        asked: numbers and texts that the result depends on, beside the content.
        content: bytes of the file of the body.
        make: reads, heals and meshes; its errors are not kept.
    """
    folder = _cache_folder()
    if folder is None:
        return make()
    key = hashlib.sha256(json.dumps([_code(), *map(repr, asked)]).encode() + b"\0" + content).hexdigest()
    path = folder / f"{key}.npz"
    found = _read(path)
    if found is None:
        found = make()
        _write(path, found)
    return found


def _cache_folder() -> Path | None:
    """Folder of the cache; None where there is none."""
    named = os.environ.get(VARIABLE)
    if named is not None:
        return Path(named) if named else None
    try:
        home = Path.home()
    except RuntimeError:
        return None
    if sys.platform == "darwin":
        return home / "Library" / "Caches" / "hydrostat"
    variable, folder = ("LOCALAPPDATA", home) if sys.platform == "win32" else ("XDG_CACHE_HOME", home / ".cache")
    return Path(os.environ.get(variable) or folder) / "hydrostat"


@cache
def _code() -> str:
    """Size and time of change of each file that meshes, and versions of the libraries that it calls."""
    root = Path(__file__).parents[1]
    files = [*root.glob("_native.*"), *sorted(root.glob("geometry/**/*.py")), *sorted(root.glob("robot/body*.py"))]
    specs = [find_spec(name) for name in _LIBRARIES]
    files += [Path(spec.origin) for spec in specs if spec is not None and spec.origin]
    stats = [(str(file), (stat := file.stat()).st_size, stat.st_mtime_ns) for file in files]
    return repr((np.__version__, stats))


_LIBRARIES = ("PIL", "contourpy", "ezdxf", "igl", "manifold3d", "scipy", "shapely", "svgelements")
"""Those that read, heal and mesh."""


def _read(path: Path) -> Arrays | None:
    """Arrays of an entry; None where there is none, or it is damaged."""
    try:
        data = path.read_bytes()
        if hashlib.sha256(data[_DIGEST:]).digest() != data[:_DIGEST]:
            return None
        with np.load(io.BytesIO(data[_DIGEST:]), allow_pickle=False) as arrays:
            found = dict(arrays)
    except (OSError, ValueError):
        return None
    with suppress(OSError):
        os.utime(path)  # those read longest ago are deleted first
    return found


def _write(path: Path, arrays: Arrays) -> None:
    """Keep an entry, where that is possible."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    data = buffer.getvalue()
    if len(data) > MAX_BYTES:
        return
    part = temporary_path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _make_room(path.parent, len(data))
        part.write_bytes(hashlib.sha256(data).digest() + data)
        os.replace(part, path)
    except OSError:  # a full disk or a folder that cannot be written: it is made again next time
        with suppress(OSError):
            part.unlink(missing_ok=True)


def _make_room(folder: Path, needed: int) -> None:
    """Delete the entries that were read longest ago, until a new one of `needed` bytes fits."""
    entries = []
    for file in folder.glob("*.npz"):
        with suppress(OSError):
            stat = file.stat()
            entries.append((stat.st_mtime, stat.st_size, file))
    spare = MAX_BYTES - needed - sum(size for _, size, _ in entries)
    for _, size, file in sorted(entries, key=lambda entry: entry[0]):
        if spare >= 0:
            return
        with suppress(OSError):
            file.unlink()
        spare += size


_DIGEST = hashlib.sha256().digest_size
