"""`SelfContactEnergy`: a body does not pass through itself."""

from copy import copy
from dataclasses import dataclass
from functools import cached_property
from math import log
from typing import ClassVar, NamedTuple, Self

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.geometry import BoundaryTree, Mesh, Pairs
from hydrostat.kernel import native
from hydrostat.mechanics.energy import Blocks, ContactForces, Energy, Gaps, HessianBlocks, ScatterMap, Stencils


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactSurface:
    """Data shared by all states of the self-contact of one body.

    Attributes:
        tree: bounding-volume tree of the boundary.
        rest: rest positions of the nodes [m].
        distance: distance at which the contact potential becomes active [m].
        stiffness: contact pressure at half that distance [Pa].
        areas: boundary area of each node [m^2], (nodes,).
    """

    tree: BoundaryTree
    rest: Nodes
    distance: float
    stiffness: float
    areas: Vector

    @property
    def soft(self) -> float:
        """Regularization that makes the nearest points of parallel edges unique [m^2]."""
        return (_EDGE_SOFTENING * self.distance) ** 2

    def compute_squared_distances(self, nodes: Nodes, pairs: Pairs) -> Vector:
        """Squared distance of each pair [m^2]."""
        squared = np.empty(len(pairs.edges))
        native.squared_distances(nodes, *pairs, self.soft, squared)
        return squared

    def begins(self, pairs: Pairs) -> Vector:
        """Squared distance [m^2] at which each pair becomes active, below half its rest distance: none is at rest."""
        rest = 0.25  # Pairs that are near at rest, as in a crease, are felt below half of that distance
        return np.minimum(self.distance**2, rest * self.compute_squared_distances(self.rest, pairs))

    def weights(self, pairs: Pairs, begins: Vector) -> Vector:
        """Factor of each pair's barrier [N/m]: its force at half the contact distance is stiffness x area."""
        one = self.areas[pairs.stencils[:, 0]]
        shared = 0.5 * self.areas[pairs.stencils].mean(axis=1)
        area = np.where(pairs.edges, shared, one)
        # Force of the barrier at half its distance, where its factor and distance are 1: 2 phi'(1/4) x 1/2
        half_way = 4.329
        return self.stiffness * area / (half_way * np.sqrt(np.maximum(begins, np.finfo(float).tiny)))


class CandidatePairs(NamedTuple):
    """All pairs that can become active while each node stays in a box of its own.

    Attributes:
        low: lowest corner of each node's box [m].
        high: highest corner of each node's box [m].
        pairs: superset of the pairs that can become active in these boxes.
    """

    low: Nodes
    high: Nodes
    pairs: Pairs

    def serves(self, nodes: Nodes) -> bool:
        """True if all nodes are inside their boxes."""
        return bool((self.low <= nodes).all() and (nodes <= self.high).all())


class SelfContactEnergy(Energy):
    """Barriers between all parts of a body's boundary that come near one another (Li et al. 2020): self-contact.

    A term is a pair: in the plane a node and an edge, in space a node and a triangle or two edges, with no node in
    common. It is felt below a distance; there its energy grows without bound as the gap closes.

    Terms come and go: an energy knows the pairs that lay within twice the distance of where it was last asked (`near`),
    and serves as long as no node has moved by half the distance since.
    """

    convex: ClassVar[bool] = False
    projects_first: ClassVar[bool] = True

    def __init__(self, skin: ContactSurface, pairs: Pairs, watch: CandidatePairs | None = None) -> None:
        """Take the active pairs, and the candidate pairs."""
        self.skin, self.pairs, self.watch = skin, pairs, watch
        self.swept: tuple[Nodes, Pairs] | None = None
        self.stencils: Stencils = pairs.stencils

    @classmethod
    def of(
        cls, mesh: Mesh, *, distance: float, young: float, thickness: float | None = None, rest: Nodes | None = None
    ) -> Self:
        """Contact of a body at rest with itself, in which nothing touches yet.

        Args:
            mesh: mesh of the body.
            distance: distance at which contact forces start [m].
            young: pressure at half that distance: Young's modulus [Pa].
            thickness: thickness of a flat body [m].
            rest: all unknowns at rest [m], if there are more than the nodes of the mesh.
        """
        rest = mesh.nodes if rest is None else rest
        areas = mesh.facet_areas()[1] * (thickness or 1.0)
        skin = ContactSurface(tree=BoundaryTree(mesh), rest=rest, distance=distance, stiffness=young, areas=areas)
        return cls(skin, Pairs(np.empty((0, mesh.dim + 1), np.int64), np.empty(0, np.bool_)))

    @cached_property
    def _begins(self) -> Vector:
        return self.skin.begins(self.pairs)

    @cached_property
    def _law(self) -> tuple[np.ndarray, np.ndarray, float, Vector, Vector]:
        stencils, edges = self.pairs
        return stencils, edges, self.skin.soft, self._begins, self.skin.weights(self.pairs, self._begins)

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return float(native.barrier_energy(nodes, *self._law)[0]) if len(self.stencils) else 0.0

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        blocks = np.empty((*self.stencils.shape, nodes.shape[1]))
        native.barrier_forces(nodes, *self._law, blocks)
        return blocks

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        size = self.stencils.shape[1] * nodes.shape[1]
        blocks = np.empty((len(self.stencils), size, size))
        native.barrier_hessian(nodes, *self._law, share, blocks)
        return blocks

    def add_gradient(self, nodes: Nodes, controls: Vector, total: Nodes) -> None:
        if len(self.stencils):
            super().add_gradient(nodes, controls, total)

    def add_hessian(self, nodes: Nodes, controls: Vector, share: float, places: ScatterMap) -> None:
        if len(self.stencils):
            super().add_hessian(nodes, controls, share, places)

    def largest_step(self, nodes: Nodes, move: Nodes) -> float:
        watch, skin = self.watch, self.skin
        kept = 0.1  # No step takes more than 1 less this share of the gap between two parts
        if watch is not None and watch.serves(nodes) and watch.serves(nodes + move):
            share = native.admissible_share(nodes, move, skin.rest, *watch.pairs, kept)
        else:
            share, pairs = skin.tree.sweep(nodes, move, skin.rest, kept=kept, reach=self._reach)
            self.swept = nodes + share * move, pairs
        least_step = 1e-12  # Steps are above 0
        return max(float(share), least_step)

    def with_active_terms(self, nodes: Nodes) -> "SelfContactEnergy":
        watch = self.watch
        if watch is None or not watch.serves(nodes):
            watch = self._look_around(nodes)
        elif watch.pairs is self.pairs:
            return self
        found = SelfContactEnergy(self.skin, watch.pairs, watch)
        if found._active_pair_count(nodes) != self._active_pair_count(nodes):
            return found
        if watch is self.watch:
            return self
        same = copy(self)  # with all that is known of its pairs
        same.watch, same.swept = watch, None
        return same

    def continues(self, other: Energy) -> bool:
        return isinstance(other, SelfContactEnergy) and other.skin is self.skin

    def contact_forces(self, nodes: Nodes) -> ContactForces:
        """Return the places of self-contact, half-way between both sides, with the normal force on the first side."""
        here = self.with_active_terms(nodes)
        blocks = -here.gradient(nodes, np.zeros(0))
        felt = np.flatnonzero(blocks.any(axis=(1, 2)))
        stencils, blocks, edges = here.pairs.stencils[felt], blocks[felt], here.pairs.edges[felt]
        first = np.arange(stencils.shape[1]) < np.where(edges, 2, 1)[:, None]
        weights = np.linalg.norm(blocks, axis=2)
        weights /= np.where(first, (first * weights).sum(1)[:, None], (~first * weights).sum(1)[:, None])
        places = 0.5 * np.einsum("pc,pcd->pd", weights, nodes[stencils])
        return ContactForces(places, np.einsum("pc,pcd->pd", first, blocks), stencils)

    def gaps(self, nodes: Nodes) -> Gaps | None:
        if not len(self.stencils):
            return None
        stencils, edges, soft, begins, weights = self._law
        squared = np.maximum(self.skin.compute_squared_distances(nodes, self.pairs), np.finfo(float).tiny)
        widths, normals = np.sqrt(squared), np.empty((*stencils.shape, nodes.shape[1]))
        derivative = -1.5 * log(4.0) - 2.25  # phi'(1/4)
        resting = 0.85  # Parts pressed on one another come to rest at about this share of the distance
        curvature = 10.0  # Stiffness of a barrier there, by its factor
        native.barrier_forces(nodes, stencils, edges, soft, 4.0 * squared, np.ones(len(squared)), normals)
        normals /= 2.0 * derivative * widths[:, None, None]
        return Gaps(stencils, widths - resting * np.sqrt(begins), normals, curvature * weights)

    @property
    def _reach(self) -> float:
        # Pairs are looked for so many times farther than they are felt; then they serve until nodes have moved
        look = 2.0
        return look * self.skin.distance

    def _look_around(self, nodes: Nodes) -> CandidatePairs:
        """Return the candidate pairs, valid as long as no node moves by more than half of the search margin."""
        margin = 0.5 * (self._reach - self.skin.distance)
        end, pairs = self.swept or (None, None)
        rounding = 1e-6  # Nodes that are off by less than this share of the distance are the same
        if end is None or pairs is None or np.abs(nodes - end).max() > rounding * self.skin.distance:
            pairs = self.skin.tree.pairs(nodes, self._reach)
        return CandidatePairs(nodes - margin, nodes + margin, pairs)

    def _active_pair_count(self, nodes: Nodes) -> int:
        """Number of active pairs, that is pairs within the contact distance."""
        return (
            int((self.skin.compute_squared_distances(nodes, self.pairs) < self._begins).sum())
            if len(self.stencils)
            else 0
        )


_EDGE_SOFTENING = 0.05
"""Two edges whose middles are nearest are as far apart as they are; at their ends so much of the distance more."""
