"""`BoundaryTree`: which parts of a body's boundary come near one another on the way from one place to another."""

from collections import deque
from collections.abc import Callable
from typing import NamedTuple, no_type_check

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Nodes, Vector
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.pair_distances import advanced
from hydrostat.kernel import INNER, Kernel, njit

Stencils = Int[np.ndarray, "pairs corners"]


class Pairs(NamedTuple):
    """Features of the boundary that are near one another and have no node in common.

    In the plane a node and an edge; in space a node and a triangle, or two edges.

    Attributes:
        stencils: nodes of each pair, (pairs, 3) in the plane, (pairs, 4) in space; a lone node comes first.
        edges: whether both features are edges, (pairs,).
    """

    stencils: Stencils
    edges: np.ndarray

    def only(self, kept: np.ndarray) -> "Pairs":
        """Those for which `kept` is true."""
        return Pairs(self.stencils[kept], self.edges[kept])


class BoundaryTree:
    """Bounding volume hierarchy of the facets of a mesh's boundary: a tree of boxes, made once for a body.

    Each node and each edge belongs to one facet of those around it, so that a pair is found once.

    Attributes:
        facets: nodes of each facet, (facets, dim).
        points: nodes that belong to each facet, (facets, dim); -1 where there are fewer.
        edges: in space, both ends of the edges that belong to each facet, (facets, 6); -1 where there are fewer.
        children: of each box, those of a leaf being -1 and its facet, (boxes, 2); children come after their parents.
    """

    def __init__(self, mesh: Mesh) -> None:
        """Tree of the boundary of a mesh at rest."""
        self.facets = np.ascontiguousarray(mesh.boundary)
        count, dim = self.facets.shape
        self.points = _owned(self.facets[:, :, None])[:, :, 0]
        turned = np.stack([self.facets, np.roll(self.facets, -1, axis=1)], axis=2)
        edges = _owned(np.sort(turned, axis=2)) if dim == 3 else np.full((count, 0, 2), -1)
        self.edges = np.ascontiguousarray(edges.reshape(count, -1))
        self.children = _tree(mesh.nodes[self.facets].mean(axis=1))

    def pairs(self, nodes: Nodes, reach: float) -> Pairs:
        """Pairs of features whose boxes come within reach [m] of one another."""
        return self._filled(lambda *pairs: _pairs_within(*self._parts, nodes, nodes + reach, *pairs))[1]

    def sweep(self, nodes: Nodes, move: Nodes, rest: Nodes, *, kept: float, reach: float) -> tuple[float, Pairs]:
        """Largest share of a straight move, at most 1, that is admissible, and the pairs that come near on the way.

        Args:
            nodes: where it begins [m].
            move: of each node [m].
            rest: where the nodes are at rest [m]: pairs that touch there may do as they like.
            kept: share of its distance that each pair is to keep.
            reach: all pairs that come within this distance [m] are told, and more.
        """
        return self._filled(lambda *pairs: _share_of_way(*self._parts, nodes, move, rest, kept, reach, *pairs))

    def _filled(self, fill: Callable[[np.ndarray, np.ndarray], tuple[float, int]]) -> tuple[float, Pairs]:
        """What a loop tells, and the pairs that it fills in; again with more room where that was too little."""
        room = 64 + 8 * len(self.facets)
        while True:
            stencils, edges = np.empty((room, self.facets.shape[1] + 1), np.int64), np.empty(room, np.bool_)
            told, count = fill(stencils, edges)
            if count <= room:
                return told, Pairs(stencils[:count], edges[:count])
            room = 2 * count

    @property
    def _parts(self) -> tuple[np.ndarray, ...]:
        return self.children, self.facets, self.points, self.edges


def facet_areas(mesh: Mesh) -> tuple[Vector, Vector]:
    """Area (length, in the plane) of each facet of the boundary at rest, and of what is nearest each node [m^dim-1]."""
    corners = mesh.nodes[mesh.boundary]
    spans = corners[:, 1:] - corners[:, :1]
    if mesh.dim == 2:
        areas = np.linalg.norm(spans[:, 0], axis=1)
    else:
        areas = 0.5 * np.linalg.norm(np.cross(spans[:, 0], spans[:, 1]), axis=1)
    shares = np.repeat(areas / mesh.dim, mesh.dim)
    return areas, np.bincount(mesh.boundary.ravel(), shares, len(mesh.nodes))


def _owned(features: Int[np.ndarray, "facets each corners"]) -> Int[np.ndarray, "facets each corners"]:
    """Features of facets, each kept by the first facet that has it; -1 elsewhere."""
    flat = features.reshape(-1, features.shape[2])
    _, firsts = np.unique(flat, axis=0, return_index=True)
    owned = np.full_like(flat, -1)
    owned[firsts] = flat[firsts]
    return np.ascontiguousarray(owned.reshape(features.shape))


def _tree(middles: Float[np.ndarray, "facets dim"]) -> Int[np.ndarray, "boxes 2"]:
    """Halve the facets at the median along the longest side of what they span, again and again."""
    children = np.full((max(2 * len(middles) - 1, 0), 2), -1)
    waiting, made = deque([(0, np.arange(len(middles)))] if len(middles) else []), 1
    while waiting:
        box, own = waiting.popleft()
        if len(own) == 1:
            children[box, 1] = own[0]
            continue
        axis = int(np.argmax(np.ptp(middles[own], axis=0)))
        half = len(own) // 2
        order = own[np.argpartition(middles[own, axis], half)]
        children[box] = made, made + 1
        waiting.extend([(made, order[:half]), (made + 1, order[half:])])
        made += 2
    return children


@Kernel
@no_type_check
def _pairs_within(children, facets, points, edges, low, high, stencils, both):
    """Fill in pairs whose boxes meet, as long as there is room; return 1 and how many there are."""
    boxes, still = np.zeros((children.shape[0], 6)), np.zeros((children.shape[0], 6))
    _fit_boxes(children, facets, low, high, boxes)
    listed, kinds = _features(_leaves(children, boxes, still), children, facets, points, edges)
    found = 0
    for pair in range(listed.shape[0]):
        if not _apart(low, high, listed[pair], 2 if kinds[pair] else 1):
            found = _add(found, listed[pair], kinds[pair], stencils, both)
    return 1.0, found


@Kernel
@no_type_check
def _share_of_way(children, facets, points, edges, x, move, rest, kept, reach, stencils, both):
    """Fill in pairs that may come within reach, as long as there is room; return the largest share and their number."""
    boxes, ways = np.zeros((children.shape[0], 6)), np.zeros((children.shape[0], 6))
    _fit_boxes(children, facets, x - 0.5 * reach, x + 0.5 * reach, boxes)
    _fit_boxes(children, facets, move, move, ways)
    listed, kinds = _features(_leaves(children, boxes, ways), children, facets, points, edges)
    y, w, dw, c, way = np.zeros((4, 3)), np.empty(4), np.empty((2, 4)), np.empty(3), np.zeros((4, 3))
    limit, found = 1.0, 0
    for pair in range(listed.shape[0]):
        if _passes(x, move, listed[pair], 2 if kinds[pair] else 1, limit, reach):
            continue
        limit, close = advanced(x, move, rest, listed[pair], kinds[pair], kept, limit, reach, y, way, w, dw, c)
        if close:
            found = _add(found, listed[pair], kinds[pair], stencils, both)
    return limit, found


@njit(**INNER)
@no_type_check
def _fit_boxes(children, facets, low, high, boxes):
    """Fill boxes around the boxes of all nodes, leaves first: lowest corner, then highest."""
    for box in range(children.shape[0] - 1, -1, -1):
        one, other = children[box, 0], children[box, 1]
        for axis in range(low.shape[1]):
            if one >= 0:
                boxes[box, axis] = min(boxes[one, axis], boxes[other, axis])
                boxes[box, 3 + axis] = max(boxes[one, 3 + axis], boxes[other, 3 + axis])
            else:
                least, most = np.inf, -np.inf
                for corner in range(facets.shape[1]):
                    least = min(least, low[facets[other, corner], axis])
                    most = max(most, high[facets[other, corner], axis])
                boxes[box, axis], boxes[box, 3 + axis] = least, most


@njit(**INNER)
@no_type_check
def _leaves(children, boxes, ways):
    """Pairs of leaves whose boxes may meet while they move by `ways`."""
    leaves, found = np.empty((1024, 2), np.int64), 0
    if children.shape[0] == 0:
        return leaves[:0]
    stack = np.empty((4 * children.shape[0] + 4, 2), np.int64)
    stack[0, 0], stack[0, 1], top = 0, 0, 1
    while top > 0:
        top -= 1
        one, other = stack[top, 0], stack[top, 1]
        if one == other:
            left, right = children[one, 0], children[one, 1]
            if left >= 0:
                stack[top, 0], stack[top, 1] = left, left
                stack[top + 1, 0], stack[top + 1, 1] = right, right
                stack[top + 2, 0], stack[top + 2, 1] = left, right
                top += 3
        elif not _clear(boxes[one], ways[one], boxes[other], ways[other]):
            if children[one, 0] < 0 and children[other, 0] < 0:
                if found == leaves.shape[0]:
                    leaves = np.concatenate((leaves, np.empty_like(leaves)))
                leaves[found, 0], leaves[found, 1] = one, other
                found += 1
                continue
            if children[one, 0] < 0 or (children[other, 0] >= 0 and other < one):
                one, other = other, one  # the larger box: they are numbered level by level
            for side in range(2):
                stack[top, 0], stack[top, 1] = children[one, side], other
                top += 1
    return leaves[:found]


@njit(**INNER)
@no_type_check
def _clear(a, u, b, v):
    """Whether two moving boxes stay apart along one axis all the time."""
    for k in range(3):
        gap = a[k] - b[3 + k]
        if gap > 0.0 and gap + u[k] - v[3 + k] > 0.0:
            return True
        gap = b[k] - a[3 + k]
        if gap > 0.0 and gap + v[k] - u[3 + k] > 0.0:
            return True
    return False


@njit(**INNER)
@no_type_check
def _features(leaves, children, facets, points, edges):
    """All pairs of features that belong to pairs of leaves and have no node in common; whether both are edges."""
    dim = facets.shape[1]
    each = 2 * dim + (edges.shape[1] // 2) ** 2
    listed, kinds = np.empty((each * leaves.shape[0], dim + 1), np.int64), np.empty(each * leaves.shape[0], np.bool_)
    stencil, found = np.empty(dim + 1, np.int64), 0
    for pair in range(leaves.shape[0]):
        f, g = children[leaves[pair, 0], 1], children[leaves[pair, 1], 1]
        for _ in range(2):
            stencil[1:] = facets[g]
            for corner in range(dim):
                stencil[0] = points[f, corner]
                if stencil[0] >= 0 and not _shared(stencil, 1):
                    found = _add(found, stencil, False, listed, kinds)
            f, g = g, f
        for i in range(0, edges.shape[1], 2):
            for j in range(0, edges.shape[1], 2):
                if edges[f, i] >= 0 and edges[g, j] >= 0:
                    stencil[:2], stencil[2:] = edges[f, i : i + 2], edges[g, j : j + 2]
                    if not _shared(stencil, 2):
                        found = _add(found, stencil, True, listed, kinds)
    return listed[:found], kinds[:found]


@njit(**INNER)
@no_type_check
def _shared(stencil, first):
    """Whether the two features of a pair have a node in common."""
    for i in range(first):
        for j in range(first, stencil.shape[0]):
            if stencil[i] == stencil[j]:
                return True
    return False


@njit(**INNER)
@no_type_check
def _apart(low, high, stencil, first):
    """Whether the boxes of the two features of a pair do not meet."""
    for axis in range(low.shape[1]):
        ends = np.array([np.inf, -np.inf, np.inf, -np.inf])
        for i in range(stencil.shape[0]):
            side = 0 if i < first else 2
            ends[side] = min(ends[side], low[stencil[i], axis])
            ends[side + 1] = max(ends[side + 1], high[stencil[i], axis])
        if ends[0] > ends[3] or ends[2] > ends[1]:
            return True
    return False


@njit(**INNER)
@no_type_check
def _passes(x, move, stencil, first, limit, reach):
    """Whether the two features of a pair, in boxes that move, stay out of reach along one axis all the time."""
    for k in range(x.shape[1]):
        ends = np.array([[np.inf, -np.inf, np.inf, -np.inf], [np.inf, -np.inf, np.inf, -np.inf]])
        for i in range(stencil.shape[0]):
            side, at, by = ends[0 if i < first else 1], x[stencil[i], k], move[stencil[i], k]
            side[0], side[1] = min(side[0], at), max(side[1], at)
            side[2], side[3] = min(side[2], by), max(side[3], by)
        for turn in range(2):
            a, b = ends[turn], ends[1 - turn]
            gap = a[0] - b[1] - reach
            if gap > 0.0 and gap + limit * (a[2] - b[3]) > 0.0:
                return True
    return False


@njit(**INNER)
@no_type_check
def _add(found, stencil, edges, stencils, both):
    """Put a pair behind those found, if there is room."""
    if found < stencils.shape[0]:
        both[found] = edges
        for i in range(stencil.shape[0]):
            stencils[found, i] = stencil[i]
    return found + 1
