"""OBJ and OFF files: vertices and polygons as text, without a unit. Materials, other files, are never opened."""

import re
from array import array
from collections.abc import Iterator

import numpy as np

from hydrostat.errors import SurfaceError
from hydrostat.geometry.files.soup import MOST_TRIANGLES, Soup, check_count, fans, text_lines


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
        if len(places) > 9 * MOST_TRIANGLES or len(corners) > 3 * MOST_TRIANGLES:
            check_count(name, "vertices or corners", 1 + 3 * MOST_TRIANGLES, room=np.inf, most=3 * MOST_TRIANGLES)
    vertices = np.array(places).reshape(-1, 3)
    return Soup(vertices, fans(np.array(corners, dtype=np.int64), np.array(counts, dtype=np.int64), vertices))


_KINDS = {b"v": "vertex with three numbers", b"f": "face with whole numbers"}


def _index(word: bytes, vertices: int) -> int:
    """Vertex of a corner such as 7, 7/1, 7//3 or -1, which counts back from the last one; counted from 0."""
    number = int(word.partition(b"/")[0])
    if not -vertices <= number <= 2**40 or number == 0:
        raise ValueError
    return number - 1 if number > 0 else vertices + number


OFF_HEAD = re.compile(rb"\s*(?:ST)?C?N?OFF\b")
"""Header of OFF files: with or without texture, colors and normals, none of which is used."""


_Rows = Iterator[tuple[int, list[bytes]]]


def read_off(content: bytes, name: str) -> Soup:
    """Read vertices and faces of an OFF file (SurfaceError: counts, vertices or faces are wrong or missing)."""
    head = OFF_HEAD.match(content)
    if not head or content[head.end() :].lstrip(b" \t").lower().startswith(b"binary"):
        raise SurfaceError(f"{name}: does not begin like an OFF file of text: export the surface again, such as to STL")
    rows = ((number, words) for number, line in text_lines(content[head.end() :], name) if (words := _words(line)))
    vertex_count, face_count = _counts(rows, name)
    check_count(name, "vertices", vertex_count, room=len(content) / 6, most=3 * MOST_TRIANGLES)
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
