"""STL, OBJ and OFF files: triangles as they were written."""

import re
from array import array
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from hydrostat.errors import SurfaceError
from hydrostat.geometry.files.soup import MAX_TRIANGLES, Soup, check_count, fans, text_lines
from hydrostat.units import plural

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(
    rb"^[ \t]*vertex[ \t]+(\S{1,40})[ \t]+(\S{1,40})[ \t]+(\S{1,40})[ \t]*$", re.MULTILINE | re.IGNORECASE
)
_WORD = re.compile(rb"^[ \t]*vertex\b", re.MULTILINE | re.IGNORECASE)


def read_stl(content: bytes, name: str) -> Soup:
    """Read an STL file, each place as one vertex, no normals (SurfaceError: cut short, a wrong count, no number)."""
    if is_stl_text(content):
        return _weld_corners(_text(content, name))
    corners, more = _binary(content, name)
    notes = (f"{plural(more, 'byte')} after the last triangle, left out",) if more else ()
    return replace(_weld_corners(corners), notes=notes)


def is_stl_text(content: bytes) -> bool:
    """Return True if an STL file is text; some binary files begin with the word "solid" too."""
    head = content[:2000].lstrip().lower()
    return head.startswith(b"solid") and not fits_binary_stl(content) and b"\0" not in head


def fits_binary_stl(content: bytes) -> bool:
    """Return True if the count in the header fits the size of the file."""
    count = int.from_bytes(content[_HEADER - 4 : _HEADER], "little")
    return len(content) > _HEADER and len(content) == _HEADER + _RECORD.itemsize * count


def _binary(content: bytes, name: str) -> tuple[np.ndarray, int]:
    """Corners of the triangles of a binary file, (triangles, 3, 3), and the number of bytes after them."""
    if len(content) < _HEADER:
        raise SurfaceError(f"{name}: {len(content)} bytes are too few for an STL file: export the surface again")
    if content[:400].isascii() and content[:400].decode("ascii").replace("\n", " ").isprintable():
        raise SurfaceError(f"{name}: is text, but no STL, which begins with the word solid: export the surface again")
    count = int.from_bytes(content[_HEADER - 4 : _HEADER], "little")
    room = (len(content) - _HEADER) / _RECORD.itemsize
    check_count(name, "triangles", count, room=room)
    if count == 0 < room:
        raise SurfaceError(
            f"{name}: declares 0 triangles, but has bytes for {room:g}: the file is damaged, export it again"
        )
    more = len(content) - _HEADER - count * _RECORD.itemsize
    return np.frombuffer(content, _RECORD, count, _HEADER)["corners"], more


def _text(content: bytes, name: str) -> np.ndarray:
    """Corners of the triangles of a text file, (triangles, 3, 3)."""
    content = content.replace(b"\r", b"\n") if b"\r" in content else content
    if b"endsolid" not in content[-4000:].lower():
        raise SurfaceError(f"{name}: does not end with endsolid: the file is cut short, export or copy it again")
    check_count(name, "vertices", sum(1 for _ in _WORD.finditer(content)), room=np.inf, most=6_000_000)
    pieces, start = [np.zeros((0, 3))], 0
    piece = 4_000_000  # bytes of text taken apart at once
    while start < len(content):
        end = content.find(b"\n", min(start + piece, len(content)))
        end = len(content) if end < 0 else end
        pieces.append(_vertices(content[start:end], name, sum(map(len, pieces))))
        start = end + 1
    corners = np.concatenate(pieces)
    if len(corners) % 3:
        raise SurfaceError(f"{name}: has {len(corners)} vertices, which are no triangles: export the file again")
    return corners.reshape(-1, 3, 3)


def _vertices(piece: bytes, name: str, before: int) -> np.ndarray:
    """Vertices in whole lines of text, after as many others."""
    found = _VERTEX.findall(piece)
    if len(found) != sum(1 for _ in _WORD.finditer(piece)):
        raise SurfaceError(f"{name}: after vertex {before}, one has not three numbers: export the file again")
    try:
        return np.array(found, dtype=np.bytes_).astype(float).reshape(-1, 3)
    except ValueError:
        raise SurfaceError(f"{name}: after vertex {before}, a coordinate is no number: export it again") from None


def _weld_corners(corners: np.ndarray) -> Soup:
    """Corners as vertices, each place once, in the order of their first use."""
    rows = np.ascontiguousarray(corners.reshape(-1, 3) + 0.0)  # turns -0 into 0
    _, first, place = np.unique(_keys(rows), return_index=True, return_inverse=True)
    if (rows[first[place]] != rows).any():  # two places with one key, or places that are no numbers
        keys = rows.view(np.dtype((np.void, rows.itemsize * 3))).ravel()
        _, first, place = np.unique(keys, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    order = np.argsort(first)
    rank[order] = np.arange(len(first))
    return Soup(rows[first[order]].astype(float), rank[place].reshape(-1, 3))


def _keys(rows: np.ndarray) -> np.ndarray:
    """Number for each row, the same for the same rows and almost never for others: quick to sort."""
    words = rows.view(f"u{rows.itemsize}").astype(np.uint64)
    for factor in (0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F):
        words = (words ^ (words >> np.uint64(29))) * np.uint64(factor)
    return words[:, 0] ^ (words[:, 1] * np.uint64(3)) ^ (words[:, 2] * np.uint64(5))


def read_obj(content: bytes, name: str) -> Soup:
    """Read vertices and faces of an OBJ file, nothing else (SurfaceError: a line is wrong, or they are too many)."""
    content = content.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ") if b"\\" in content else content
    places, corners, counts = array("d"), array("q"), array("q")
    for number, line in text_lines(content, name):
        words = line.split()
        if not words or words[0] not in (b"v", b"f"):
            continue
        try:
            if words[0] == b"v":
                places.extend((float(words[1]), float(words[2]), float(words[3])))
            else:
                counts.append(len(words) - 1)
                corners.extend(_index(word, len(places) // 3) for word in words[1:])
        except (ValueError, IndexError):
            raise SurfaceError(f"{name}: line {number} is no {_KINDS[words[0]]}: export the file again") from None
        if len(places) > 9 * MAX_TRIANGLES or len(corners) > 3 * MAX_TRIANGLES:
            check_count(name, "vertices or corners", 1 + 3 * MAX_TRIANGLES, room=np.inf, most=3 * MAX_TRIANGLES)
    vertices = np.array(places).reshape(-1, 3)
    return Soup(vertices, fans(np.array(corners, dtype=np.int64), np.array(counts, dtype=np.int64), vertices))


_KINDS = {b"v": "vertex with three numbers", b"f": "face with whole numbers"}


def _index(word: bytes, vertices: int) -> int:
    """Vertex of a corner such as 7, 7/1, 7//3 or -1, which counts back from the last one; counted from 0."""
    number = int(word.partition(b"/")[0])
    if not -vertices <= number <= 2**40 or number == 0:
        raise ValueError
    return number - 1 if number > 0 else vertices + number


OFF_HEAD = re.compile(rb"(?:\xef\xbb\xbf)?(?:\s|#[^\r\n]{0,1000}[\r\n]){0,1000}(?:ST)?C?N?OFF\b")
"""Header of OFF files, after remarks: with or without texture, colors and normals, none of which is used."""


_Rows = Iterator[tuple[int, list[bytes]]]


def read_off(content: bytes, name: str) -> Soup:
    """Read vertices and faces of an OFF file (SurfaceError: counts, vertices or faces are wrong or missing)."""
    head = OFF_HEAD.match(content)
    if not head or content[head.end() :].lstrip(b" \t").lower().startswith(b"binary"):
        raise SurfaceError(f"{name}: does not begin like an OFF file of text: export the surface again, such as to STL")
    rows = ((number, words) for number, line in text_lines(content[head.end() :], name) if (words := _words(line)))
    vertex_count, face_count = _counts(rows, name)
    check_count(name, "vertices", vertex_count, room=len(content) / 6, most=3 * MAX_TRIANGLES)
    check_count(name, "faces", face_count, room=len(content) / 8)
    places, corners, counts = array("d"), array("q"), array("q")
    for _ in range(vertex_count):
        places.extend(_row(rows, name, "vertex", float))
    vertices = np.array(places).reshape(-1, 3)
    for _ in range(face_count):
        face = _row(rows, name, "face", int)
        counts.append(len(face))
        corners.extend(face)
    return Soup(vertices, fans(np.array(corners, dtype=np.int64), np.array(counts, dtype=np.int64), vertices))


def _words(line: bytes) -> list[bytes]:
    return line.partition(b"#")[0].split()


def _counts(rows: _Rows, name: str) -> tuple[int, int]:
    """Counts of vertices and of faces, the first two numbers of the file."""
    _, words = next(rows, (0, []))
    try:
        return int(words[0]), int(words[1])
    except (ValueError, IndexError):
        raise SurfaceError(f"{name}: does not begin with its counts of vertices and faces: export it again") from None


def _row(rows: _Rows, name: str, what: str, kind: type) -> list:
    """Numbers of the next vertex or face: three coordinates, or as many indices as the first number says."""
    number, words = next(rows, (0, []))
    if not words:
        raise SurfaceError(f"{name}: ends before its last {what}: the file is cut short, export or copy it again")
    try:
        count, start = (3, 0) if kind is float else (int(words[0]), 1)
        values = [kind(word) for word in words[start : start + count]]
        if len(values) != count or (kind is int and values and max(map(abs, values)) > 2**40):
            raise ValueError
    except ValueError:
        raise SurfaceError(f"{name}: line {number} is no {what}: export the file again") from None
    return values
