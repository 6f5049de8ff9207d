"""Holes of a surface: found by their open edges, and the small ones closed."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from hydrostat.geometry.healing.sides import sides_of
from hydrostat.geometry.surface import Surface


@dataclass(frozen=True, eq=False)
class Holes:
    """Groups of open edges that hang together.

    Attributes:
        edges: open edges, each the way its triangle runs along it.
        label: number of the hole of each edge.
        length: way around each hole [m].
        simple: holes whose edges are a ring that runs one way.
    """

    edges: Int[np.ndarray, "edges 2"]
    label: Int[np.ndarray, " edges"]
    length: Float[np.ndarray, " holes"]
    simple: Bool[np.ndarray, " holes"]

    def __len__(self) -> int:
        return len(self.length)


def holes_of(surface: Surface) -> Holes:
    """The holes of a surface."""
    sides = sides_of(surface.triangles)
    rows, columns = np.nonzero(sides.open[sides.of])
    edges = np.stack([surface.triangles[rows, columns], surface.triangles[rows, (columns + 1) % 3]], axis=1)
    if not len(edges):
        return Holes(edges, np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0, dtype=bool))
    size = len(surface.vertices)
    graph = coo_array((np.ones(len(edges), dtype=np.int8), edges.T), shape=(size, size))
    label = np.unique(connected_components(graph, directed=False)[1][edges[:, 0]], return_inverse=True)[1]
    ends, starts = (np.bincount(edges[:, side], minlength=size) for side in (1, 0))
    balanced = np.bincount(label, (ends != starts)[edges].any(axis=1)) == 0
    touches = np.bincount(label, (starts > 1)[edges[:, 0]]) > 0
    for group in np.flatnonzero(balanced & touches).tolist():
        _part_rings(edges, label, group)
    label = np.unique(label, return_inverse=True)[1].astype(np.int64)
    lengths = np.linalg.norm(surface.vertices[edges[:, 1]] - surface.vertices[edges[:, 0]], axis=1)
    simple = np.bincount(label, (ends != starts)[edges].any(axis=1)) == 0
    return Holes(edges, label, np.bincount(label, lengths), simple)


def _part_rings(edges: Int[np.ndarray, "edges 2"], label: Int[np.ndarray, " edges"], group: int) -> None:
    """Give each ring of a group of edges, which touch each other in corners, a label of its own."""
    leaving: dict[int, list[int]] = {}
    for edge in np.flatnonzero(label == group).tolist():
        leaving.setdefault(int(edges[edge, 0]), []).append(edge)
    for start in leaving:
        way: list[int] = []
        at, seen = start, {start: 0}
        while leaving[at] or at != start:
            way.append(leaving[at].pop())
            at = int(edges[way[-1], 1])
            if at in seen:
                ring = way[seen[at] :]
                label[ring] = -1 - ring[0]  # no other ring has its first edge
                del way[seen[at] :]
                for edge in ring[:-1]:
                    del seen[int(edges[edge, 1])]
            else:
                seen[at] = len(way)


def with_closed(surface: Surface, holes: Holes, chosen: Bool[np.ndarray, " holes"]) -> Surface:
    """A surface with some of its simple holes closed, each by a fan about its middle; of three edges, by a triangle."""
    edges, label = holes.edges[chosen[holes.label]], holes.label[chosen[holes.label]]
    numbers, label = np.unique(label, return_inverse=True)
    counts = np.bincount(label, minlength=len(numbers))
    middles = np.stack(
        [np.bincount(label, axis, minlength=len(numbers)) for axis in surface.vertices[edges[:, 0]].T], axis=1
    )
    middles /= np.maximum(counts, 1)[:, None]
    fans = np.stack([edges[:, 1], edges[:, 0], len(surface.vertices) + label], axis=1)
    three = counts == 3
    # of a hole of three edges the first edge and the corner opposite to it
    first = np.array([np.flatnonzero(label == hole)[0] for hole in np.flatnonzero(three)], dtype=np.int64)
    opposite = [
        int(np.setdiff1d(edges[label == hole], edges[one])[0])
        for hole, one in zip(np.flatnonzero(three), first, strict=True)
    ]
    lids = np.stack([edges[first, 1], edges[first, 0], np.array(opposite, dtype=np.int64)], axis=1)
    triangles = np.concatenate([surface.triangles, fans[~three[label]], lids])
    used, triangles = np.unique(triangles, return_inverse=True)
    return Surface(np.concatenate([surface.vertices, middles])[used], triangles.reshape(-1, 3))
