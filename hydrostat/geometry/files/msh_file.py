"""Gmsh's MSH files, versions 2 and 4.1, as text or bytes."""

import re
from array import array

import numpy as np

from hydrostat.errors import InputError
from hydrostat.geometry.files.cursor import Cells, Cursor

_TETRAHEDRON, _TRIANGLE = 4, 2
_SIMPLICES = ((_TETRAHEDRON, 4), (_TRIANGLE, 3))
_NAMED = re.compile(rb'(\d+)\s+(-?\d{1,9})\s+"(.*)"')
_CORNERS = {
    1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 8: 3, 9: 6, 10: 9, 11: 10, 12: 27, 13: 18, 14: 14, 15: 1, 16: 8, 17: 20,
    18: 15, 19: 13, 20: 9, 21: 10, 22: 12, 23: 15, 24: 15, 25: 21, 26: 4, 27: 5, 28: 6, 29: 20, 30: 35, 31: 56,
    92: 64, 93: 125,
}  # fmt: skip
"""Number of nodes of each Gmsh element type."""


_Found = dict[int, list[np.ndarray]]


def read_msh(content: bytes, name: str) -> Cells:
    """Read nodes, tetrahedra and triangles of an MSH file (InputError: another version, damaged, unknown elements)."""
    cursor = Cursor(content, name)
    old = _head(cursor)
    nodes, found = None, None
    names: tuple[dict[str, int], dict[str, int]] = ({}, {})
    groups: dict[tuple[int, int], int] = {}
    while nodes is None or found is None:
        line = cursor.line()
        if line is None:
            raise cursor.make_damage_error("ends before its nodes and elements are complete")
        if line == b"$Nodes":
            nodes = _old_nodes(cursor) if old else _nodes(cursor)
            cursor.seek_after(b"$EndNodes")
        elif line == b"$Elements":
            found = _old_elements(cursor) if old else _elements(cursor, groups)
            cursor.seek_after(b"$EndElements")
        elif line == b"$PhysicalNames":
            names = _group_names(cursor)
            cursor.seek_after(b"$EndPhysicalNames")
        elif line == b"$Entities":
            groups = _entity_groups(cursor)
            cursor.seek_after(b"$EndEntities")
        elif line.startswith(b"$"):
            cursor.seek_after(b"$End" + line[1:50])
    tags, points = nodes
    order = np.argsort(tags, kind="stable")
    rows = [np.concatenate([np.zeros((0, 1 + count), dtype=np.int64), *found[kind]]) for kind, count in _SIMPLICES]
    tetrahedra, triangles = (_indices(each[:, 1:], tags, order) for each in rows)
    labels = tuple({"physical": each[:, 0]} for each in rows)
    return Cells(points, tetrahedra, triangles, labels=(labels[0], labels[1]), names=names)


def _group_names(cursor: Cursor) -> tuple[dict[str, int], dict[str, int]]:
    """Tags of the physical groups of volumes and of surfaces by their names."""
    found: tuple[dict[str, int], dict[str, int]] = ({}, {})
    for _ in range(_count(cursor)):
        match = _NAMED.fullmatch(cursor.line() or b"")
        if match is None:
            raise cursor.make_damage_error("has a physical name that is not understood")
        if match[1] in (b"2", b"3"):
            found[3 - int(match[1])][match[3].decode("utf-8", "replace")] = int(match[2])
    return found


def _entity_groups(cursor: Cursor) -> dict[tuple[int, int], int]:
    """Tag of the first physical group of each surface and volume of version 4.1, by its dimension and tag."""
    counts = cursor.numbers(4, "i8").tolist()
    if min(counts) < 0 or sum(counts) > len(cursor.content):
        raise cursor.make_damage_error(f"declares {max(counts)} entities")
    found = {}
    for dim, count in enumerate(counts):
        for _ in range(count):
            tag = int(cursor.numbers(1, "i4")[0])
            cursor.numbers(6 if dim else 3, "f8")
            physical = cursor.numbers(int(cursor.numbers(1, "i8")[0]), "i4")
            if dim:
                cursor.numbers(int(cursor.numbers(1, "i8")[0]), "i4")
            if dim > 1 and len(physical):
                found[dim, tag] = int(physical[0])
    return found


def _indices(wanted: np.ndarray, tags: np.ndarray, order: np.ndarray) -> np.ndarray:
    """Places of nodes among all for their tags; -1 for a tag that no node has."""
    if not len(tags):
        return np.full(wanted.shape, -1)
    place = np.minimum(np.searchsorted(tags[order], wanted), len(tags) - 1)
    return np.where(tags[order][place] == wanted, order[place], -1).astype(np.int64)


def _head(cursor: Cursor) -> bool:
    """Read the format of the rest of the file, and whether it is version 2."""
    cursor.seek_after(b"$MeshFormat")
    cursor.line(blank=True)
    words = (cursor.line() or b"").split()
    if len(words) != 3 or words[1] not in (b"0", b"1"):
        raise cursor.make_damage_error("has no format line")
    version = words[0].decode("latin-1")[:10]
    if version not in ("2", "2.0", "2.1", "2.2", "4.1") or words[2] != b"8":
        raise InputError(f"{cursor.name}: is version {version} of the MSH format: save it as version 4.1 or 2.2")
    cursor.text = words[1] == b"0"
    if not cursor.text:
        one = cursor.content[cursor.at : cursor.at + 4]
        cursor.order = ">" if one == b"\0\0\0\1" else "<"
    cursor.seek_after(b"$EndMeshFormat")
    return version.startswith("2")


def _count(cursor: Cursor) -> int:
    """Number that stands alone in a line."""
    try:
        return int(cursor.line() or b"")
    except ValueError:
        raise cursor.make_damage_error("has no count where one belongs") from None


def _old_nodes(cursor: Cursor) -> tuple[np.ndarray, np.ndarray]:
    """Tags and places of the nodes in version 2."""
    count = _count(cursor)
    if cursor.text:
        rows = cursor.numbers(4 * count, "f8").reshape(-1, 4)
        tags = np.where(np.abs(rows[:, 0]) < 2**53, rows[:, 0], -1.0)
        return tags.astype(np.int64), rows[:, 1:]
    record = np.dtype([("tag", cursor.order + "i4"), ("place", cursor.order + "f8", 3)])
    rows = cursor.numbers(record.itemsize * count, "u1").tobytes()
    table = np.frombuffer(rows, record)
    return table["tag"].astype(np.int64), table["place"].astype(float)


def _old_elements(cursor: Cursor) -> _Found:
    """Physical group and tags of the nodes of tetrahedra and triangles in version 2."""
    found: _Found = {_TETRAHEDRON: [], _TRIANGLE: []}
    left, blocks = _count(cursor), 0
    if cursor.text:
        return _old_rows(cursor, left)
    most_old_blocks = 1_000_000
    while left > 0:
        kind, count, tags = cursor.numbers(3, "i4").tolist()
        blocks += 1
        if kind not in _CORNERS or tags < 0 or count < 1 or blocks > most_old_blocks:
            raise cursor.make_damage_error("has an element of a kind that is not known")
        width = 1 + tags + _CORNERS[kind]
        rows = cursor.numbers(width * count, "i4").reshape(count, width)
        if kind in found:
            first = rows[:, 1 : 1 + min(tags, 1)] if tags else np.zeros((count, 1), dtype=np.int64)
            found[kind].append(np.hstack([first, rows[:, 1 + tags :]]).astype(np.int64))
        left -= count
    return found


def _old_rows(cursor: Cursor, count: int) -> _Found:
    """Read the elements from text: number, kind, number of tags, tags, nodes; a row for each element."""
    numbers = cursor.all_numbers(max(cursor.content.find(b"$EndElements", cursor.at), cursor.at), "i8")
    look, at, end = numbers.data, 0, len(numbers)
    places: dict[int, array] = {_TETRAHEDRON: array("q"), _TRIANGLE: array("q")}
    groups: dict[int, array] = {_TETRAHEDRON: array("q"), _TRIANGLE: array("q")}
    for _ in range(min(count, len(numbers))):
        kind, tags = (look[at + 1], look[at + 2]) if at + 3 <= end else (0, 0)
        begin, first = at + 3, at + 3 + tags
        at = first + _CORNERS.get(kind, end + 1)
        if tags < 0 or at > end:
            raise cursor.make_damage_error("has an element that is not whole, or of a kind that is not known")
        if kind in places:
            places[kind].append(first)
            groups[kind].append(look[begin] if tags else 0)
    if at != end:
        raise cursor.make_damage_error("has elements that do not fit their number")
    found: _Found = {}
    for kind, some in places.items():
        nodes = numbers[np.array(some, dtype=np.int64)[:, None] + np.arange(_CORNERS[kind])]
        found[kind] = [np.column_stack([np.array(groups[kind], dtype=np.int64), nodes])]
    return found


def _blocks(cursor: Cursor) -> int:
    """Number of blocks of a section of version 4.1."""
    blocks = int(cursor.numbers(4, "i8")[0])
    most_blocks = 20_000
    if not 0 <= blocks <= most_blocks:
        raise cursor.make_damage_error(f"declares {blocks} blocks, at most {most_blocks} are read")
    return blocks


def _nodes(cursor: Cursor) -> tuple[np.ndarray, np.ndarray]:
    """Tags and places of the nodes in version 4.1."""
    blocks = _blocks(cursor)
    tags, places = [np.zeros(0, dtype=np.int64)], [np.zeros((0, 3))]
    for _ in range(blocks):
        _, _, parametric = cursor.numbers(3, "i4").tolist()
        count = int(cursor.numbers(1, "i8")[0])
        if parametric:
            raise InputError(f"{cursor.name}: has parametric nodes, which are not read: save it without them")
        tags.append(cursor.numbers(count, "i8").astype(np.int64))
        places.append(cursor.numbers(3 * count, "f8").reshape(-1, 3))
    return np.concatenate(tags), np.concatenate(places)


def _elements(cursor: Cursor, groups: dict[tuple[int, int], int]) -> _Found:
    """Physical group and tags of the nodes of tetrahedra and triangles in version 4.1; 0 for those of no group."""
    found: _Found = {_TETRAHEDRON: [], _TRIANGLE: []}
    blocks = _blocks(cursor)
    for _ in range(blocks):
        dim, entity, kind = cursor.numbers(3, "i4").tolist()
        count = int(cursor.numbers(1, "i8")[0])
        if kind not in _CORNERS:
            raise cursor.make_damage_error("has an element of a kind that is not known")
        rows = cursor.numbers(count * (1 + _CORNERS[kind]), "i8").reshape(count, 1 + _CORNERS[kind])
        if kind in found:
            found[kind].append(rows.astype(np.int64))
            found[kind][-1][:, 0] = groups.get((dim, entity), 0)  # in place of the number of the element
    return found
