"""Files that a command leaves: which of them are not whole?"""

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from zipfile import ZipFile

import numpy as np


def _ends(*marks: bytes) -> Callable[[Path], None]:
    def check(path: Path) -> None:
        content = path.read_bytes().rstrip()
        if not content.endswith(marks):
            raise ValueError(f"ends with {content[-20:]!r}")

    return check


def _table(path: Path) -> None:
    import csv

    content = path.read_text(encoding="utf-8-sig")
    rows = [row for row in csv.reader(content.splitlines()) if row]
    if not content.endswith("\n") or len({len(row) for row in rows}) > 1:
        raise ValueError("rows of different lengths, or no end of the last")


def _picture(path: Path) -> None:
    from PIL import Image

    with Image.open(path) as image:
        image.load()


def _archive(path: Path) -> None:
    with ZipFile(path) as archive:
        if (bad := archive.testzip()) is not None:
            raise ValueError(f"member {bad}")


def _stl(path: Path) -> None:
    content = path.read_bytes()
    if len(content) != 84 + 50 * int.from_bytes(content[80:84], "little"):
        raise ValueError("another size than its number of triangles")


def _portable(path: Path) -> None:
    import hashlib

    content = path.read_bytes()
    if hashlib.sha256(content[:-32]).digest() != content[-32:]:
        raise ValueError("another checksum")


CHECKS: dict[str, Callable[[Path], object]] = {
    ".json": lambda path: json.loads(path.read_text(encoding="utf-8")),
    ".toml": lambda path: tomllib.loads(path.read_text(encoding="utf-8")),
    ".npy": lambda path: np.load(path, allow_pickle=False),
    ".npz": lambda path: [np.load(path, allow_pickle=False)[name] for name in np.load(path).files],
    ".csv": _table,
    ".png": _picture,
    ".zip": _archive,
    ".3mf": _archive,
    ".stl": _stl,
    ".svg": _ends(b"</svg>"),
    ".html": _ends(b"</html>"),
    ".vtu": _ends(b"</VTKFile>"),
    ".pvd": _ends(b"</VTKFile>"),
    ".dxf": _ends(b"EOF"),
    ".pdf": _ends(b"%%EOF"),
    ".model": _portable,
    ".policy": _portable,
}
"""By the ending of the name: raises where a file is not whole."""


def _is_hidden(path: Path, folder: Path) -> bool:
    return any(part.startswith(".") for part in path.relative_to(folder).parts)


def find_half_files(folder: Path, *, endings: tuple[str, ...] = tuple(CHECKS)) -> list[str]:
    """Return a line for each file that is not whole; hidden ones, which are being written, are left out."""
    found = []
    for path in sorted(folder.rglob("*")):
        check = CHECKS.get(path.suffix.lower()) if path.suffix.lower() in endings else None
        if check is None or not path.is_file() or _is_hidden(path, folder):
            continue
        try:
            check(path)
        except Exception as error:  # noqa: BLE001  # whatever a reader says of it
            found.append(f"half file {path.relative_to(folder)}: {error}"[:200])
    return found


def find_unfinished(folder: Path) -> list[str]:
    """Return the hidden files that are being written."""
    return sorted(path.name for path in folder.rglob(".*.part"))
