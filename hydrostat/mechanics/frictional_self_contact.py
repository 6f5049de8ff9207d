"""`FrictionalSelfContactEnergy`: self-contact with Coulomb friction."""

from dataclasses import replace
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Points, Vector
from hydrostat.geometry import Mesh, Pairs
from hydrostat.mechanics.energy import Blocks, Compliance, ContactForces, Energy, Gaps, HessianBlocks, Response
from hydrostat.mechanics.self_contact import SelfContactEnergy
from hydrostat.mechanics.tangential_springs import FacetPoints, SelfContactFriction, SelfContactSurface


class FrictionalSelfContactEnergy(Energy):
    """Contact of a body with itself with Coulomb friction.

    Each node that other parts push has a spring to a point of the part opposite (`SelfContactFriction`), against half
    of the friction that belongs to its force: the nodes on the other side take the other half. Tangential forces on
    both sides are equal and opposite. Its history is the point that each node of the boundary sticks to.
    """

    convex: ClassVar[bool] = False
    projects_first: ClassVar[bool] = True
    has_history = True

    def __init__(self, contact: SelfContactEnergy, clasp: SelfContactFriction) -> None:
        """Take the contact energy and the friction state."""
        self.contact, self.clasp = contact, clasp
        self.stencils = np.concatenate([contact.stencils, clasp.stencils])

    @classmethod
    def of(cls, mesh: Mesh, contact: SelfContactEnergy, friction: float) -> "FrictionalSelfContactEnergy":
        """Contact of a body at rest with friction; nothing touches yet.

        Args:
            mesh: mesh of the body.
            contact: self-contact energy of the body.
            friction: Coulomb's coefficient mu.
        """
        skin = SelfContactSurface.of(mesh, contact.skin.distance)
        # Stiffness of each side along the surface per area, in units of Young's modulus / distance
        sticks = 5.0
        springs = sticks * contact.skin.stiffness / contact.skin.distance * contact.skin.areas[skin.own]
        return cls(contact, SelfContactFriction.at_rest(skin, contact.skin.rest, 0.5 * friction, springs))

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return self.contact.value(nodes, controls) + self.clasp.grip.energy(self.clasp.places(nodes))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return np.concatenate([self.contact.gradient(nodes, controls), self.clasp.blocks(nodes)])

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        clasp, size = self.clasp, self.stencils.shape[1] * nodes.shape[1]
        inner = clasp.grip.only(clasp.touching_nodes).stiffness(clasp.places(nodes)[clasp.touching_nodes])
        blocks = np.einsum("ta,tb,tij->taibj", clasp.shares, clasp.shares, inner).reshape(-1, size, size)
        return np.concatenate([self.contact.projected_hessian(nodes, controls, share), blocks])

    def largest_step(self, nodes: Nodes, move: Nodes) -> float:
        return self.contact.largest_step(nodes, move)

    def gaps(self, nodes: Nodes) -> Gaps | None:
        return self.contact.gaps(nodes)

    def contact_forces(self, nodes: Nodes) -> ContactForces:
        return self.contact.contact_forces(nodes)

    def with_active_terms(self, nodes: Nodes) -> "FrictionalSelfContactEnergy":
        contact = self.contact.with_active_terms(nodes)
        return self if contact is self.contact else self._with(contact, self.clasp)

    @property
    def history(self) -> Vector:
        """Number of the facet that each node of the boundary sticks to, -1 for none, and weights at its corners."""
        anchors = self.clasp.anchors
        return np.concatenate([anchors.facets[:, None], anchors.weights], axis=1).ravel()

    def with_history(self, history: Vector, nodes: Nodes, controls: Vector) -> "FrictionalSelfContactEnergy":
        rows = history.reshape(len(self.clasp.offsets), -1)
        anchors = FacetPoints(np.rint(rows[:, 0]).astype(int), rows[:, 1:])
        clasp = replace(self.clasp, anchors=anchors, before=nodes)
        return self._with(self.contact.with_active_terms(nodes), clasp)._with_limits_at(nodes)

    def history_residual(self, nodes: Nodes, controls: Vector) -> float:
        return float(
            np.abs(self._with_limits_at(nodes).clasp.forces(nodes) - self.clasp.forces(nodes)).max(initial=0.0)
        )

    def with_corrected_history(
        self, nodes: Nodes, controls: Vector, compliance: Compliance | None, response: Response | None = None
    ) -> "FrictionalSelfContactEnergy":
        pushes, normals = self._pushes(nodes)
        clasp = self.clasp.attach_springs(nodes, self._active_pairs(nodes), pushes, normals)
        places, grip = clasp.places(nodes), clasp.grip.with_adapted_relaxation(self.history_residual(nodes, controls))
        slips = np.flatnonzero(grip.slipping(places) | grip.with_normal_forces(pushes, normals).slipping(places))
        if response is None or not len(slips):
            return self._with(self.contact, clasp.with_grip(grip.with_corrected_history(pushes, normals)))
        rises = self._rises(nodes, slips, normals[slips])
        drags = _drags(clasp, nodes, slips, grip.only(slips).directions(places[slips]))
        moves = -grip.friction * (rises.T @ response(drags))
        return self._with(self.contact, clasp.with_grip(grip.with_newton_step(pushes, normals, slips, moves)))

    def with_advanced_history(self, nodes: Nodes, controls: Vector) -> "FrictionalSelfContactEnergy":
        return self._with(self.contact, self._with_limits_at(nodes).clasp.drag_anchors(nodes))

    def _with(self, contact: SelfContactEnergy, clasp: SelfContactFriction) -> "FrictionalSelfContactEnergy":
        """Return another state; it reuses the pattern of its Hessian if the stencils are the same."""
        other = FrictionalSelfContactEnergy(contact, clasp)
        if np.array_equal(other.stencils, self.stencils):
            other.stencils = self.stencils
        return other

    def _with_limits_at(self, nodes: Nodes) -> "FrictionalSelfContactEnergy":
        """Return this energy with the limits that belong to a shape."""
        pushes, normals = self._pushes(nodes)
        clasp = self.clasp.attach_springs(nodes, self._active_pairs(nodes), pushes, normals)
        return self._with(self.contact, clasp.with_grip(clasp.grip.with_normal_forces(pushes, normals)))

    def _pushes(self, nodes: Nodes) -> tuple[Vector, Points]:
        """Force of other parts on each node of the boundary [N], and its direction."""
        forces = np.zeros_like(nodes)
        self.contact.add_gradient(nodes, np.zeros(0), forces)
        forces = -forces[self.clasp.skin.own]
        pushes = np.linalg.norm(forces, axis=1)
        faint = 1e-10  # Forces below this share of the modulus x area are none
        pushes[pushes < faint * self.clasp.grip.springs * self.contact.skin.distance] = 0.0
        return pushes, np.where(pushes > 0, 1.0 / np.where(pushes > 0, pushes, 1.0), 0.0)[:, None] * forces

    def _active_pairs(self, nodes: Nodes) -> Pairs:
        """Active contact pairs."""
        skin, pairs = self.contact.skin, self.contact.pairs
        return pairs.only(skin.compute_squared_distances(nodes, pairs) < skin.begins(pairs))

    def _rises(self, nodes: Nodes, some: Int[np.ndarray, " some"], normals: Points) -> Float[np.ndarray, "dofs some"]:
        """Derivatives of normal forces on some nodes of the boundary by all degrees of freedom [N/m]."""
        contact, dim = SelfContactEnergy(self.contact.skin, self._active_pairs(nodes)), nodes.shape[1]
        numbers = np.full(len(nodes), -1)
        numbers[self.clasp.skin.own[some]] = np.arange(len(some))
        blocks, columns = contact.hessian(nodes, np.zeros(0)), np.zeros((len(nodes) * len(some), dim))
        for corner in range(contact.stencils.shape[1]):
            whose = numbers[contact.stencils[:, corner]]
            own = np.flatnonzero(whose >= 0)
            rows = blocks[own][:, :, corner * dim : (corner + 1) * dim] @ normals[whose[own]][:, :, None]
            for other in range(contact.stencils.shape[1]):
                part = rows[:, other * dim : (other + 1) * dim, 0]
                np.subtract.at(columns, contact.stencils[own, other] * len(some) + whose[own], part)
        return columns.reshape(len(nodes), len(some), dim).swapaxes(1, 2).reshape(nodes.size, len(some))


def _drags(
    clasp: SelfContactFriction, nodes: Nodes, some: Int[np.ndarray, " some"], ways: Points
) -> Float[np.ndarray, "dofs some"]:
    """Derivatives of the displacements of some nodes from their points, along directions, by all degrees of freedom."""
    columns = np.zeros((*nodes.shape, len(some)))
    rows = np.searchsorted(clasp.touching_nodes, some)
    blocks = clasp.shares[rows][:, :, None] * ways[:, None, :]
    for corner in range(clasp.stencils.shape[1]):
        columns[clasp.stencils[rows, corner], :, np.arange(len(some))] += blocks[:, corner]
    return columns.reshape(nodes.size, len(some))
