"""Repairs along edges, from `Sides`: equal vertices are merged, triangles oriented, small holes closed."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hydrostat.arrays import Bool, Float, Int
from hydrostat.errors import SurfaceError
from hydrostat.geometry.mesh import joined_groups
from hydrostat.geometry.surface import Surface


@dataclass(frozen=True, eq=False)
class Sides:
    """Edges of triangles, and which triangle has which."""

    triangles: Int[np.ndarray, "triangles 3"]  # indices of three vertices each, no vertex twice in one
    ends: Int[np.ndarray, "edges 2"]  # both vertices of every edge, the lower first
    of: Int[np.ndarray, "triangles 3"]  # the edges of each triangle: between its corners 0 and 1, 1 and 2, 2 and 0

    @cached_property
    def counts(self) -> Int[np.ndarray, " edges"]:
        """Number of triangles at each edge."""
        return np.bincount(self.of.ravel(), minlength=len(self.ends))

    @cached_property
    def turns(self) -> Int[np.ndarray, " edges"]:
        """Times an edge is run along from its lower to its higher end, less the times the other way."""
        ways = np.where(self.triangles < np.roll(self.triangles, -1, axis=1), 1, -1)
        return np.bincount(self.of.ravel(), ways.ravel(), minlength=len(self.ends)).astype(np.int64)

    @property
    def open(self) -> Bool[np.ndarray, " edges"]:
        """Edges with one triangle only."""
        return self.counts == 1

    @property
    def is_non_manifold(self) -> Bool[np.ndarray, " edges"]:
        """Edges with more than two triangles."""
        return self.counts > 2

    @property
    def is_misoriented(self) -> Bool[np.ndarray, " edges"]:
        """Edges of two triangles that run along it the same way."""
        return (self.counts == 2) & (self.turns != 0)

    def groups(self, joins: Bool[np.ndarray, " edges"]) -> Int[np.ndarray, " triangles"]:
        """Number of the group of each triangle, where triangles are joined by some of the edges."""
        rows, columns = np.nonzero(joins[self.of])
        nodes = len(self.of) + self.of[rows, columns]  # a node for each triangle, and one for each edge
        labels = joined_groups(np.stack([rows, nodes]), len(self.of) + len(self.ends))[: len(self.of)]
        return np.unique(labels, return_inverse=True)[1].astype(np.int64)


def members_of(label: Int[np.ndarray, " some"]) -> list[Int[np.ndarray, " _"]]:
    """Indices of the members of each label, for labels from 0 on that all occur."""
    return np.split(np.argsort(label, kind="stable"), np.cumsum(np.bincount(label))[:-1])


def sides_of(triangles: Int[np.ndarray, "triangles 3"]) -> Sides:
    """Edges of triangles."""
    pairs = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    keys = pairs[:, 0] * (int(triangles.max(initial=0)) + 1) + pairs[:, 1]
    _, first, place = np.unique(keys, return_index=True, return_inverse=True)
    return Sides(triangles, pairs[first], place.reshape(-1, 3).astype(np.int64))


MERGE_TOLERANCE = 1e-6  # vertices nearer to each other than this part of the surface's size are one


@dataclass(frozen=True, eq=False)
class Welded:
    """Surface with shared vertices and without duplicates."""

    surface: Surface  # resulting surface, its vertices in the order of the input
    merged: int  # number of merged duplicate vertices
    flat: int  # number of removed triangles with two corners in one place
    repeated: int  # number of removed duplicate triangles
    walls: int  # number of removed triangles that lay back to back between two cavities


def weld(surface: Surface) -> Welded:
    """Merge vertices in one place; leave out flat or repeated triangles, walls inside (SurfaceError: none is left)."""
    used = np.unique(surface.triangles)
    place = _first_in_place(surface, used)
    triangles = place[surface.triangles]
    one, two, three = triangles.T
    whole = (one != two) & (two != three) & (three != one)
    triangles = triangles[whole]
    keep, walls = _without_copies(triangles)
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


def _first_in_place(surface: Surface, used: Int[np.ndarray, " used"]) -> Int[np.ndarray, " vertices"]:
    """Find for each vertex the first of those in its place."""
    places = surface.vertices[used] - surface.box[0]
    cell = 4 * MERGE_TOLERANCE * surface.size
    joins = [
        _same_cell(places / cell + shift) for shift in (0.0, 0.5)
    ]  # not pairs: where all is in one place, too many
    labels = joined_groups(np.concatenate(joins, axis=1), len(used))
    _, first = np.unique(labels, return_index=True)
    result = np.arange(len(surface.vertices))
    result[used] = used[first[labels]]
    return result


def _same_cell(places: Float[np.ndarray, "points 3"]) -> Int[np.ndarray, "2 points"]:
    """Each point and the first of those in the same cell of a grid."""
    _, first, which = np.unique(np.floor(places), axis=0, return_index=True, return_inverse=True)
    return np.stack([np.arange(len(places)), first[which.ravel()]])


def _without_copies(triangles: Int[np.ndarray, "triangles 3"]) -> tuple[Bool[np.ndarray, " triangles"], int]:
    """Choose the triangles that stay of those with the same three vertices; count those that go as walls.

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
        crowded = sides.is_non_manifold[sides.of[both]].any(axis=1)
        patch = sides_of(triangles[first[both]])
        patches = patch.groups(patch.counts > 1)
        gone = both[np.isin(patches, patches[crowded])]
        keep[first[gone]] = False
        return keep, int(counts[gone].sum())
    return keep, 0


def one_way(
    triangles: Int[np.ndarray, "triangles 3"],
) -> tuple[Int[np.ndarray, "triangles 3"], Bool[np.ndarray, " triangles"]]:
    """Orient triangles like most of their patch, joined by edges of two triangles; return the mask of those turned."""
    import igl

    result, patches = igl.bfs_orient(triangles)
    patch = np.array(patches).astype(np.int64)
    turned = (np.array(result) != triangles).any(axis=1)
    most = 2 * np.bincount(patch, turned) > np.bincount(patch)
    turned ^= most[patch]
    return np.where(turned[:, None], triangles[:, ::-1], triangles), turned


@dataclass(frozen=True, eq=False)
class Holes:
    """Groups of open edges that hang together."""

    edges: Int[np.ndarray, "edges 2"]  # open edges, each the way its triangle runs along it
    label: Int[np.ndarray, " edges"]  # index of the hole of each edge
    length: Float[np.ndarray, " holes"]  # perimeter of each hole [m]
    simple: Bool[np.ndarray, " holes"]  # holes whose edges are a ring that runs one way

    def __len__(self) -> int:
        return len(self.length)


def holes_of(surface: Surface) -> Holes:
    """Holes of a surface."""
    sides = sides_of(surface.triangles)
    rows, columns = np.nonzero(sides.open[sides.of])
    edges = np.stack([surface.triangles[rows, columns], surface.triangles[rows, (columns + 1) % 3]], axis=1)
    if not len(edges):
        return Holes(edges, np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0, dtype=bool))
    size = len(surface.vertices)
    label = np.unique(joined_groups(edges.T, size)[edges[:, 0]], return_inverse=True)[1]
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
    """Surface with some of its simple holes closed, each by a fan about its middle; of three edges, by a triangle."""
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
