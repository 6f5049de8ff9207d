"""`BoundaryTree`: which parts of a body's boundary come near one another on the way from one place to another."""

from collections import deque
from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple, no_type_check

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Nodes, Vector
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.pair_distances import advanced, dot, nearest, place
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
        self._rest = mesh.nodes

    def pairs(self, nodes: Nodes, reach: float) -> Pairs:
        """Pairs of features within reach [m] of one another."""
        return self.sweep(nodes, np.zeros_like(nodes), nodes, kept=0.0, reach=reach)[1]

    def sweep(self, nodes: Nodes, move: Nodes, rest: Nodes, *, kept: float, reach: float) -> tuple[float, Pairs]:
        """Largest share of a straight move, at most 1, that is admissible, and the pairs within reach at its end.

        Args:
            nodes: where it begins [m].
            move: of each node [m].
            rest: where the nodes are at rest [m]: pairs that touch there may do as they like.
            kept: share of its distance that each pair is to keep.
            reach: up to which distance pairs are told [m].
        """
        known = *self._parts, *self._at_rest
        return self._filled(lambda *pairs: _sweep_boundary(*known, nodes, move, rest, kept, reach, *pairs))

    def _filled(self, fill: Callable[[np.ndarray, np.ndarray], tuple[float, int]]) -> tuple[float, Pairs]:
        """What a loop tells, and the pairs that it fills in; again with more room where that was too little."""
        room = 64 + 8 * len(self.facets)
        while True:
            stencils, edges = np.empty((room, self.facets.shape[1] + 1), np.int64), np.empty(room, np.bool_)
            told, count = fill(stencils, edges)
            if count <= room:
                return told, Pairs(stencils[:count], edges[:count])
            room = 2 * count

    @cached_property
    def _at_rest(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Largest boxes that are apart at rest, in pairs, and the pairs of features of all facets whose boxes meet.

        So no sweep goes down the tree from its root again, to facets that are neighbours anyway.
        """
        children, leaf = self.children, self.children[:, 0] < 0
        low, high = self._boxes_at_rest()
        pairs = np.zeros((min(len(children), 1), 2), np.int64)
        apart, met = [np.empty((0, 2), np.int64)], [np.empty((0, 2), np.int64)]
        while len(pairs):
            same, (one, other) = pairs[:, 0] == pairs[:, 1], pairs.T
            free = ((low[one] > high[other]) | (low[other] > high[one])).any(axis=1)
            ends = leaf[one] & leaf[other]
            apart.append(pairs[free])
            met.append(pairs[~free & ends & ~same])
            split = pairs[~free & ~ends & ~same]
            turn = leaf[split[:, 0]] | (~leaf[split[:, 1]] & (split[:, 1] < split[:, 0]))
            split[turn] = split[turn, ::-1]
            own = children[pairs[same & ~ends, 0]]
            halves = [np.column_stack([children[split[:, 0], side], split[:, 1]]) for side in range(2)]
            pairs = np.concatenate([own[:, [0, 0]], own[:, [1, 1]], own, *halves])
        front = np.concatenate(apart)
        listed, kinds = self._features_of(children[np.concatenate(met), 1])
        return front[np.lexsort(front.T)], listed, kinds

    def _boxes_at_rest(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of each box at rest [m], (boxes, dim), level by level from the leaves."""
        children, leaf = self.children, self.children[:, 0] < 0
        corners = self._rest[self.facets[np.where(leaf, children[:, 1], 0)]] if len(children) else self._rest[:0, None]
        low, high = corners.min(axis=1), corners.max(axis=1)
        levels = [np.arange(min(len(children), 1))]
        while len(levels[-1]):
            levels.append(children[levels[-1][~leaf[levels[-1]]]].ravel())
        for level in reversed(levels):
            inner = level[~leaf[level]]
            one, other = children[inner].T
            low[inner], high[inner] = np.minimum(low[one], low[other]), np.maximum(high[one], high[other])
        return low, high

    def _features_of(self, met: Int[np.ndarray, "pairs 2"]) -> Pairs:
        """All pairs of features that belong to pairs of facets and have no node in common."""
        dim, (one, other) = self.facets.shape[1], met.T
        edges = self.edges.reshape(len(self.facets), -1, 2)
        rows, kept = range(edges.shape[1]), []
        lone = [(self.points[f, i, None], self.facets[g]) for f, g in ((one, other), (other, one)) for i in range(dim)]
        both = [(edges[one, i], edges[other, j]) for i in rows for j in rows]
        for features, first in ((lone, 1), (both, 2)):
            there = [(left[:, 0] >= 0) & (right[:, 0] >= 0) for left, right in features]
            chosen = [np.hstack([left[own], right[own]]) for (left, right), own in zip(features, there, strict=True)]
            stencils = np.concatenate([np.empty((0, dim + 1), np.int64), *chosen])
            shared = (stencils[:, :first, None] == stencils[:, None, first:]).any(axis=(1, 2))
            kept.append(stencils[~shared])
        return Pairs(np.concatenate(kept), np.repeat([False, True], [len(part) for part in kept]))

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
def _sweep_boundary(children, facets, points, edges, front, beside, kinds, x, move, rest, kept, reach, stencils, both):
    """Fill in pairs that end within reach, as long as there is room; return the largest share and their number."""
    boxes, ways = np.zeros((children.shape[0], 6)), np.zeros((children.shape[0], 6))
    _fit_boxes(children, facets, x - 0.5 * reach, x + 0.5 * reach, boxes)
    _fit_boxes(children, facets, move, move, ways)
    met, met_kinds = _features(_leaves(children, boxes, ways, front), children, facets, points, edges)
    y, w, dw, c, way = np.zeros((4, 3)), np.empty(4), np.empty((2, 4)), np.empty(3), np.zeros((4, 3))
    limit, found = 1.0, 0
    for listed, edged in ((beside, kinds), (met, met_kinds)):
        for pair in range(listed.shape[0]):
            if _passes(x, move, listed[pair], 2 if edged[pair] else 1, limit, reach, kept, y, way):
                continue
            limit, close = advanced(x, move, rest, listed[pair], edged[pair], kept, limit, reach, y, way, w, dw, c)
            if close:
                found = _add(found, listed[pair], edged[pair], stencils, both)
    if found > stencils.shape[0]:
        return limit, found
    last = 0
    for pair in range(found):
        place(x, stencils[pair], y)
        place(move, stencils[pair], way)
        y += limit * way
        if nearest(y, stencils.shape[1], both[pair], 0.0, w, dw, c)[1] < reach * reach:
            last = _add(last, stencils[pair], both[pair], stencils, both)
    return limit, last


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
def _leaves(children, boxes, ways, front):
    """Pairs of leaves below some pairs of boxes that may meet while they move by `ways`."""
    leaves, found = np.empty((1024, 2), np.int64), 0
    stack = np.empty((4 * children.shape[0] + 4, 2), np.int64)
    top, following = 0, 0
    while top > 0 or following < front.shape[0]:
        if top == 0:
            stack[0], top, following = front[following], 1, following + 1
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
def _passes(x, move, stencil, first, limit, reach, kept, y, way):
    """Whether a plane across the line between the middles of two features keeps them apart, up to a share of the move.

    So far apart that they neither come within reach nor lose more of their gap than is allowed. y and way are room.
    """
    place(x, stencil, y)
    place(move, stencil, way)
    corners = stencil.shape[0]
    before, across = np.zeros(3), np.zeros(3)
    for k in range(3):
        for i in range(corners):
            weight = 1.0 / first if i < first else -1.0 / (corners - first)
            before[k] += weight * y[i, k]
            across[k] += weight * (y[i, k] + 0.5 * limit * way[i, k])
    ends = np.array([[np.inf, -np.inf], [np.inf, -np.inf]])
    for i in range(corners):
        begin = dot(across, y[i])
        for turn, at in enumerate((begin, begin + limit * dot(across, way[i]))):
            if i < first:
                ends[turn, 0] = min(ends[turn, 0], at)
            else:
                ends[turn, 1] = max(ends[turn, 1], at)
    gap = min(ends[0, 0] - ends[0, 1], ends[1, 0] - ends[1, 1])
    wanted = max(reach * reach, 1.44 * kept * kept * dot(before, before)) * dot(across, across)
    return gap > 0.0 and gap * gap > wanted


@njit(**INNER)
@no_type_check
def _add(found, stencil, edges, stencils, both):
    """Put a pair behind those found, if there is room."""
    if found < stencils.shape[0]:
        both[found] = edges
        for i in range(stencil.shape[0]):
            stencils[found, i] = stencil[i]
    return found + 1
