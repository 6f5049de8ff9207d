"""`Hold`: where the nodes of a boundary stick to parts of the same boundary that they touch."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.geometry.boundary_tree import Pairs
from hydrostat.geometry.mesh import Mesh
from hydrostat.mechanics.energy import Stencils
from hydrostat.mechanics.grip import Grip

Whole = Int[np.ndarray, " some"]


@dataclass(frozen=True, kw_only=True, eq=False)
class HoldingSkin:
    """What all states of a hold share.

    Attributes:
        own: nodes of the boundary.
        facets: of the boundary, (facets, dim).
        around: facets of each node, filled up with -1, (nodes, most).
        distance: at which parts feel one another [m].
    """

    own: Whole
    facets: Stencils
    around: Stencils
    distance: float

    @classmethod
    def of(cls, mesh: Mesh, distance: float) -> "HoldingSkin":
        """The skin of a body whose parts feel one another at a distance [m]."""
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


@dataclass(frozen=True, kw_only=True, eq=False)
class Hold:
    """Each node of a boundary that another part pushes sticks to a point of the facet there, by a spring of a `Grip`.

    The point is told by its weights at the corners of the facet, which may lie beyond its edges: so it goes along with
    the body. What the `Grip` is told as the place of a node is the way from the point to the node.

    Attributes:
        skin: what all states share.
        facets: that each node of the boundary sticks to; -1 where none.
        weights: of the point at the corners of the facet.
        grip: springs of all nodes of the boundary.
        before: nodes where this increment of the loading path began [m].
    """

    skin: HoldingSkin
    facets: Int[np.ndarray, " own"]
    weights: Float[np.ndarray, "own dim"]
    grip: Grip
    before: Nodes

    @cached_property
    def held(self) -> Whole:
        """Nodes that stick to something, by their numbers among those of the boundary."""
        return np.flatnonzero(self.facets >= 0)

    @cached_property
    def stencils(self) -> Stencils:
        """A row for each: the node, then the corners of the facet."""
        return np.concatenate([self.skin.own[self.held, None], self.skin.facets[self.facets[self.held]]], axis=1)

    @cached_property
    def shares(self) -> Float[np.ndarray, "held corners"]:
        """Their shares in the way from the point to the node."""
        return np.concatenate([np.ones((len(self.held), 1)), -self.weights[self.held]], axis=1)

    def places(self, nodes: Nodes) -> Points:
        """Way from the point that each node of the boundary sticks to [m]; 0 where there is none."""
        places = np.zeros((len(self.facets), nodes.shape[1]))
        places[self.held] = np.einsum("tc,tcd->td", self.shares, nodes[self.stencils])
        return places

    def with_grip(self, grip: Grip) -> "Hold":
        """The same with other springs."""
        return replace(self, grip=grip)

    def seated(self, nodes: Nodes, pairs: Pairs, pushes: Vector, normals: Points) -> "Hold":
        """The same at a shape: with points for nodes that are pushed now, and near points for those that went far.

        A node that was not pushed before sticks to the point that was beside it where the increment began, or now if
        that is far from the facet.

        Args:
            nodes: the shape [m].
            pairs: that are felt there.
            pushes: normal force on each node of the boundary [N].
            normals: its direction.
        """
        new = (pushes > 0) & (self.facets < 0)
        spans, lengths = replace(self.grip, normals=normals).ways(self.places(nodes))
        far = (self.facets >= 0) & (lengths > self.skin.distance)
        if not (new | far).any():
            return self
        spans[far] *= (0.5 * self.skin.distance / lengths[far])[:, None]
        other = self._reseated(nodes, pairs, new | far, spans, normals)
        found = np.flatnonzero(new & (other.facets >= 0))
        earlier = _beside(self.before[self.skin.facets[other.facets[found]]], self.before[self.skin.own[found]])
        near = (np.abs(earlier - 0.5) < _BEYOND).all(axis=1)
        other.weights[found[near]] = earlier[near]
        return other

    def went_far(self, nodes: Nodes) -> Vector:
        """Limits of the nodes that are farther from their points than parts feel one another [N]."""
        return self.grip.limits[self.grip.ways(self.places(nodes))[1] > self.skin.distance]

    def slipped(self, nodes: Nodes, pairs: Pairs) -> "Hold":
        """What follows a shape: points were dragged along; nodes that nothing pushes stick to nothing."""
        places = self.places(nodes)
        ways, lengths = self.grip.ways(places)
        left = places - self.grip.slipped(places).anchors
        held = self.grip.limits > 0
        drags = held & (np.linalg.norm(left, axis=1) < (1.0 - _ROUNDING) * lengths)
        free = replace(self, facets=np.where(held, self.facets, -1), before=nodes)
        return free._reseated(nodes, pairs, drags, np.where(drags[:, None], left, ways), self.grip.normals)

    def _reseated(
        self, nodes: Nodes, pairs: Pairs, some: Bool[np.ndarray, " own"], spans: Points, normals: Points
    ) -> "Hold":
        """The same where some nodes stick to points that they are so far from along the surface [m]."""
        who, facets = self.skin.choices(pairs, some)
        corners, dim = nodes[self.skin.facets[facets]], nodes.shape[1]
        frames = np.concatenate([corners[:, 1:] - corners[:, :1], normals[who][:, None]], axis=1).swapaxes(1, 2)
        sizes = np.linalg.norm(frames, axis=1)[:, : dim - 1].max(axis=1, initial=0.0)
        sound = np.abs(np.linalg.det(frames)) > _STEEP * sizes ** (dim - 1)
        who, facets, sizes, corners = who[sound], facets[sound], sizes[sound], corners[sound]
        goals = (nodes[self.skin.own[who]] - spans[who] - corners[:, 0])[:, :, None]
        found = np.linalg.solve(frames[sound], goals)[:, :, 0]
        weights = np.concatenate([1.0 - found[:, :-1].sum(axis=1, keepdims=True), found[:, :-1]], axis=1)
        beyond = np.maximum(-weights.min(axis=1, initial=0.0), 0.0) * sizes + np.abs(found[:, -1])
        order = np.lexsort((facets, beyond, who))
        _, firsts = np.unique(who[order], return_index=True)
        best = order[firsts]
        other = replace(self, facets=self.facets.copy(), weights=self.weights.copy())
        other.facets[who[best]], other.weights[who[best]] = facets[best], weights[best]
        return other


def _beside(corners: Float[np.ndarray, "some dim dim"], points: Points) -> Float[np.ndarray, "some dim"]:
    """Weights at the corners of facets of what is nearest a point each in their planes."""
    spans = corners[:, 1:] - corners[:, :1]
    squares = np.einsum("tak,tbk->tab", spans, spans)
    along = np.einsum("tak,tk->ta", spans, points - corners[:, 0])[:, :, None]
    found = np.linalg.solve(squares, along)[:, :, 0]
    return np.concatenate([1.0 - found.sum(axis=1, keepdims=True), found], axis=1)


_BEYOND = 1.5
"""Weights that differ by less from one half are of points near their facet."""

_STEEP = 0.1
"""A facet more nearly along the normal than this sine is none to stick to."""

_ROUNDING = 1e-9
"""A spring that loses less than this share of its length does not slip."""
