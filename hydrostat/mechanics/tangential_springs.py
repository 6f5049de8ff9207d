"""`SelfContactFriction`: where the nodes of a boundary stick to parts of the same boundary that they touch."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Nodes, Vector
from hydrostat.geometry import Mesh, Pairs
from hydrostat.mechanics.energy import Stencils
from hydrostat.mechanics.obstacle_friction import ObstacleFriction

Whole = Int[np.ndarray, " some"]
Ways = Float[np.ndarray, "some dim"]


@dataclass(frozen=True, kw_only=True, eq=False)
class SelfContactSurface:
    """Boundary data shared by all states of self-contact friction.

    Attributes:
        own: nodes of the boundary.
        facets: facets of the boundary, (facets, dim).
        around: facets of each node, padded with -1, (nodes, most).
        distance: distance at which parts come into contact [m].
    """

    own: Whole
    facets: Stencils
    around: Stencils
    distance: float

    @classmethod
    def of(cls, mesh: Mesh, distance: float) -> "SelfContactSurface":
        """Return the boundary data of a body whose parts come into contact at a distance [m]."""
        facets = np.asarray(mesh.boundary, dtype=np.int64)
        owners, numbers = facets.ravel(), np.repeat(np.arange(len(facets)), facets.shape[1])
        order = np.argsort(owners, kind="stable")
        counts = np.bincount(owners, minlength=len(mesh.nodes))
        rank = np.arange(len(owners)) - np.repeat(np.cumsum(counts) - counts, counts)
        around = np.full((len(mesh.nodes), counts.max()), -1)
        around[owners[order], rank] = numbers[order]
        return cls(own=np.flatnonzero(counts), facets=facets, around=around, distance=distance)

    def choices(self, pairs: Pairs, some: Bool[np.ndarray, " own"]) -> tuple[Whole, Whole]:
        """Facets that some nodes may stick to: those of all nodes that they are in a pair with.

        Returns:
            The node of each choice, by its number among those of the boundary, and the facet.
        """
        one, other = [], []
        for edges in (False, True):
            stencils, first = pairs.stencils[pairs.edges == edges], 2 if edges else 1
            for i in range(first):
                for j in range(first, stencils.shape[1]):
                    one += [stencils[:, i], stencils[:, j]]
                    other += [stencils[:, j], stencils[:, i]]
        numbers = np.full(len(self.around), -1)
        numbers[self.own[some]] = np.flatnonzero(some)
        who, met = numbers[np.concatenate(one)], np.concatenate(other)
        facets = np.where(who[:, None] >= 0, self.around[met], -1)
        both = np.stack([np.broadcast_to(who[:, None], facets.shape), facets], axis=-1)[facets >= 0]
        who, facets = np.unique(both, axis=0).T
        apart = (self.facets[facets] != self.own[who][:, None]).all(axis=1)
        return who[apart], facets[apart]


class FacetPoints(NamedTuple):
    """Points of facets, one for each node of a boundary.

    Attributes:
        facets: index of the facet; -1 if there is no point.
        weights: barycentric weights of the point at the corners of the facet; the point may lie beyond its edges.
    """

    facets: Int[np.ndarray, " own"]
    weights: Float[np.ndarray, "own dim"]

    def with_points_replaced(self, some: Bool[np.ndarray, " own"], others: "FacetPoints") -> "FacetPoints":
        """Return these points with some of them replaced."""
        return FacetPoints(
            np.where(some, others.facets, self.facets), np.where(some[:, None], others.weights, self.weights)
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class SelfContactFriction:
    """Friction between parts of a body: a spring from each pressed node to a point of the facet opposite.

    The point moves with the body. The `ObstacleFriction` sees as the place of a node the way from the point to the
    node. The spring pulls at the node and at what is beside it, which while energy is minimized is a certain point of
    the part opposite; `attach_springs` brings it where it belongs.

    Attributes:
        skin: boundary data shared by all states.
        anchors: point that each boundary node sticks to.
        beside: point of the opposite facet for each pressed node: its anchor, or the point to which the anchor will be
            dragged.
        offsets: displacement from the anchor to the point in `beside` [m].
        grip: friction springs of all boundary nodes.
        before: node positions at the start of this increment of the loading path [m].
    """

    skin: SelfContactSurface
    anchors: FacetPoints
    beside: FacetPoints
    offsets: Float[np.ndarray, "own dim"]
    grip: ObstacleFriction
    before: Nodes

    @classmethod
    def at_rest(cls, skin: SelfContactSurface, rest: Nodes, friction: float, springs: Vector) -> "SelfContactFriction":
        """Return the friction state without normal forces.

        Args:
            skin: boundary data of the body.
            rest: nodes [m].
            friction: mu of each side.
            springs: stiffness of each node [N/m].
        """
        still = np.zeros((len(skin.own), skin.facets.shape[1]))
        none = FacetPoints(np.full(len(skin.own), -1), still)
        grip = ObstacleFriction.at_rest(friction, springs, still)
        return cls(skin=skin, anchors=none, beside=none, offsets=still, grip=grip, before=rest)

    @cached_property
    def touching_nodes(self) -> Whole:
        """Nodes that have a point of an opposite facet, as indices among the boundary nodes."""
        return np.flatnonzero(self.beside.facets >= 0)

    @cached_property
    def stencils(self) -> Stencils:
        """Stencil of each touching node: the node, then the corners of the opposite facet."""
        facets = self.skin.facets[self.beside.facets[self.touching_nodes]]
        return np.concatenate([self.skin.own[self.touching_nodes, None], facets], axis=1)

    @cached_property
    def shares(self) -> Float[np.ndarray, "held corners"]:
        """Weights of each stencil's nodes in the displacement from the anchor to the node."""
        return np.concatenate(
            [np.ones((len(self.touching_nodes), 1)), -self.beside.weights[self.touching_nodes]], axis=1
        )

    def places(self, nodes: Nodes) -> Ways:
        """Displacement from the anchor to each boundary node [m]; 0 without an anchor."""
        places = np.zeros_like(self.offsets)
        places[self.touching_nodes] = (
            np.einsum("tc,tcd->td", self.shares, nodes[self.stencils]) + self.offsets[self.touching_nodes]
        )
        return places

    def blocks(self, nodes: Nodes) -> Float[np.ndarray, "held corners dim"]:
        """Gradient of the energy by the nodes of each row of the stencils [N]."""
        return self.shares[:, :, None] * self.grip.forces(self.places(nodes))[self.touching_nodes, None, :]

    def forces(self, nodes: Nodes) -> Nodes:
        """Gradient of the energy by all nodes [N]."""
        total = np.zeros_like(nodes)
        np.add.at(total, self.stencils, self.blocks(nodes))
        return total

    def with_grip(self, grip: ObstacleFriction) -> "SelfContactFriction":
        """Return this state with other springs."""
        return replace(self, grip=grip)

    def attach_springs(self, nodes: Nodes, pairs: Pairs, pushes: Vector, normals: Ways) -> "SelfContactFriction":
        """Return this state with its springs attached to the facets opposite the nodes at a given shape.

        A node that was not pushed before sticks to the point that was beside it where the increment began, or now if
        that is far from the facet.

        Args:
            nodes: the shape [m].
            pairs: active contact pairs at that shape.
            pushes: normal force on each node of the boundary [N].
            normals: its direction.
        """
        anchors, grip = (
            self._anchor_points(nodes, pairs, pushes, normals),
            self.grip.with_normal_forces(pushes, normals),
        )
        held = (pushes > 0) & (anchors.facets >= 0)
        points = self._positions(nodes, anchors)
        places = np.where(held[:, None], nodes[self.skin.own] - points, 0.0)
        left = places - grip.drag_anchors(places).anchors
        rounding = 1e-9  # A spring that loses less than this share of its length does not slip
        drags = held & (np.linalg.norm(left, axis=1) < (1.0 - rounding) * grip.slips(places)[1])
        dragged = self._nearest(nodes, pairs, drags, left, normals)
        beside = anchors.with_points_replaced(drags & (dragged.facets >= 0), dragged).with_points_replaced(
            ~held, self._none
        )
        offsets = np.where(held[:, None], self._positions(nodes, beside) - points, 0.0)
        return replace(self, anchors=anchors, beside=beside, offsets=offsets)

    def drag_anchors(self, nodes: Nodes) -> "SelfContactFriction":
        """Return the state after a shape: anchors are dragged along, and nodes without normal force have no anchor.

        Args:
            nodes: the shape [m], at which this is seated.
        """
        return replace(self, anchors=self.beside, offsets=np.zeros_like(self.offsets), before=nodes)

    @property
    def _none(self) -> FacetPoints:
        """No points."""
        return FacetPoints(np.full(len(self.offsets), -1), np.zeros_like(self.offsets))

    def _positions(self, nodes: Nodes, points: FacetPoints) -> Ways:
        """Positions of points [m]; arbitrary for nodes without a point."""
        return np.einsum("tc,tcd->td", points.weights, nodes[self.skin.facets[points.facets]])

    def _anchor_points(self, nodes: Nodes, pairs: Pairs, pushes: Vector, normals: Ways) -> FacetPoints:
        """Anchors, also of nodes that were not pushed before."""
        fresh = (self.anchors.facets < 0) & (pushes > 0)
        if not fresh.any():
            return self.anchors
        beside = self._nearest(nodes, pairs, fresh, np.zeros_like(normals), normals)
        new = np.flatnonzero(beside.facets >= 0)
        earlier = _beside(self.before[self.skin.facets[beside.facets[new]]], self.before[self.skin.own[new]])
        beyond = 1.5  # Weights that differ by less from one half are of points near their facet
        near = (np.abs(earlier - 0.5) < beyond).all(axis=1, keepdims=True)
        beside.weights[new] = np.where(near, earlier, beside.weights[new])
        return self.anchors.with_points_replaced(beside.facets >= 0, beside)

    def _nearest(
        self, nodes: Nodes, pairs: Pairs, some: Bool[np.ndarray, " own"], spans: Ways, normals: Ways
    ) -> FacetPoints:
        """Points that some nodes are so far from along the surface [m]; on the facet of the anchor if it is as near."""
        who, facets = self.skin.choices(pairs, some)
        known = np.flatnonzero(some & (self.anchors.facets >= 0))
        who, facets = np.append(who, known), np.append(facets, self.anchors.facets[known])
        corners, dim = nodes[self.skin.facets[facets]], nodes.shape[1]
        frames = np.concatenate([corners[:, 1:] - corners[:, :1], normals[who][:, None]], axis=1).swapaxes(1, 2)
        sizes = np.linalg.norm(frames, axis=1)[:, : dim - 1].max(axis=1, initial=0.0)
        steep = 0.1  # A facet more nearly along the normal than this sine is none to stick to
        sound = np.abs(np.linalg.det(frames)) > steep * sizes ** (dim - 1)
        who, facets, sizes, corners = who[sound], facets[sound], sizes[sound], corners[sound]
        goals = (nodes[self.skin.own[who]] - spans[who] - corners[:, 0])[:, :, None]
        found = np.linalg.solve(frames[sound], goals)[:, :, 0]
        weights = np.concatenate([1.0 - found[:, :-1].sum(axis=1, keepdims=True), found[:, :-1]], axis=1)
        beyond = np.maximum(-weights.min(axis=1, initial=0.0), 0.0) * sizes + np.abs(found[:, -1])
        stays = 0.1  # The facet of the anchor serves a node that is beyond it by this share of its size
        beyond -= stays * sizes * (facets == self.anchors.facets[who])
        order = np.lexsort((facets, beyond, who))
        best = order[np.unique(who[order], return_index=True)[1]]
        points = self._none
        points.facets[who[best]], points.weights[who[best]] = facets[best], weights[best]
        return points


def _beside(corners: Float[np.ndarray, "some dim dim"], points: Ways) -> Float[np.ndarray, "some dim"]:
    """Barycentric weights, at the corners of facets, of the points of their planes nearest to given points."""
    spans = corners[:, 1:] - corners[:, :1]
    squares = np.einsum("tak,tbk->tab", spans, spans)
    along = np.einsum("tak,tk->ta", spans, points - corners[:, 0])[:, :, None]
    found = np.linalg.solve(squares, along)[:, :, 0]
    return np.concatenate([1.0 - found.sum(axis=1, keepdims=True), found], axis=1)
