"""`find_crossings`: where a deformed body passes through itself."""

from dataclasses import dataclass
from itertools import product

import numpy as np
from shapely import STRtree, linestrings

from hydrostat.arrays import Bool, Float, Int, Nodes
from hydrostat.geometry.mesh import Mesh

Pairs = Int[np.ndarray, "crossings 2"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Crossings:
    """Self-intersections of the boundary of a body.

    Attributes:
        places: positions of the intersections [m].
        facets: pairs of intersecting facets of `Mesh.boundary`; in space the piercing edge is of the first facet.
    """

    places: Float[np.ndarray, "crossings dim"]
    facets: Pairs

    def __len__(self) -> int:
        return len(self.places)

    def __str__(self) -> str:
        """One sentence, with the first place in mm; empty where there is none."""
        if not len(self):
            return ""
        first = ", ".join(f"{1e3 * value:.0f}" for value in self.places[0])
        return f"self-intersection, e.g. at [{first}] mm. Contact is off: add [contact] to robot.toml"


def find_crossings(mesh: Mesh, nodes: Nodes) -> Crossings:
    """Find where the boundary of a mesh cuts itself, its nodes being at other places [m].

    In the plane boundary edges are cut with boundary edges, in space edges with triangles, but those that share a node.
    Edges that lie in the plane of a triangle do not cut it. A part that has passed wholly into another, and cuts no
    boundary, is not seen.
    """
    return (_flat if mesh.dim == 2 else _solid)(mesh, nodes)


def _flat(mesh: Mesh, nodes: Nodes) -> Crossings:
    ends = nodes[mesh.boundary]
    lines = np.asarray(linestrings(ends))
    one, other = STRtree(lines).query(lines, predicate="intersects")
    kept = (one < other) & ~_share(mesh.boundary[one], mesh.boundary[other])
    one, other = one[kept], other[kept]
    start, along = ends[one, 0], ends[one, 1] - ends[one, 0]
    first, across = ends[other, 0], ends[other, 1] - ends[other, 0]
    turned = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
    gap = first - start
    share = (gap[:, 0] * across[:, 1] - gap[:, 1] * across[:, 0]) / np.where(turned == 0, 1.0, turned)
    places = start + np.clip(np.where(turned == 0, 0.0, share), 0.0, 1.0)[:, None] * along
    return Crossings(places=places, facets=np.column_stack([one, other]))


def _solid(mesh: Mesh, nodes: Nodes) -> Crossings:
    facets = mesh.boundary
    every = np.sort(np.concatenate([facets[:, [0, 1]], facets[:, [1, 2]], facets[:, [2, 0]]]), axis=1)
    edges, firsts = np.unique(every, axis=0, return_index=True)
    owners = firsts % len(facets)
    corners, ends = nodes[facets], nodes[edges]
    edge, facet = find_near_pairs(ends, corners).T
    apart = ~_share(edges[edge], facets[facet])
    edge, facet = edge[apart], facet[apart]
    pierced, places = _intersect_triangles(ends[edge], corners[facet])
    return Crossings(places=places[pierced], facets=np.column_stack([owners[edge], facet])[pierced])


def _intersect_triangles(
    ends: Float[np.ndarray, "pairs 2 3"], corners: Float[np.ndarray, "pairs 3 3"]
) -> tuple[Bool[np.ndarray, " pairs"], Float[np.ndarray, "pairs 3"]]:
    """Mask of the segments that cut their triangles, and the intersection points (Moeller and Trumbore 1997)."""
    along = ends[:, 1] - ends[:, 0]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(along, two)
    scale = np.einsum("pi,pi->p", one, normal)
    lengths = np.linalg.norm([along, one, two], axis=2).prod(axis=0)
    parallel = 1e-9  # of the volume of three edges: what spans less lies in one plane, and cuts nothing
    across = np.abs(scale) > parallel * lengths
    safe = np.where(across, scale, 1.0)
    gap = ends[:, 0] - corners[:, 0]
    u = np.einsum("pi,pi->p", gap, normal) / safe
    turned = np.cross(gap, one)
    v = np.einsum("pi,pi->p", along, turned) / safe
    share = np.einsum("pi,pi->p", two, turned) / safe
    inside = across & (u >= 0) & (v >= 0) & (u + v <= 1) & (share >= 0) & (share <= 1)
    return inside, ends[:, 0] + share[:, None] * along


def _share(one: Int[np.ndarray, "pairs _"], other: Int[np.ndarray, "pairs _"]) -> Bool[np.ndarray, " pairs"]:
    """Mask of the pairs of facets that have a node in common."""
    return (one[:, :, None] == other[:, None, :]).any(axis=(1, 2))


Corners = Float[np.ndarray, "_ _ 3"]


def find_near_pairs(one: Corners, other: Corners) -> Int[np.ndarray, "pairs 2"]:
    """Pairs of an item of `one` and an item of `other` whose bounding boxes meet, sorted.

    Items are edges or triangles in space, by their corners [m]. A cell of the grid is as large as two boxes of the
    largest size can be apart between their centers, thus only neighboring cells are searched. Items that are not
    finite are near none.
    """
    if not len(one) or not len(other):
        return np.empty((0, 2), dtype=np.int64)
    finite = [np.isfinite(items).all(axis=(1, 2)) for items in (one, other)]
    if not (finite[0].all() and finite[1].all()):
        found = find_near_pairs(one[finite[0]], other[finite[1]])
        return np.column_stack([np.flatnonzero(kept)[found[:, side]] for side, kept in enumerate(finite)])
    lows, highs = (one.min(axis=1), other.min(axis=1)), (one.max(axis=1), other.max(axis=1))
    centers = [0.5 * (low + high) for low, high in zip(lows, highs, strict=True)]
    origin = np.minimum(centers[0].min(axis=0), centers[1].min(axis=0))
    span = float(max((center - origin).max() for center in centers))
    largest = sum(0.5 * float((high - low).max()) for low, high in zip(lows, highs, strict=True))
    side = max(1.001 * largest, span / _MAX_CELLS) or 1.0
    first, second = (((center - origin) / side).astype(np.int64) + 1 for center in centers)
    key = np.array([(_MAX_CELLS + 4) ** 2, _MAX_CELLS + 4, 1])
    order = np.argsort(second @ key, kind="stable")
    kept = (second @ key)[order]
    steps = np.array(list(product((-1, 0, 1), (-1, 0, 1)))) @ key[:2]  # three cells along z have keys in a row
    asked = (first @ key)[:, None] + steps
    begins, ends = np.searchsorted(kept, asked - 1, "left"), np.searchsorted(kept, asked + 1, "right")
    counts = (ends - begins).ravel()
    i = np.repeat(np.repeat(np.arange(len(one)), len(steps)), counts)
    j = order[np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts - begins.ravel(), counts)]
    for axis in range(3):  # one after the other: the first leaves few
        meet = (lows[0][i, axis] <= highs[1][j, axis]) & (lows[1][j, axis] <= highs[0][i, axis])
        i, j = i[meet], j[meet]
    pairs = np.column_stack([i, j])
    return pairs[np.lexsort((j, i))]


_MAX_CELLS = 1_000_000
"""Cells along an axis, at most."""
