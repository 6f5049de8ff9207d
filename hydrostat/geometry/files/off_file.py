"""OFF files: vertices and polygons as text, without a unit."""

import re
from array import array
from collections.abc import Iterator

import numpy as np

from hydrostat.errors import SurfaceError
from hydrostat.geometry.files.soup import MOST_TRIANGLES, Soup, check_count, fans, lines

OFF_HEAD = re.compile(rb"\s*(?:ST)?C?N?OFF\b")
"""How such files begin: with or without texture, colours and normals, of which nothing is used."""


_Rows = Iterator[tuple[int, list[bytes]]]


def read_off(content: bytes, name: str) -> Soup:
    """What an OFF file says of vertices and faces.

    Raises:
        SurfaceError: counts, vertices or faces are wrong or missing.
    """
    head = OFF_HEAD.match(content)
    if not head or content[head.end() :].lstrip(b" \t").lower().startswith(b"binary"):
        raise SurfaceError(f"{name}: does not begin like an OFF file of text: export the surface again, such as to STL")
    rows = ((number, words) for number, line in lines(content[head.end() :], name) if (words := _words(line)))
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
    """Of vertices and faces, the first two numbers of the file."""
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
