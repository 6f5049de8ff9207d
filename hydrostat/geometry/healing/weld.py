"""Joining of what should be one: vertices in the same place, triangles that stand there twice."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from hydrostat.errors import SurfaceError
from hydrostat.geometry.healing.sides import sides_of
from hydrostat.geometry.surface import Surface

NEAR = 1e-6
"""Vertices nearer to each other than this part of the surface's size are one."""


@dataclass(frozen=True, eq=False)
class Welded:
    """A surface whose triangles have vertices in common, and none of which stands there twice.

    Attributes:
        surface: what is left, its vertices in the order of the input.
        merged: how many vertices were the same as another.
        flat: how many triangles had two corners in one place, and are left out.
        repeated: how many stood there before, and are left out.
        walls: how many lay back to back with another between two rooms, and are left out with it.
    """

    surface: Surface
    merged: int
    flat: int
    repeated: int
    walls: int


def weld(surface: Surface) -> Welded:
    """Merge vertices in the same place; leave out triangles without a side, repeated ones, and walls inside.

    Raises:
        SurfaceError: no triangle is left.
    """
    used = np.unique(surface.triangles)
    place = _merged(surface, used)
    triangles = place[surface.triangles]
    one, two, three = triangles.T
    whole = (one != two) & (two != three) & (three != one)
    triangles = triangles[whole]
    keep, walls = _kept(triangles)
    if not keep.any():
        raise SurfaceError("the surface encloses nothing: none of its triangles has an area; export it again")
    left, triangles = np.unique(triangles[keep], return_inverse=True)
    return Welded(
        surface=Surface(surface.vertices[left], triangles.reshape(-1, 3)),
        merged=len(used) - len(np.unique(place[used])),
        flat=int((~whole).sum()),
        repeated=int((~keep).sum()) - walls,
        walls=walls,
    )


def _merged(surface: Surface, used: Int[np.ndarray, " used"]) -> Int[np.ndarray, " vertices"]:
    """For each vertex the first of those in its place."""
    places = surface.vertices[used] - surface.box[0]
    cell = 4 * NEAR * surface.size
    joins = [
        _same_cell(places / cell + shift) for shift in (0.0, 0.5)
    ]  # not pairs: where all is in one place, too many
    graph = coo_array((np.ones(2 * len(used)), np.concatenate(joins, axis=1)), shape=(len(used), len(used)))
    labels = connected_components(graph, directed=False)[1]
    _, first = np.unique(labels, return_index=True)
    result = np.arange(len(surface.vertices))
    result[used] = used[first[labels]]
    return result


def _same_cell(places: Float[np.ndarray, "points 3"]) -> Int[np.ndarray, "2 points"]:
    """Each point and the first of those in the same cell of a grid."""
    _, first, which = np.unique(np.floor(places), axis=0, return_index=True, return_inverse=True)
    return np.stack([np.arange(len(places)), first[which.ravel()]])


def _kept(triangles: Int[np.ndarray, "triangles 3"]) -> tuple[Bool[np.ndarray, " triangles"], int]:
    """Which triangles stay of those with the same three vertices, and how many go because they are walls.

    Copies that look the same way leave one. A patch of copies that look both ways is a wall between two rooms where
    it meets more than one other triangle at an edge, and goes; else the surface was saved with both its sides, and
    one stays.
    """
    keys = np.sort(triangles, axis=1)
    _, first, group, counts = np.unique(keys, axis=0, return_index=True, return_inverse=True, return_counts=True)
    keep = np.zeros(len(triangles), dtype=bool)
    keep[first] = True
    ranks = np.argsort(np.argsort(triangles, axis=1), axis=1)
    even = (ranks[:, 1] - ranks[:, 0]) % 3 == 1
    evens = np.bincount(group.ravel(), even, minlength=len(first))
    both = np.flatnonzero((evens > 0) & (evens < counts))
    if len(both):
        sides = sides_of(triangles[first])
        crowded = sides.crowded[sides.of[both]].any(axis=1)
        patch = sides_of(triangles[first[both]])
        patches = patch.groups(patch.counts > 1)
        gone = both[np.isin(patches, patches[crowded])]
        keep[first[gone]] = False
        return keep, int(counts[gone].sum())
    return keep, 0
