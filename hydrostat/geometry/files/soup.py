"""`Soup`: unchecked contents of a surface file, and rules shared by all readers of such files."""

from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO

import numpy as np

from hydrostat.arrays import Float, Int
from hydrostat.errors import SurfaceError

MAX_BYTES = 120_000_000  # a surface file larger than this, or that unpacks to more, is refused
MAX_TEXT_BYTES = 60_000_000  # the same for what is read word by word, which takes longer: text, and the XML of 3MF
MAX_TRIANGLES = 2_000_000  # a surface with more triangles is refused; of vertices it may have three times as many


@dataclass(frozen=True, eq=False)
class Soup:
    """Triangles as they stand in a file."""

    vertices: Float[np.ndarray, "vertices 3"]  # places in the file's own unit
    triangles: Int[np.ndarray, "triangles 3"]  # indices of three vertices each, as declared, not yet checked
    unit: float | None = None  # meters of one coordinate, None where the file has no unit
    notes: tuple[str, ...] = ()  # what was left out


def check_count(name: str, what: str, count: int, *, room: float, most: int = MAX_TRIANGLES) -> None:
    """Refuse a declared count before anything is made of that size.

    Raises SurfaceError, with the file's name and `what` is counted, where the count is negative, above `most`, or more
    than the file has `room` for.
    """
    if count < 0 or count > room:
        raise SurfaceError(
            f"{name}: declares {count} {what}, but has bytes for {max(int(room), 0)} at most: "
            "the file is damaged or cut short, export or copy it again"
        )
    if count > most:
        raise SurfaceError(
            f"{name}: has {count} {what}, at most {most} are read: simplify the surface, such as to 100000 triangles"
        )


def check_text(content: bytes, name: str) -> None:
    """Refuse text that would take long (SurfaceError: it has too many bytes)."""
    if len(content) > MAX_TEXT_BYTES:
        raise SurfaceError(
            f"{name}: has {len(content) / 1e6:.0f} MB of text, at most {MAX_TEXT_BYTES / 1e6:.0f} MB are read: "
            "save it as binary STL or PLY, or simplify the surface"
        )


def text_lines(content: bytes, name: str) -> Iterator[tuple[int, bytes]]:
    """Lines of a text file with their numbers, one after the other, so that no list of all is ever made.

    Raises SurfaceError: a line is too long for text, as in a file that is none.
    """
    check_text(content, name)
    if b"\r" in content:
        content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    longest_line = 1_000_000
    for number, line in enumerate(BytesIO(content), start=1):
        if len(line) > longest_line:
            raise SurfaceError(f"{name}: line {number} is longer than {longest_line} characters: export it again")
        yield number, line


def fans(
    corners: Int[np.ndarray, " corners"], counts: Int[np.ndarray, " polygons"], vertices: Float[np.ndarray, "_ 3"]
) -> Int[np.ndarray, "triangles 3"]:
    """Triangles of polygons, each a fan about its first corner; of four corners, about the one that folds nothing.

    Corners are vertex indices of all polygons, one after the other; counts below three are left out. Indices out of
    range are let through, for others to refuse.
    """
    starts = np.cumsum(counts) - counts
    fours = np.flatnonzero(counts == 4)
    if len(fours):
        corners = corners.copy()
        places = starts[fours, None] + np.arange(4)
        quads = corners[places]
        whole = ((quads >= 0) & (quads < len(vertices))).all(axis=1)
        turned = quads[whole]
        folded = _folds(vertices[turned])
        turned[folded] = np.roll(turned[folded], -1, axis=1)
        corners[places[whole]] = turned
    pieces = np.maximum(counts - 2, 0)
    first = np.repeat(starts, pieces)
    step = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    return corners[np.stack([first, first + step + 1, first + step + 2], axis=1)].astype(np.int64)


def _folds(quads: Float[np.ndarray, "quads 4 3"]) -> np.ndarray:
    """Return True where the two halves of a quad, cut from its first corner to its third, face different sides."""
    sides = quads[:, 1:] - quads[:, :1]
    with np.errstate(all="ignore"):
        return np.einsum("qd,qd->q", np.cross(sides[:, 0], sides[:, 1]), np.cross(sides[:, 1], sides[:, 2])) < 0.0
