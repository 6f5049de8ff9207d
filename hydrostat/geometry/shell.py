"""`Shell`: closed boundary of a body, for distance queries."""

from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Points, Vector
from hydrostat.geometry.distance_field import DistanceField, Distances
from hydrostat.geometry.outline import Outline

Facets = Int[np.ndarray, "facets dim"]


@dataclass(frozen=True, eq=False)
class Nearest:
    """Places of a shell nearest to points, and their distances.

    The distance of a point p is differentiable where this place is the only one: then it changes by direction . dp, and
    by -direction . (shares @ dx) when the nodes of the stencil move, whichever way the nearest place slides.
    """

    stencils: Int[np.ndarray, "points dim"]  # nodes of the facet that holds each place, (points, dim)
    shares: Float[np.ndarray, "points dim"]  # weights of these nodes, rows sum to one
    distances: Float[np.ndarray, " points"]  # distance of each point [m], negative inside
    directions: Points  # unit vectors along which the distance grows fastest


class Shell:
    """Closed boundary: segments in the plane with the body to their left, triangles in space seen from outside.

    Whether a point whose nearest place is a corner or an edge lies inside is told by the mean normal there, weighted by
    angles (Baerentzen 2005).
    """

    def __init__(self, nodes: Nodes, facets: Facets) -> None:
        """Facets, by the numbers of their nodes [m]."""
        self.nodes, self.facets = nodes, np.ascontiguousarray(facets)

    def __getstate__(self) -> dict[str, Any]:
        """Return the state that is sent to other processes: without the tree, which is rebuilt there."""
        return {"nodes": self.nodes, "facets": self.facets}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Restore the state from another process."""
        self.__dict__.update(state)

    def with_nodes(self, nodes: Nodes) -> "Shell":
        """Return the same facets at other node positions [m]."""
        shell = Shell(nodes, self.facets)
        shell.edges = self.edges
        return shell

    @cached_property
    def edges(self) -> Facets:
        """In space: the number of the edge of each triangle across from each of its corners; else nothing of use."""
        if self.facets.shape[1] == 2:
            return self.facets
        ends = np.sort(np.stack([np.roll(self.facets, -1, axis=1), np.roll(self.facets, 1, axis=1)]), axis=0)
        numbers = np.unique(ends[0] * len(self.nodes) + ends[1], return_inverse=True)[1]
        return numbers.reshape(self.facets.shape).astype(np.int64)

    @property
    def is_closed(self) -> bool:
        """True if every side of a facet belongs to exactly one other facet, of the opposite direction."""
        if self.facets.shape[1] == 2:
            there, back = self.facets.T
        else:
            begins, ends = self.facets.ravel(), np.roll(self.facets, -1, axis=1).ravel()
            there, back = begins * len(self.nodes) + ends, ends * len(self.nodes) + begins
        return len(np.unique(there)) == len(there) and np.array_equal(np.sort(there), np.sort(back))

    @cached_property
    def measures(self) -> Float[np.ndarray, " facets"]:
        """Length [m] or area [m^2] of each facet."""
        return np.linalg.norm(self._crosses, axis=1) / (self.facets.shape[1] - 1)

    def nearest(self, points: Points) -> Nearest:
        """Place of the shell nearest to each point (ValueError: nodes or points that are not finite)."""
        if not (self._is_finite and np.isfinite(points).all()):
            raise ValueError("a distance needs finite places")
        _, found, places = self._tree.squared_distance(self._nodes_in_space, self.facets, _in_space(points))
        facets = found.astype(np.int64)  # from long long, another type to NumPy
        places = places[:, : points.shape[1]]
        corners = self.nodes[self.facets[facets]]
        shares = _shares(corners, places)
        offsets = points - places
        normals = self._normals_at(facets, shares)
        lengths = np.linalg.norm(offsets, axis=1)
        signs = np.where(np.einsum("pd,pd->p", offsets, normals) < 0, -1.0, 1.0)
        beside = (shares == 0).any(axis=1) & (lengths > _CONTACT_TOLERANCE * np.abs(corners).max(axis=(1, 2)))
        directions = np.where(beside[:, None], signs[:, None] * offsets / _or_one(lengths)[:, None], normals)
        return Nearest(self.facets[facets], shares, signs * lengths, directions)

    def _normals_at(
        self, facets: Int[np.ndarray, " points"], shares: Float[np.ndarray, "points dim"]
    ) -> Float[np.ndarray, "points dim"]:
        """Unit normals at places of facets: of the facet, or the mean at the edge or corner on which a place is."""
        normals = self._normals[facets]
        missing = shares == 0
        count = missing.sum(axis=1)
        if self.facets.shape[1] == 3 and (edge := count == 1).any():
            normals[edge] = self._edge_normals[self.edges[facets[edge], missing[edge].argmax(axis=1)]]
        corner = count == self.facets.shape[1] - 1
        normals[corner] = self._node_normals[self.facets[facets[corner], shares[corner].argmax(axis=1)]]
        return normals / _or_one(np.linalg.norm(normals, axis=1))[:, None]

    @cached_property
    def _crosses(self) -> Float[np.ndarray, "facets dim"]:
        """Outward normals: as long as a segment, or twice the area of a triangle."""
        first = self.nodes[self.facets[:, 0]]
        along = self.nodes[self.facets[:, 1]] - first
        if self.facets.shape[1] == 2:
            return np.column_stack([along[:, 1], -along[:, 0]])
        return np.cross(along, self.nodes[self.facets[:, 2]] - first)

    @cached_property
    def _normals(self) -> Float[np.ndarray, "facets dim"]:
        """Outward unit normal of each facet."""
        return self._crosses / _or_one(np.linalg.norm(self._crosses, axis=1))[:, None]

    @cached_property
    def _node_normals(self) -> Float[np.ndarray, "nodes dim"]:
        """Sum of the normals of the facets at each node, weighted by their angles there."""
        return self._sum_by_owner(self.facets, _angles(self.nodes[self.facets]), len(self.nodes))

    @cached_property
    def _edge_normals(self) -> Float[np.ndarray, "edges 3"]:
        """Sum of the normals of the two triangles at each edge."""
        return self._sum_by_owner(self.edges, np.ones(self.edges.shape), int(self.edges.max()) + 1)

    def _sum_by_owner(self, owners: Facets, weights: Float[np.ndarray, "facets dim"], count: int) -> np.ndarray:
        spread = self._normals[:, None, :] * weights[:, :, None]
        return np.column_stack([np.bincount(owners.ravel(), part.ravel(), count) for part in spread.transpose(2, 0, 1)])

    @cached_property
    def _tree(self) -> Any:
        import igl

        tree = igl.AABB()
        tree.init(self._nodes_in_space, self.facets)
        return tree

    @cached_property
    def _nodes_in_space(self) -> Float[np.ndarray, "nodes 3"]:
        """Nodes as the tree takes them."""
        return _in_space(self.nodes)

    @cached_property
    def _is_finite(self) -> bool:
        return bool(np.isfinite(self.nodes).all())

    def field(self) -> DistanceField:
        """Signed distance from a closed shell [m]; far away it may be too small by a quarter of the shell's size."""
        own = Shell(self.nodes, self.facets)
        return DistanceField(partial(_from_shell, own), partial(_shell_values, own))

    @staticmethod
    def of_outline(outline: Outline) -> "Shell":
        """Rings of an outline."""
        counts = [len(ring) for ring in outline.rings]
        starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
        ends = [np.roll(np.arange(start, start + count), -1) for start, count in zip(starts, counts, strict=True)]
        return Shell(np.concatenate(outline.rings), np.column_stack([np.arange(sum(counts)), np.concatenate(ends)]))


def _box_about(shell: Shell) -> tuple[DistanceField, float]:
    """Distance from the box about a shell, and up to which distance from it those from the shell are exact [m]."""
    low, high = shell.nodes.min(axis=0), shell.nodes.max(axis=0)
    room = 0.25  # Distances below this share of the diagonal of the box about a shell are exact
    return DistanceField.box(low, high), room * float(np.linalg.norm(high - low))


def _shell_values(shell: Shell, points: Points) -> Vector:
    box, room = _box_about(shell)
    values = box.values(points)
    near = np.flatnonzero(values < room)
    if len(near):
        values[near] = shell.nearest(points[near]).distances
    return values


def _from_shell(shell: Shell, points: Points) -> Distances:
    """Exact near the shell; elsewhere the distance from a box about it, which is never more."""
    box, room = _box_about(shell)
    values, normals, curvatures = box(points)
    near = np.flatnonzero(values < room)
    if len(near):
        found = shell.nearest(points[near])
        values[near], normals[near] = found.distances, found.directions
        curvatures[near] = _curvatures(shell, found)
    return Distances(values, normals, curvatures)


def _curvatures(shell: Shell, found: Nearest) -> Float[np.ndarray, "points dim dim"]:
    """Second derivatives of distances: none over a face, round an edge or a corner those of its distance."""
    dim = found.directions.shape[1]
    round_ = np.eye(dim) - found.directions[:, :, None] * found.directions[:, None, :]
    if dim == 3:
        corners = shell.nodes[found.stencils]
        edge = (found.shares == 0).sum(axis=1) == 1
        missing = found.shares[edge].argmin(axis=1)
        rows = np.arange(len(missing))
        along = corners[edge][rows, (missing + 1) % 3] - corners[edge][rows, (missing + 2) % 3]
        along = along / _or_one(np.linalg.norm(along, axis=1))[:, None]
        round_[edge] -= along[:, :, None] * along[:, None, :]
    beside = (found.shares == 0).any(axis=1) & (found.distances > 0)
    return np.where(beside, 1.0 / np.where(beside, found.distances, 1.0), 0.0)[:, None, None] * round_


_CONTACT_TOLERANCE = 1e-12
"""A point this near, as a fraction of the coordinates, has no direction to its nearest place but the normal there."""


def _in_space(points: Points) -> Float[np.ndarray, "points 3"]:
    """Points of the plane at height 0: the tree is 3D only, but takes segments as well as triangles."""
    raised = np.zeros((len(points), 3))
    raised[:, : points.shape[1]] = points
    return raised


def _or_one(lengths: Float[np.ndarray, " some"]) -> Float[np.ndarray, " some"]:
    return np.where(lengths > 0, lengths, 1.0)


def _shares(
    corners: Float[np.ndarray, "points dim dim"], places: Float[np.ndarray, "points dim"]
) -> Float[np.ndarray, "points dim"]:
    """Weights of the corners of facets at places on them; next to nothing is none."""
    first, offsets = corners[:, 1] - corners[:, 0], places - corners[:, 0]
    if corners.shape[1] == 2:
        square = np.einsum("pd,pd->p", first, first)
        weights = [np.einsum("pd,pd->p", offsets, first) / square]
    else:
        second = corners[:, 2] - corners[:, 0]
        normals = np.cross(first, second)
        square = np.einsum("pd,pd->p", normals, normals)
        pairs = ((offsets, second), (first, offsets))
        weights = [np.einsum("pd,pd->p", np.cross(one, two), normals) / square for one, two in pairs]
    shares = np.column_stack([1.0 - sum(weights), *weights])
    none = 1e-9
    shares[shares < none] = 0.0
    return shares / shares.sum(axis=1, keepdims=True)


def _angles(corners: Float[np.ndarray, "facets dim dim"]) -> Float[np.ndarray, "facets dim"]:
    """Angle of each triangle at its corners [rad]; 1 at the ends of a segment."""
    if corners.shape[1] == 2:
        return np.ones(corners.shape[:2])
    ahead = np.roll(corners, -1, axis=1) - corners
    behind = np.roll(corners, 1, axis=1) - corners
    crosses = np.linalg.norm(np.cross(ahead, behind), axis=2)
    return np.arctan2(crosses, np.einsum("fcd,fcd->fc", ahead, behind))
