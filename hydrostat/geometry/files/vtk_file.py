"""Legacy VTK files with unstructured grids, up to version 5.1, as text or big-endian bytes."""

from array import array
from collections.abc import Mapping

import numpy as np

from hydrostat.errors import InputError
from hydrostat.geometry.files.cursor import Cells, Cursor, make_damage_error, whole_numbers

TETRAHEDRON, TRIANGLE = 10, 5  # VTK's numbers of the two kinds of cells that are read

_KINDS = {
    b"char": "i1", b"unsigned_char": "u1", b"short": "i2", b"unsigned_short": "u2", b"int": "i4", b"unsigned_int": "u4",
    b"long": "i8", b"unsigned_long": "u8", b"float": "f4", b"double": "f8", b"vtktypeint32": "i4",
    b"vtktypeint64": "i8", b"vtkidtype": "i4", b"bit": "u1",
}  # fmt: skip


def read_vtk(content: bytes, name: str) -> Cells:
    """Read points and simplices of a legacy VTK file, no data (InputError: it is no unstructured grid, or damaged)."""
    cursor = Cursor(content, name)
    _head(cursor)
    points = starts = corners = types = None
    most_sections = 100
    for _ in range(most_sections):
        if types is not None and points is not None and corners is not None:
            break
        line = cursor.line()
        if line is None:
            raise cursor.make_damage_error("ends before its points, cells and cell types are complete")
        words = line.split()
        match words[0].upper():
            case b"POINTS":
                points = cursor.numbers(3 * _count(cursor, words, 1), _kind(cursor, words[-1])).astype(float)
            case b"CELLS":
                starts, corners = _cells(cursor, words)
            case b"CELL_TYPES":
                types = cursor.numbers(_count(cursor, words, 1), "i4")
            case b"FIELD":
                _skip_fields(cursor, words)
            case b"METADATA":
                while cursor.line(blank=True):
                    pass
            case _:
                raise cursor.make_damage_error(f"says {line[:40].decode('latin-1')!r} before its cells are complete")
    if points is None or starts is None or corners is None or types is None:
        raise cursor.make_damage_error("has too many sections")
    return cells_of(points.reshape(-1, 3), starts, corners, types, name)


def cells_of(
    points: np.ndarray,
    starts: np.ndarray,
    corners: np.ndarray,
    types: np.ndarray,
    name: str,
    data: Mapping[str, np.ndarray] | None = None,
) -> Cells:
    """Simplices among cells, each of one of VTK's types; InputError, with the file's name, where these do not fit.

    Corners are indices of points, of all cells one after the other; `starts` tells where those of each cell begin, and
    where the last ends; `data` are arrays of whole numbers by name, a number for each cell.
    """
    counts = np.diff(starts)
    if (
        len(counts) != len(types)
        or (counts < 0).any()
        or (len(starts) and not 0 <= starts[0] <= starts[-1] <= len(corners))
    ):
        raise make_damage_error(name, "has cells, types and corners that do not fit each other")
    chosen, labels = [], []
    for kind, count in ((TETRAHEDRON, 4), (TRIANGLE, 3)):
        own = (types == kind) & (counts == count)
        chosen.append(corners[starts[:-1][own][:, None] + np.arange(count)].astype(np.int64))
        labels.append({key: values[own] for key, values in (data or {}).items() if len(values) == len(own)})
    return Cells(points, *chosen, labels=(labels[0], labels[1]))


def _head(cursor: Cursor) -> None:
    """Read the first lines, which give the format of the rest."""
    first, _, how, dataset = (cursor.line(blank=True) for _ in range(4))
    if not (first or b"").startswith(b"# vtk DataFile Version"):
        raise cursor.make_damage_error("does not begin like a VTK file")
    if how not in (b"ASCII", b"BINARY"):
        raise cursor.make_damage_error("does not say whether it is ASCII or BINARY")
    if (dataset or b"").split() != [b"DATASET", b"UNSTRUCTURED_GRID"]:
        raise InputError(f"{cursor.name}: holds no unstructured grid: save the mesh as an unstructured grid")
    cursor.text, cursor.order = how == b"ASCII", ">"


def _count(cursor: Cursor, words: list[bytes], place: int) -> int:
    try:
        return int(words[place])
    except (ValueError, IndexError):
        raise cursor.make_damage_error(f"has no count in {b' '.join(words)[:40].decode('latin-1')!r}") from None


def _kind(cursor: Cursor, word: bytes) -> str:
    if word.lower() not in _KINDS:
        raise cursor.make_damage_error(f"has numbers of a type {word[:20].decode('latin-1')!r}, which is not known")
    return _KINDS[word.lower()]


def _cells(cursor: Cursor, words: list[bytes]) -> tuple[np.ndarray, np.ndarray]:
    """Read where the corners of each cell begin, and all corners one after the other."""
    count, size = _count(cursor, words, 1), _count(cursor, words, 2)
    place = cursor.at
    line = (cursor.line() or b"").split()
    if line[:1] == [b"OFFSETS"]:  # since version 5
        starts = whole_numbers(cursor.numbers(count, _kind(cursor, line[-1])))
        line = (cursor.line() or b"").split()
        if line[:1] != [b"CONNECTIVITY"]:
            raise cursor.make_damage_error("has cells without CONNECTIVITY")
        return starts, whole_numbers(cursor.numbers(size, _kind(cursor, line[-1])))
    cursor.at = place
    row = cursor.numbers(size, "i4").astype(np.int64)
    starts, at, numbers = array("q"), 0, row.tolist()
    for _ in range(min(count, size)):
        if at >= size or numbers[at] < 0:
            raise cursor.make_damage_error("has cells that do not fit their number")
        starts.append(at + 1)
        at += numbers[at] + 1
    if at != size or len(starts) != count:
        raise cursor.make_damage_error("has cells that do not fit their number")
    # each cell's own count stands between the corners, so that cells end where the count of the next stands
    keep = np.ones(size, dtype=bool)
    heads = np.array(starts, dtype=np.int64) - 1
    keep[heads] = False
    return np.append(heads - np.arange(count), size - count).astype(np.int64), row[keep]


def _skip_fields(cursor: Cursor, words: list[bytes]) -> None:
    """Pass over arrays that belong to no point or cell."""
    for _ in range(min(_count(cursor, words, 2), 1000)):
        row = (cursor.line() or b"").split()
        if len(row) != 4:
            raise cursor.make_damage_error("has a field that is not understood")
        cursor.numbers(_count(cursor, row, 1) * _count(cursor, row, 2), _kind(cursor, row[3]))
