"""`Sides`: how the triangles of a surface meet along their edges."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


@dataclass(frozen=True, eq=False)
class Sides:
    """Edges of triangles, and which triangle has which.

    Attributes:
        triangles: indices of three vertices each, no vertex twice in one.
        ends: both vertices of every edge, the lower first.
        of: the edges of each triangle: between its corners 0 and 1, 1 and 2, 2 and 0.
    """

    triangles: Int[np.ndarray, "triangles 3"]
    ends: Int[np.ndarray, "edges 2"]
    of: Int[np.ndarray, "triangles 3"]

    @cached_property
    def counts(self) -> Int[np.ndarray, " edges"]:
        """How many triangles each edge has."""
        return np.bincount(self.of.ravel(), minlength=len(self.ends))

    @cached_property
    def turns(self) -> Int[np.ndarray, " edges"]:
        """How often an edge is run along from its lower to its higher end, less how often the other way."""
        ways = np.where(self.triangles < np.roll(self.triangles, -1, axis=1), 1, -1)
        return np.bincount(self.of.ravel(), ways.ravel(), minlength=len(self.ends)).astype(np.int64)

    @property
    def open(self) -> Bool[np.ndarray, " edges"]:
        """Edges with one triangle only."""
        return self.counts == 1

    @property
    def crowded(self) -> Bool[np.ndarray, " edges"]:
        """Edges with more than two triangles."""
        return self.counts > 2

    @property
    def twisted(self) -> Bool[np.ndarray, " edges"]:
        """Edges of two triangles that run along it the same way."""
        return (self.counts == 2) & (self.turns != 0)

    def groups(self, joins: Bool[np.ndarray, " edges"]) -> Int[np.ndarray, " triangles"]:
        """Number of the group of each triangle, where triangles are joined by some of the edges."""
        rows, columns = np.nonzero(joins[self.of])
        nodes = len(self.of) + self.of[rows, columns]  # a node for each triangle, and one for each edge
        size = len(self.of) + len(self.ends)
        graph = coo_array((np.ones(len(rows), dtype=np.int8), (rows, nodes)), shape=(size, size))
        labels = connected_components(graph, directed=False)[1][: len(self.of)]
        return np.unique(labels, return_inverse=True)[1].astype(np.int64)


def members(label: Int[np.ndarray, " some"]) -> list[Int[np.ndarray, " _"]]:
    """Which have each label, for labels from 0 on that all occur."""
    return np.split(np.argsort(label, kind="stable"), np.cumsum(np.bincount(label))[:-1])


def sides_of(triangles: Int[np.ndarray, "triangles 3"]) -> Sides:
    """The edges of triangles."""
    pairs = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    keys = pairs[:, 0] * (int(triangles.max(initial=0)) + 1) + pairs[:, 1]
    _, first, place = np.unique(keys, return_index=True, return_inverse=True)
    return Sides(triangles, pairs[first], place.reshape(-1, 3).astype(np.int64))
