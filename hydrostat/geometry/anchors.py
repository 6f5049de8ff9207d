"""`Anchors`: points attached to the material of a mesh; distances of points from its boundary."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Nodes, Points
from hydrostat.errors import InputError
from hydrostat.geometry.mesh import Mesh

if TYPE_CHECKING:
    from scipy.sparse import csr_array

_AT_ONCE = 3_000_000  # pairs of point and facet whose distances are looked at together


@dataclass(frozen=True, eq=False)
class Anchors:
    """Points held by an element and barycentric weights (R24, E10)."""

    stencils: Int[np.ndarray, "points corners"]  # nodes of the element that holds each point, (points, dim + 1)
    weights: Float[np.ndarray, "points corners"]  # barycentric weights, rows sum to one
    distances: Float[np.ndarray, " points"]  # distance of each requested point from the body [m]; 0 inside

    def positions(self, nodes: Nodes) -> Points:
        """Positions [m] of the anchors when the nodes are at `nodes` [m]."""
        return np.einsum("pc,pcd->pd", self.weights, nodes[self.stencils])

    def matrix(self, node_count: int) -> "csr_array":
        """Sparse interpolation matrix W, (points, nodes): positions = W @ nodes."""
        from scipy.sparse import csr_array

        rows = np.repeat(np.arange(len(self.stencils)), self.stencils.shape[1])
        entries = (self.weights.ravel(), (rows, self.stencils.ravel()))
        return csr_array(entries, shape=(len(self.stencils), node_count))

    def select_points(self, points: Int[np.ndarray, " select_points"] | Sequence[int]) -> "Anchors":
        """Some of them, by number."""
        which = np.asarray(points, dtype=np.int64)
        return Anchors(self.stencils[which], self.weights[which], self.distances[which])

    @property
    def inside(self) -> Bool[np.ndarray, " points"]:
        """Mask of the points inside the body; a distance of 1e-9 of an element counts as inside."""
        return self.distances == 0.0

    @staticmethod
    def at_nodes(mesh: Mesh, chosen: Int[np.ndarray, " points"]) -> "Anchors":
        """Anchors at nodes of a mesh, given by number: each held by the first element that has it, with weight one."""
        first = np.full(len(mesh.nodes), len(mesh.elements))
        np.minimum.at(first, mesh.elements, np.arange(len(mesh.elements))[:, None])
        if (first[chosen] == len(mesh.elements)).any():  # a node of no element is a point like any other
            return locate(mesh, mesh.nodes[chosen])
        stencils = mesh.elements[first[chosen]]
        return Anchors(stencils, (stencils == chosen[:, None]).astype(float), np.zeros(len(chosen)))


def locate(mesh: Mesh, points: Points) -> Anchors:
    """Stick points to the rest shape of a mesh.

    A point inside is held by the element in which it lies deepest, by its least weight; of several by the first. A
    point outside is stuck to the nearest place of the body; `distances` says how far that was. Raises InputError: the
    points are not finite or have another dimension than the mesh.
    """
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != mesh.dim or not np.isfinite(points).all():
        raise InputError(f"points on a mesh of dimension {mesh.dim} must be finite, (points, {mesh.dim})")
    held, weights = _holders(mesh, points)
    distances = np.zeros(len(points))
    outside = np.flatnonzero(held < 0)
    if outside.size:
        held[outside], weights[outside], distances[outside] = _nearest(mesh, points[outside])
    weights = np.clip(weights, 0.0, None)
    return Anchors(mesh.elements[held], weights / weights.sum(axis=1, keepdims=True), distances)


def _spans(corners: Float[np.ndarray, "simplices corners dim"]) -> Float[np.ndarray, "simplices sides dim"]:
    """Edges from the first corner of each simplex to the others."""
    return corners[:, 1:] - corners[:, :1]


def _holders(mesh: Mesh, points: Points) -> tuple[Int[np.ndarray, " points"], Float[np.ndarray, "points corners"]]:
    """Element in which each point lies deepest, and its barycentric weights there; -1 and 0 where it is in none."""
    asked, elements = _in_boxes(mesh, points)
    shifts = points[asked] - mesh.nodes[mesh.elements[elements, 0]]
    local = np.einsum("pij,pj->pi", mesh.inverse_spans[elements], shifts)
    weights = np.concatenate([1.0 - local.sum(axis=1, keepdims=True), local], axis=1)
    depth = weights.min(axis=1)
    order = np.lexsort((elements, -depth, asked))
    hair = 1e-9  # a point this little outside counts as inside, in heights of its element
    order = order[depth[order] >= -hair]
    first = _firsts(asked[order])
    found, order = asked[order][first], order[first]
    held, shares = np.full(len(points), -1), np.zeros((len(points), mesh.dim + 1))
    held[found], shares[found] = elements[order], weights[order]
    return held, shares


def _firsts(rising: Int[np.ndarray, " pairs"]) -> Bool[np.ndarray, " pairs"]:
    """Mask of the first occurrences in a sorted array."""
    return np.append(True, rising[1:] != rising[:-1])[: len(rising)]


def _in_boxes(mesh: Mesh, points: Points) -> tuple[Int[np.ndarray, " pairs"], Int[np.ndarray, " pairs"]]:
    """Pairs of a point and an element whose box contains it."""
    low, high = mesh.boxes
    (corner, size, counts), starts, members = mesh.cells
    place = np.clip(np.floor((points - corner) / size), 0, counts - 1).astype(np.int64)
    cell = np.ravel_multi_index(tuple(place.T), tuple(counts))
    found = starts[cell + 1] - starts[cell]
    asked = np.repeat(np.arange(len(points)), found)
    first = np.cumsum(found) - found
    elements = members[np.arange(len(asked)) + np.repeat(starts[cell] - first, found)]
    for axis in range(mesh.dim):  # one after the other, as each leaves few
        place = points[asked, axis]
        within = (place >= low[elements, axis]) & (place <= high[elements, axis])
        asked, elements = asked[within], elements[within]
    return asked, elements


def _nearest(
    mesh: Mesh, points: Points
) -> tuple[Int[np.ndarray, " points"], Float[np.ndarray, "points corners"], Float[np.ndarray, " points"]]:
    """Element, weights and distance [m] of the place on the boundary nearest to each point outside.

    The nearest facet is no farther than the nearest middle of one, so its own middle is within its radius of that.
    """
    facets, (middles, radii) = mesh.boundary, mesh.facet_balls
    asked, near = [], []
    for first in range(0, len(points), max(1, _AT_ONCE // len(facets))):
        some = points[first : first + max(1, _AT_ONCE // len(facets))]
        away = np.sqrt(sum((some[:, axis, None] - middles[:, axis]) ** 2 for axis in range(mesh.dim)))
        pairs = np.nonzero(away - radii <= away.min(axis=1, keepdims=True) * (1 + 1e-9))
        asked.append(first + pairs[0])
        near.append(pairs[1])
    which, facet = np.concatenate(asked), np.concatenate(near)
    corners = mesh.nodes[facets[facet]]
    shares = nearest_shares(corners, points[which])
    distances = np.linalg.norm(np.einsum("fc,fcd->fd", shares, corners) - points[which], axis=1)
    order = np.lexsort((facet, distances, which))
    order = order[_firsts(which[order])]
    element = mesh.boundary_elements[facet[order]]
    match = mesh.elements[element][:, :, None] == facets[facet[order]][:, None, :]
    return element, (match * shares[order][:, None, :]).sum(axis=2), distances[order]


def nearest_shares(
    corners: Float[np.ndarray, "facets dim dim"], points: Float[np.ndarray, "#facets dim"]
) -> Float[np.ndarray, "facets dim"]:
    """Weights of the place of each facet (segment or triangle) nearest to its point, or to the one point."""
    return _on_segments(corners, points) if corners.shape[1] == 2 else _on_triangles(corners, points)


def _on_segments(
    corners: Float[np.ndarray, "facets 2 dim"], points: Float[np.ndarray, "#facets dim"]
) -> Float[np.ndarray, "facets 2"]:
    """Weights of the place of each segment nearest to its point."""
    along = corners[:, 1] - corners[:, 0]
    fraction = np.einsum("fd,fd->f", points - corners[:, 0], along) / np.einsum("fd,fd->f", along, along)
    fraction = np.clip(fraction, 0.0, 1.0)
    return np.column_stack([1.0 - fraction, fraction])


def _on_triangles(
    corners: Float[np.ndarray, "facets 3 3"], points: Float[np.ndarray, "#facets 3"]
) -> Float[np.ndarray, "facets 3"]:
    """Weights of the place of each triangle nearest to its point: its foot if inside, else on the nearest side."""
    spans = _spans(corners)
    gram = np.einsum("fid,fjd->fij", spans, spans)
    local = np.linalg.solve(gram, np.einsum("fid,fd->fi", spans, points - corners[:, 0])[..., None])[..., 0]
    best = np.column_stack([1.0 - local.sum(axis=1), local])
    least = np.where((best >= 0.0).all(axis=1), -1.0, np.inf)
    for first, second in ((0, 1), (1, 2), (2, 0)):
        weights = np.zeros_like(best)
        weights[:, [first, second]] = _on_segments(corners[:, [first, second]], points)
        away = np.linalg.norm(np.einsum("fc,fcd->fd", weights, corners) - points, axis=1)
        best[away < least] = weights[away < least]
        least = np.minimum(least, away)
    return best


def clearance(mesh: Mesh, points: Points) -> Float[np.ndarray, " points"]:
    """Distance of each point from the nearest place of the boundary [m], from inside or outside alike.

    Exact: a facet nearer than the nearest middle of one lies, with its own middle, within that distance and its radius.
    """
    from scipy.spatial import KDTree

    if not len(points):
        return np.zeros(0)
    corners = mesh.nodes[mesh.boundary]
    middles = corners.mean(axis=1)
    largest = np.linalg.norm(corners - middles[:, None], axis=2).max()
    tree = KDTree(middles)
    bound = tree.query(points)[0]
    near = tree.query_ball_point(points, bound * (1 + 1e-9) + largest)
    counts = np.array([len(some) for some in near])
    facets = np.fromiter(chain.from_iterable(near), np.int64, counts.sum())
    asked = np.repeat(points, counts, axis=0)
    places = np.einsum("fc,fcd->fd", nearest_shares(corners[facets], asked), corners[facets])
    distances = np.linalg.norm(places - asked, axis=1)
    return np.minimum.reduceat(distances, np.cumsum(counts) - counts)
