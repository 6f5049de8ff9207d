"""`BoundaryTree`: pairs of boundary features that come near one another during a move."""

from collections import deque
from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Float, Int, Nodes
from hydrostat.geometry.mesh import Mesh
from hydrostat.kernel import native

Stencils = Int[np.ndarray, "pairs corners"]


class Pairs(NamedTuple):
    """Features of the boundary that are near one another and have no node in common.

    In the plane a node and an edge; in space a node and a triangle, or two edges.

    Attributes:
        stencils: nodes of each pair, (pairs, 3) in the plane, (pairs, 4) in space; a lone node comes first.
        edges: True where both features are edges, (pairs,).
    """

    stencils: Stencils
    edges: np.ndarray

    def only(self, kept: np.ndarray) -> "Pairs":
        """Return the pairs for which `kept` is true."""
        return Pairs(self.stencils[kept], self.edges[kept])


class BoundaryTree:
    """Bounding volume hierarchy of the facets of a mesh's boundary: a tree of boxes, made once for a body.

    Each node and each edge belongs to one facet of those around it, so that a pair is found once.

    Attributes:
        facets: nodes of each facet, (facets, dim).
        points: nodes that belong to each facet, (facets, dim), padded with -1.
        edges: in space, both ends of the edges that belong to each facet, (facets, 6), padded with -1.
        children: children of each box, (boxes, 2); those of a leaf are -1 and its facet. Children come after their
            parents.
    """

    def __init__(self, mesh: Mesh) -> None:
        """Tree of the boundary of a mesh at rest."""
        self.facets = np.ascontiguousarray(mesh.boundary)
        count, dim = self.facets.shape
        self.points = _assign_features(self.facets[:, :, None])[:, :, 0]
        turned = np.stack([self.facets, np.roll(self.facets, -1, axis=1)], axis=2)
        edges = _assign_features(np.sort(turned, axis=2)) if dim == 3 else np.full((count, 0, 2), -1)
        self.edges = np.ascontiguousarray(edges.reshape(count, -1))
        self.children = _tree(mesh.nodes[self.facets].mean(axis=1))
        self._rest = mesh.nodes

    def pairs(self, nodes: Nodes, reach: float) -> Pairs:
        """Pairs of features within reach [m] of one another."""
        return self.sweep(nodes, np.zeros_like(nodes), nodes, kept=0.0, reach=reach)[1]

    def sweep(self, nodes: Nodes, move: Nodes, rest: Nodes, *, kept: float, reach: float) -> tuple[float, Pairs]:
        """Largest share of a straight move, at most 1, that is admissible, and the pairs within reach at its end.

        Args:
            nodes: node positions at the start [m].
            move: displacement of each node [m].
            rest: rest positions of the nodes [m]; pairs that touch there are not limited.
            kept: share of its distance that each pair is to keep.
            reach: up to which distance pairs are told [m].
        """
        known = *self._parts, *self._at_rest
        return self._fill_pairs(lambda *pairs: native.sweep_boundary(*known, nodes, move, rest, kept, reach, *pairs))

    def _fill_pairs(self, fill: Callable[[np.ndarray, np.ndarray], tuple[float, int]]) -> tuple[float, Pairs]:
        """Run a loop that fills in pairs, again with a larger buffer if needed; return its value and the pairs."""
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

        So no sweep goes down the tree from its root again, to facets that are neighbors anyway.
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


def _assign_features(features: Int[np.ndarray, "facets each corners"]) -> Int[np.ndarray, "facets each corners"]:
    """Features of facets, each kept by the first facet that has it; -1 elsewhere."""
    flat = features.reshape(-1, features.shape[2])
    _, firsts = np.unique(flat, axis=0, return_index=True)
    owned = np.full_like(flat, -1)
    owned[firsts] = flat[firsts]
    return np.ascontiguousarray(owned.reshape(features.shape))


def _tree(middles: Float[np.ndarray, "facets dim"]) -> Int[np.ndarray, "boxes 2"]:
    """Build the tree: halve the facets recursively at the median along the longest side of their box."""
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
