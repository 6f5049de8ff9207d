"""VTU files: unstructured grids as XML; read with arrays as text, base64 or appended bytes, packed or not; written."""

import base64
import binascii
import re
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from xml.parsers import expat

import numpy as np

from hydrostat.arrays import Nodes, Points
from hydrostat.errors import InputError
from hydrostat.geometry.files.cursor import Cells, Cursor, make_damage_error, whole_numbers
from hydrostat.geometry.files.soup import MAX_BYTES
from hydrostat.geometry.files.vtk_file import TETRAHEDRON, TRIANGLE, cells_of
from hydrostat.geometry.mesh import Mesh

_KINDS = {
    "Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4", "Int64": "i8",
    "UInt64": "u8", "Float32": "f4", "Float64": "f8",
}  # fmt: skip
_NAMES = {code: name for name, code in _KINDS.items()}
_LINE = 3  # VTK's number of a line between two points
_ESCAPES = str.maketrans(
    {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}
)  # xml.sax.saxutils would load the client of the web
_APPENDED = re.compile(rb"<AppendedData([^>]{0,1000})>\s*_")


@dataclass
class _Array:
    """DataArray: attributes of its tag, and its text."""

    attributes: dict[str, str]
    text: list[str] = field(default_factory=list)


@dataclass
class _GridText:
    """Attributes of the whole file as its XML has them, and the arrays of each piece by name.

    The key of whole numbers of the cells is "CellData" and their name.
    """

    attributes: dict[str, str] = field(default_factory=dict)
    pieces: list[dict[str | tuple[str, str], _Array]] = field(default_factory=list)


def read_vtu(content: bytes, name: str) -> Cells:
    """Read points and simplices of a VTU file (InputError: no unstructured grid, oddly packed, too large, damaged)."""
    appended, encoding = b"", "raw"
    match = _APPENDED.search(content)
    if match:
        appended = content[match.end() :]
        encoding = "base64" if b"base64" in match[1] else "raw"
        content = content[: match.start()] + b"</VTKFile>"
    grid = _parse(content, name)
    reader = _Reader(grid.attributes, appended, encoding, name)
    most_pieces = 1000
    if not 0 < len(grid.pieces) <= most_pieces:
        raise make_damage_error(name, f"has no piece, or more than {most_pieces}")
    points, found, before = [np.zeros((0, 3))], [], 0
    for piece in grid.pieces:
        if not {"points", "connectivity", "offsets", "types"} <= piece.keys():
            raise make_damage_error(name, "has a piece without points or cells")
        places = reader.values(piece["points"]).astype(float)
        if len(places) % 3:
            raise make_damage_error(name, "has points without three coordinates")
        arrays = [whole_numbers(reader.values(piece[key])) for key in ("offsets", "connectivity", "types")]
        data = {key[1]: reader.values(array) for key, array in piece.items() if isinstance(key, tuple)}
        cells = cells_of(places.reshape(-1, 3), np.append(0, arrays[0]), arrays[1], arrays[2], name, data)
        points.append(cells.points)
        found.append((before + cells.tetrahedra, before + cells.triangles, cells.labels))
        before += len(cells.points)
    tetrahedra, triangles, labels = zip(*found, strict=True)
    joined = tuple(
        {key: np.concatenate([one[key] for one in kind]) for key in kind[0] if all(key in one for one in kind)}
        for kind in zip(*labels, strict=True)
    )
    return Cells(
        np.concatenate(points), np.concatenate(tetrahedra), np.concatenate(triangles), labels=(joined[0], joined[1])
    )


def _parse(content: bytes, name: str) -> _GridText:
    """Parse the XML and keep the relevant arrays; reject XML that is broken, deep, or declares entities."""
    grid, path = _GridText(), []
    now: _Array | None = None

    most_depth = 50

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal now
        path.append(tag)
        if len(path) > most_depth:
            raise InputError(f"{name}: XML nested deeper than {most_depth}: save it again")
        if tag == "VTKFile":
            grid.attributes = attributes
        elif tag == "Piece":
            grid.pieces.append({})
        elif tag == "DataArray" and grid.pieces and (key := _array_key(path[-2], attributes)):
            now = grid.pieces[-1][key] = _Array(attributes)

    def end(_tag: str) -> None:
        nonlocal now
        path.pop()
        now = None

    def text(piece: str) -> None:
        if now is not None:
            now.text.append(piece)

    def entity(*_arguments: object) -> None:
        raise InputError(f"{name}: declares XML entities, which are not read: save it again")

    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler, parser.EntityDeclHandler = text, entity
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, LookupError, ValueError) as error:
        raise InputError(f"{name}: its XML is broken ({error}): save or copy it again") from None
    if grid.attributes.get("type") != "UnstructuredGrid":
        raise InputError(f"{name}: holds no unstructured grid: save the mesh as an unstructured grid")
    return grid


def _array_key(section: str, attributes: dict[str, str]) -> str | tuple[str, str]:
    """Key of an array of a piece; empty for one that is not read."""
    name = attributes.get("Name", "")
    if section == "CellData":
        is_whole = "Int" in attributes.get("type", "") and attributes.get("NumberOfComponents", "1") == "1"
        return (section, name) if is_whole else ""
    return {"Points": "points", "Cells": name}.get(section, "")


class _Reader:
    """Reader of the arrays of a file in their encoding."""

    def __init__(self, attributes: dict[str, str], appended: bytes, encoding: str, name: str) -> None:
        self.name, self.appended, self.encoding = name, appended, encoding
        self.budget = MAX_BYTES // 8  # numbers, of all arrays together: each becomes eight bytes
        self.order = ">" if attributes.get("byte_order") == "BigEndian" else "<"
        self.head = np.dtype(self.order + ("u8" if attributes.get("header_type") == "UInt64" else "u4"))
        self.packed = "compressor" in attributes
        if attributes.get("compressor", "vtkZLibDataCompressor") != "vtkZLibDataCompressor":
            raise InputError(f"{name}: is packed by {attributes['compressor'][:40]}: save it with zlib or unpacked")

    def values(self, data: _Array) -> np.ndarray:
        """Numbers of an array."""
        kind = _KINDS.get(data.attributes.get("type", ""))
        if kind is None:
            raise make_damage_error(self.name, "has an array of an unknown type")
        how = data.attributes.get("format", "ascii")
        try:
            if how == "ascii":
                return self._text(data, kind)
            if how == "appended":
                source, encoding = self.appended[int(data.attributes.get("offset", "0")) :], self.encoding
            else:
                source, encoding = "".join(data.text).strip().encode("ascii", "replace"), "base64"
            content = self._decompress(source, encoding) if self.packed else self._plain(source, encoding)
            found = np.frombuffer(content, np.dtype(self.order + kind))
        except (ValueError, binascii.Error, zlib.error):
            raise make_damage_error(self.name, "has an array that cannot be unpacked") from None
        self.budget -= len(found)
        if self.budget < 0:
            raise InputError(f"{self.name}: unpacks to more than {MAX_BYTES / 1e6:.0f} MB: save a coarser mesh")
        return found

    def _text(self, data: _Array, kind: str) -> np.ndarray:
        """Numbers written as text."""
        content = "".join(data.text).encode("ascii", "replace")
        return Cursor(content, self.name).all_numbers(len(content), kind)

    def _plain(self, source: bytes, encoding: str) -> bytes:
        """Bytes behind their number."""
        size = self.head.itemsize
        count = int(np.frombuffer(self._encoded_slice(source, encoding, 0, size), self.head)[0])
        return self._encoded_slice(source, encoding, size, count)

    def _decompress(self, source: bytes, encoding: str) -> bytes:
        """Bytes of blocks that are packed one by one, behind their number and sizes."""
        size = self.head.itemsize
        blocks = int(np.frombuffer(self._encoded_slice(source, encoding, 0, size), self.head)[0])
        heads = np.frombuffer(self._encoded_slice(source, encoding, 0, size * (3 + blocks)), self.head).tolist()
        whole, last, packed = heads[1], heads[2], heads[3:]
        if last > whole:
            raise ValueError
        if blocks * whole > MAX_BYTES:
            raise InputError(f"{self.name}: unpacks to more than {MAX_BYTES / 1e6:.0f} MB: save a coarser mesh")
        # the head is encoded on its own, so the rest begins again
        start = size * (3 + blocks)
        rest = source[start if encoding == "raw" else 4 * -(-start // 3) :]
        content, at, result = self._encoded_slice(rest, encoding, 0, sum(packed)), 0, []
        for number, length in enumerate(packed):
            most = last if number == blocks - 1 and last else whole
            result.append(zlib.decompressobj().decompress(content[at : at + length], max(most, 1)))
            at += length
        return b"".join(result)

    def _encoded_slice(self, source: bytes, encoding: str, start: int, count: int) -> bytes:
        """Return some of the encoded bytes (ValueError: there are not as many)."""
        end = start + count
        if encoding == "raw":
            piece = source[start:end]
        else:
            letters = source[: 4 * -(-end // 3)]
            piece = base64.b64decode(letters, validate=True)[start:end]
        if len(piece) != count:
            raise ValueError
        return piece


def write_vtu(mesh: Mesh, nodes: Nodes, point_data: Mapping[str, np.ndarray]) -> bytes:
    """Give a mesh with its nodes at these places [m] as a VTU file for ParaView; the same bytes for the same mesh.

    Data at the nodes are (nodes,) or (nodes, components); to vectors of the plane a third component zero is added, as
    to the nodes: VTK wants it.
    """
    count, corners = mesh.elements.shape
    cells = {
        "connectivity": mesh.elements.ravel(),
        "offsets": corners * np.arange(1, count + 1, dtype=np.int64),
        "types": np.full(count, TRIANGLE if mesh.dim == 2 else TETRAHEDRON, dtype=np.uint8),
    }
    return _vtu(nodes, {"PointData": point_data, "Points": {"Points": nodes}, "Cells": cells}, count)


def write_lines_vtu(points: Points, counts: Sequence[int], cell_data: Mapping[str, np.ndarray]) -> bytes:
    """Give lines as a VTU file for ParaView: each goes through its count of the points [m], with data of each line."""
    lines = np.repeat(np.arange(len(counts)), counts)
    starts = np.flatnonzero(lines[:-1] == lines[1:])
    cells = {
        "connectivity": np.column_stack([starts, starts + 1]).ravel(),
        "offsets": 2 * np.arange(1, len(starts) + 1, dtype=np.int64),
        "types": np.full(len(starts), _LINE, dtype=np.uint8),
    }
    data = {name: np.asarray(values)[lines[starts]] for name, values in cell_data.items()}
    return _vtu(points, {"CellData": data, "Points": {"Points": points}, "Cells": cells}, len(starts))


def _vtu(points: Points, sections: Mapping[str, Mapping[str, np.ndarray]], count: int) -> bytes:
    """Grid of one piece, by its number of cells."""
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt32" '
        'compressor="vtkZLibDataCompressor">',
        f'<UnstructuredGrid><Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">',
    ]
    for tag, arrays in sections.items():
        lines += [f"<{tag}>", *(_data_array(name, values) for name, values in arrays.items()), f"</{tag}>"]
    return "\n".join([*lines, "</Piece></UnstructuredGrid>", "</VTKFile>", ""]).encode()


def _data_array(name: str, values: np.ndarray) -> str:
    """Array as an XML element: blocks packed one by one behind their number and sizes, in base64."""
    if values.ndim == 2 and values.shape[1] == 2:
        values = np.pad(values, ((0, 0), (0, 1)))
    kind = _NAMES[values.dtype.str[1:]]
    width = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    content = values.astype(values.dtype.newbyteorder("<")).tobytes()
    block = 32768  # bytes that are packed at once, as VTK does
    blocks = [zlib.compress(content[start : start + block]) for start in range(0, len(content), block)]
    head = np.array([len(blocks), block, len(content) % block, *map(len, blocks)], dtype="<u4").tobytes()
    text = base64.b64encode(head) + base64.b64encode(b"".join(blocks))
    head = f'type="{kind}" Name="{name.translate(_ESCAPES)}"{width} format="binary"'
    return f"<DataArray {head}>{text.decode()}</DataArray>"
