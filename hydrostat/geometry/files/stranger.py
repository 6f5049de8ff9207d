"""`read_stranger`: bytes of an untrusted file, whose size is checked before it is read."""

import stat
from pathlib import Path

from hydrostat.errors import InputError

MOST_BYTES = {".svg": 20_000_000, ".dxf": 10_000_000, ".png": 50_000_000, ".jpg": 50_000_000, ".jpeg": 50_000_000}
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
    most = (MOST_BYTES | _MESHES).get(path.suffix.lower(), most_of_any) if most is None else most
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
    **dict.fromkeys(MOST_BYTES, ": save the outline alone, or a smaller picture"),
    **dict.fromkeys(_MESHES, ": save it as bytes, or a coarser mesh"),
    **dict.fromkeys((".stl", ".obj", ".ply", ".off", ".3mf"), ": save it as binary, or simplify the surface"),
}
