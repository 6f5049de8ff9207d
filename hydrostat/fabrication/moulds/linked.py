"""`interlock_count`: through how many holes of the body a half of its mold reaches and closes behind them.

Such a half and the body are like two links of a chain: neither comes off the other, however soft the body is. Loops
that generate all loops of a solid are found on its surface (Eppstein 2003), and each of the half is tested against each
of the body by Gauss's linking number.
"""

from collections import deque

import numpy as np
from manifold3d import Manifold

from hydrostat.arrays import Float, Int
from hydrostat.fabrication.solids.printed import root_of, triangles_of

_IN = 1e-6  # depth of a solid's loop under its surface [mm], so that loops of two touching solids do not meet

_VIEW = np.array([[0.8017, 0.1409, 0.5809], [-0.2713, 0.9508, 0.1437], [-0.5321, -0.2728, 0.8014]])
"""Directions from which crossings are counted: along no axis, no wall and no pull."""

Loop = Float[np.ndarray, "_ 3"]  # corners of a closed line [mm]


def interlock_count(half: Manifold, body: Manifold) -> int:
    """Count the independent holes of a body that a half reaches through; 0 if it is not linked with it."""
    theirs = loops_of(body)
    mine = loops_of(half) if theirs else []
    if not mine:
        return 0
    numbers = np.array([[linking_number(one, other) for other in theirs] for one in mine])
    return int(np.linalg.matrix_rank(numbers))


def loops_of(solid: Manifold) -> list[Loop]:
    """Closed lines just under the surface of a solid, two for each of its handles; sums of them make all others."""
    vertices, triangles = triangles_of(solid)
    if not len(triangles):
        return []
    edges, neighbors = _edges(triangles)
    ways, tree = _tree(neighbors, len(triangles))
    spare = _closing_edges(edges, tree, len(vertices))
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    middles = corners.mean(axis=1)
    loops = []
    for number in spare:
        one, other = neighbors[number]
        passed = _round(ways, int(one), int(other), number)
        loops.append(_line(passed, vertices, edges, neighbors, middles, normals))
    return loops


def linking_number(one: Loop, other: Loop) -> int:
    """Count how often a closed line winds round another: half the signed crossings in a view."""
    a, b = one @ _VIEW.T, other @ _VIEW.T
    along, across = np.roll(a, -1, axis=0) - a, np.roll(b, -1, axis=0) - b
    apart = b[None] - a[:, None]
    turn = along[:, None, 0] * across[None, :, 1] - along[:, None, 1] * across[None, :, 0]
    turn = np.where(turn == 0, np.inf, turn)
    first = (apart[..., 0] * across[None, :, 1] - apart[..., 1] * across[None, :, 0]) / turn
    second = (apart[..., 0] * along[:, None, 1] - apart[..., 1] * along[:, None, 0]) / turn
    crossing = (first >= 0) & (first < 1) & (second >= 0) & (second < 1) & np.isfinite(turn)
    rises = apart[..., 2] + second * across[None, :, 2] - first * along[:, None, 2]
    return int(np.rint((np.sign(turn) * np.sign(rises))[crossing].sum() / 2))


def _edges(triangles: Int[np.ndarray, "triangles 3"]) -> tuple[Int[np.ndarray, "edges 2"], Int[np.ndarray, "edges 2"]]:
    """The two ends of each edge of a closed surface, and its two triangles."""
    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort((sides[:, 1], sides[:, 0]))
    return sides[order][::2], (order // 3).reshape(-1, 2)


def _tree(neighbors: Int[np.ndarray, "edges 2"], count: int) -> tuple[list[tuple[int, int, int]], set[int]]:
    """A tree over all triangles: of each that it hangs on, by which edge, how far from the root; and all its edges."""
    beside: list[list[tuple[int, int]]] = [[] for _ in range(count)]
    for number, (one, other) in enumerate(neighbors.tolist()):
        beside[one].append((other, number))
        beside[other].append((one, number))
    ways, tree = [(-1, -1, -1)] * count, set[int]()
    for root in range(count):
        if ways[root][2] >= 0:
            continue
        ways[root] = (-1, -1, 0)
        waiting = deque([root])
        while waiting:
            triangle = waiting.popleft()
            for other, number in beside[triangle]:
                if ways[other][2] < 0:
                    ways[other] = (triangle, number, ways[triangle][2] + 1)
                    tree.add(number)
                    waiting.append(other)
    return ways, tree


def _closing_edges(edges: Int[np.ndarray, "edges 2"], tree: set[int], count: int) -> list[int]:
    """Edges that are neither crossed by the tree of triangles nor in a tree over all vertices: two for each handle."""
    parent = list(range(count))

    spare = []
    for number, (start, end) in enumerate(edges.tolist()):
        if number in tree:
            continue
        one, other = root_of(parent, start), root_of(parent, end)
        if one == other:
            spare.append(number)
        parent[one] = other
    return spare


def _round(ways: list[tuple[int, int, int]], one: int, other: int, closing: int) -> list[tuple[int, int]]:
    """The way round through triangles: each with the edge by which it is left."""
    last = (other, closing)
    up: list[tuple[int, int]] = []
    down: list[tuple[int, int]] = []
    while one != other:
        if ways[one][2] >= ways[other][2]:
            up.append((one, ways[one][1]))
            one = ways[one][0]
        else:
            down.append((ways[other][0], ways[other][1]))
            other = ways[other][0]
    return [*up, *reversed(down), last]


def _line(
    passed: list[tuple[int, int]],
    vertices: np.ndarray,
    edges: Int[np.ndarray, "edges 2"],
    neighbors: Int[np.ndarray, "edges 2"],
    middles: np.ndarray,
    normals: np.ndarray,
) -> Loop:
    """Corners of a way round, pushed in: the middle of each triangle and of each edge."""
    points = []
    for triangle, number in passed:
        points.append(middles[triangle] - _IN * normals[triangle])
        both = normals[neighbors[number]].sum(axis=0)
        spot = vertices[edges[number]].mean(axis=0)
        points.append(spot - _IN * both / max(float(np.linalg.norm(both)), 1e-9))
    return np.array(points)
