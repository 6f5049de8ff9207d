"""STL files: triangles with no vertices in common, in binary or text, without a unit."""

import re

import numpy as np

from hydrostat.errors import SurfaceError
from hydrostat.geometry.files.soup import Soup, check_count

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(
    rb"^[ \t]*vertex[ \t]+(\S{1,40})[ \t]+(\S{1,40})[ \t]+(\S{1,40})[ \t]*$", re.MULTILINE | re.IGNORECASE
)
_WORD = re.compile(rb"^[ \t]*vertex\b", re.MULTILINE | re.IGNORECASE)


def read_stl(content: bytes, name: str) -> Soup:
    """Read an STL file, each place as one vertex, no normals (SurfaceError: cut short, a wrong count, no number)."""
    corners = _text(content, name) if is_stl_text(content) else _binary(content, name)
    return _weld_corners(corners)


def is_stl_text(content: bytes) -> bool:
    """Return True if an STL file is text; some binary files begin with the word "solid" too."""
    head = content[:2000].lstrip().lower()
    return head.startswith(b"solid") and not fits_binary_stl(content) and b"\0" not in head


def fits_binary_stl(content: bytes) -> bool:
    """Return True if the count in the header fits the size of the file."""
    count = int.from_bytes(content[_HEADER - 4 : _HEADER], "little")
    return len(content) > _HEADER and len(content) == _HEADER + _RECORD.itemsize * count


def _binary(content: bytes, name: str) -> np.ndarray:
    """Corners of the triangles of a binary file, (triangles, 3, 3)."""
    if len(content) < _HEADER:
        raise SurfaceError(f"{name}: {len(content)} bytes are too few for an STL file: export the surface again")
    if content[:400].isascii() and content[:400].decode("ascii").replace("\n", " ").isprintable():
        raise SurfaceError(f"{name}: is text, but no STL, which begins with the word solid: export the surface again")
    count = int.from_bytes(content[_HEADER - 4 : _HEADER], "little")
    room = (len(content) - _HEADER) / _RECORD.itemsize
    check_count(name, "triangles", count, room=room)
    if count != room:
        raise SurfaceError(
            f"{name}: declares {count} triangles, but has bytes for {room:g}: the file is damaged, export it again"
        )
    return np.frombuffer(content, _RECORD, count, _HEADER)["corners"]


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
