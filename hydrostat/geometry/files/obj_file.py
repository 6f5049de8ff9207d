"""OBJ files: vertices and polygons as text, without a unit. Materials, which are other files, are never opened."""

from array import array

import numpy as np

from hydrostat.errors import SurfaceError
from hydrostat.geometry.files.soup import MOST_TRIANGLES, Soup, check_count, fans, lines


def read_obj(content: bytes, name: str) -> Soup:
    """What an OBJ file says of vertices and faces; all else in it is passed over.

    Raises:
        SurfaceError: a line is wrong, or there are too many of them.
    """
    content = content.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ") if b"\\" in content else content
    places, corners, counts = array("d"), array("q"), array("q")
    for number, line in lines(content, name):
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
