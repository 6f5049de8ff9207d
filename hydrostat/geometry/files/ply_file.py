"""PLY files: vertices and polygons, as text or in either byte order, without a unit."""

from array import array
from dataclasses import dataclass
from io import BytesIO

import numpy as np

from hydrostat.arrays import Int
from hydrostat.errors import SurfaceError
from hydrostat.geometry.files.soup import MAX_TRIANGLES, Soup, check_count, check_text, fans
from hydrostat.geometry.surface import Surface

_MAX_ROW = 1_000_000
_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass(frozen=True)
class _Property:
    """One number of a row, or a list of them with its length first."""

    name: str
    kind: str
    length_kind: str = ""


@dataclass(frozen=True)
class _Element:
    """Rows of a kind, all with the same properties."""

    name: str
    count: int
    properties: list[_Property]


def read_ply(content: bytes, name: str) -> Soup:
    """Read vertices and faces of a PLY file (SurfaceError: an odd head, counts that do not fit its size, cut short)."""
    order, elements, start = _head(content, name)
    if not order:
        check_text(content, name)
    vertices, faces = np.zeros((0, 3)), None
    for element in elements:
        check_count(
            name, f"{element.name} rows", element.count, room=_room(element, order, content, start), most=_MAX_ELEMENTS
        )
        if order:
            values, start = _binary(content, start, element, order, name)
        else:
            values, start = _text(content, start, element, name)
        if element.name == "vertex":
            vertices = _coordinates(element, values, name)
        elif element.name == "face":
            faces = _faces(element, values, name)
            break
        elif element.name == "tristrips":
            faces = _strips(*_faces(element, values, name))
            break
    if faces is None:
        raise SurfaceError(f"{name}: has no faces, as a cloud of points: make a surface of it first")
    corners, counts = faces
    check_count(name, "triangles", int(np.maximum(counts - 2, 0).sum()), room=np.inf)
    return Soup(vertices, fans(corners, counts, vertices))


_MAX_ELEMENTS = 3 * MAX_TRIANGLES
_Values = dict[str, tuple[np.ndarray, np.ndarray]]
"""Values of each property: the numbers of all rows, concatenated, and the number of values in each row."""


def _head(content: bytes, name: str) -> tuple[str, list[_Element], int]:
    """Byte order (none for text), elements, and where the rows begin."""
    most_head = 100_000
    end = content.find(b"end_header", 0, most_head)
    start = content.find(b"\n", end) + 1
    if not content.startswith(b"ply") or end < 0 or start <= 0:
        raise SurfaceError(f"{name}: has no whole head of a PLY file: export the surface again")
    order, elements = "", []
    for line in content[:end].decode("latin-1").splitlines()[1:]:
        match line.split():
            case ["format", text, *_] if text in _ORDERS:
                order = _ORDERS[text]
            case ["element", kind, count] if count.isdecimal() and len(count) < 20:
                elements.append(_Element(kind, int(count), []))
            case ["property", "list", length, kind, label] if elements and {length, kind} <= _TYPES.keys():
                elements[-1].properties.append(_Property(label, _TYPES[kind], _TYPES[length]))
            case ["property", kind, label] if elements and kind in _TYPES:
                elements[-1].properties.append(_Property(label, _TYPES[kind]))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise SurfaceError(f"{name}: its head says {line[:60]!r}, which is not read: export it again")
    for element in elements:
        if len({each.name for each in element.properties}) < len(element.properties):
            raise SurfaceError(f"{name}: a property of its {element.name} stands twice: export it again")
    return order, elements, start


def _room(element: _Element, order: str, content: bytes, start: int) -> float:
    """Largest number of rows of a kind that there are bytes for."""
    if order:
        least = sum(np.dtype(each.length_kind or each.kind).itemsize for each in element.properties)
    else:
        least = 2 * len(element.properties)  # the last line may end without a line break
    return (len(content) - start + (0 if order else 1)) / least if least else 0.0


def _binary(content: bytes, start: int, element: _Element, order: str, name: str) -> tuple[_Values, int]:
    """Numbers of all rows of an element, and where the next begins.

    Rows are first taken to be all as long as the first one, at once; only where that is wrong one by one.
    """
    if not element.count or not element.properties:
        return {}, start
    lengths = _first_lengths(content, start, element, order)
    fields: list[tuple] = []
    for each, length in zip(element.properties, lengths, strict=True):
        if each.length_kind:
            fields.append((f"n{len(fields)}", order + each.length_kind))
        fields.append((f"v{len(fields)}", order + each.kind, (length,)))
    record = np.dtype(fields)
    if start + record.itemsize * element.count <= len(content):
        rows = np.frombuffer(content, record, element.count, start)
        names = iter(record.names or ())
        values: _Values = {}
        same = True
        for each, length in zip(element.properties, lengths, strict=True):
            same = same and (not each.length_kind or bool(np.all(rows[next(names)] == length)))
            values[each.name] = (rows[next(names)].ravel(), np.full(element.count, length))
        if same:
            return values, start + record.itemsize * element.count
    return _row_by_row(content, start, element, order, name)


def _first_lengths(content: bytes, start: int, element: _Element, order: str) -> list[int]:
    """Count the numbers of each property in the first row; nonsense where the file ends before."""
    lengths = []
    for each in element.properties:
        length = 1
        if each.length_kind:
            kind = np.dtype(order + each.length_kind)
            piece = content[start : start + kind.itemsize]
            length = int(np.frombuffer(piece, kind)[0]) if len(piece) == kind.itemsize else 0
            length = min(max(length, 0), _MAX_ROW)
            start += kind.itemsize
        start += length * np.dtype(each.kind).itemsize
        lengths.append(length)
    return lengths


def _row_by_row(content: bytes, start: int, element: _Element, order: str, name: str) -> tuple[_Values, int]:
    """Numbers of rows whose lists have different lengths."""
    pieces = {each.name: bytearray() for each in element.properties}
    counts = {each.name: array("q") for each in element.properties}
    byte_order = "little" if order == "<" else "big"
    steps = [
        (
            pieces[each.name],
            counts[each.name],
            np.dtype(each.kind).itemsize,
            np.dtype(each.length_kind).itemsize if each.length_kind else 0,
        )
        for each in element.properties
    ]
    for row in range(element.count):
        for piece, count, size, head in steps:
            length = int.from_bytes(content[start : start + head], byte_order) if head else 1
            end = start + head + length * size
            if length > _MAX_ROW or end > len(content):
                raise SurfaceError(
                    f"{name}: ends within {element.name} {row} of {element.count}: the file is damaged or cut short, "
                    "export or copy it again"
                )
            piece += content[start + head : end]
            count.append(length)
            start = end
    values = {
        each.name: (np.frombuffer(pieces[each.name], order + each.kind), np.array(counts[each.name]))
        for each in element.properties
    }
    return values, start


def _text(content: bytes, start: int, element: _Element, name: str) -> tuple[_Values, int]:
    """Numbers of all rows of an element, each a line, and where the next begins."""
    numbers = {each.name: array("d") for each in element.properties}
    counts = {each.name: array("q") for each in element.properties}
    stream = BytesIO(content)
    stream.seek(start)
    for row in range(element.count):
        line = stream.readline(_MAX_ROW)
        while line and line.isspace():
            line = stream.readline(_MAX_ROW)
        try:
            words = [float(word) for word in line.split()]
            place = 0
            for each in element.properties:
                length = 1
                if each.length_kind:
                    length, place = int(words[place]), place + 1
                if length < 0 or place + length > len(words):
                    raise ValueError
                numbers[each.name].extend(words[place : place + length])
                counts[each.name].append(length)
                place += length
        except (ValueError, IndexError, OverflowError):
            raise SurfaceError(
                f"{name}: {element.name} {row} of {element.count} is missing or wrong: the file is damaged or cut "
                "short, export or copy it again"
            ) from None
    values = {key: (np.array(some), np.array(counts[key], dtype=np.int64)) for key, some in numbers.items()}
    return values, stream.tell()


def _coordinates(element: _Element, values: _Values, name: str) -> np.ndarray:
    """Vertices of the rows, (rows, 3)."""
    if not {"x", "y", "z"} <= {each.name for each in element.properties if not each.length_kind}:
        raise SurfaceError(f"{name}: its vertices have no x, y and z: export the surface again")
    if not values:
        return np.zeros((0, 3))
    return np.stack([values[axis][0].astype(float) for axis in "xyz"], axis=1)


def _faces(
    element: _Element, values: _Values, name: str
) -> tuple[Int[np.ndarray, " corners"], Int[np.ndarray, " faces"]]:
    """Vertex indices of all faces, concatenated, and the number of vertices of each face."""
    label = next((each.name for each in element.properties if each.name in ("vertex_indices", "vertex_index")), None)
    if label is None:
        raise SurfaceError(f"{name}: its faces have no vertex_indices: export the surface again")
    if not values:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    corners, counts = values[label]
    if corners.dtype.kind == "f":
        # from text; what is no number of a vertex is made one that no surface has
        corners = np.where(np.abs(corners) < 2**40, corners, -1.0)
    return corners.astype(np.int64), counts.astype(np.int64)


def _strips(
    corners: Int[np.ndarray, " corners"], counts: Int[np.ndarray, " strips"]
) -> tuple[Int[np.ndarray, " corners"], Int[np.ndarray, " faces"]]:
    """Triangles of strips, as faces: three corners in a row each, every other one turned; -1 starts a new strip."""
    ends = np.zeros(len(corners) + 1, dtype=bool)
    ends[np.cumsum(counts)] = True
    place = np.arange(len(corners))
    fresh = ends[:-1] | np.r_[False, corners[:-1] == -1] | (place == 0)
    since = place - np.maximum.accumulate(np.where(fresh, place, 0))
    whole = np.flatnonzero((since[2:] >= 2) & (corners[2:] != -1))
    triangles = corners[whole[:, None] + np.arange(3)]
    turned = since[whole + 2] % 2 == 1
    triangles[turned] = triangles[turned][:, [1, 0, 2]]
    different = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    triangles = triangles[different]
    return triangles.ravel(), np.full(len(triangles), 3)


def write_ply(surface: Surface) -> bytes:
    """Surface as binary PLY: float32 coordinates in millimeters, the same bytes for the same surface."""
    head = (
        "ply\nformat binary_little_endian 1.0\ncomment millimeters\n"
        f"element vertex {len(surface.vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(surface.triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.empty(len(surface.triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, surface.triangles
    return head.encode() + (1e3 * surface.vertices).astype("<f4").tobytes() + faces.tobytes()
