"""Energies of single nodes: gravity, loads and boundary conditions, fixed or driven."""

from collections.abc import Mapping
from copy import copy
from typing import ClassVar, Self

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Nodes, Points, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, Stencils


class DeadLoadEnergy(Energy):
    """-sum of f . (x - X), with a force f at each node that does not change (E5)."""

    has_constant_hessian = True

    def __init__(self, nodes: Nodes, forces: Points) -> None:
        """Forces [N] at each of the `nodes`; the energy is 0 where these are [m]."""
        self.stencils = np.arange(len(nodes))[:, None]
        self.forces = forces
        self._rest = nodes

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return -float(np.vdot(self.forces, nodes - self._rest))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return -self.forces[:, None, :]

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return np.zeros((len(nodes), nodes.shape[1], nodes.shape[1]))

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        return float(np.abs(self.forces).max(initial=0.0))

    def with_load(self, share: float) -> Self:
        other = copy(self)
        other.forces = share * self.forces
        return other

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        work = np.array([float((self.gradient(nodes, np.zeros(0)) * field[self.stencils]).sum())])
        return {"load": work, "thickness": work}


class LoadEnergy(DeadLoadEnergy):
    """`DeadLoadEnergy` of given forces, which do not grow with the thickness of the body."""

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        return {}


class PinEnergy(Energy):
    """Penalty of boundary conditions: sum of k/2 |y - y_pin|^2 over anchors y = sum of weights x nodes (R29, E10)."""

    has_constant_hessian = True

    def __init__(
        self,
        *,
        stencils: Stencils,
        weights: Float[np.ndarray, "terms corners"],
        targets: Points,
        stiffness: Float[np.ndarray, " terms"],
        supports: Int[np.ndarray, " terms"] | None = None,
    ) -> None:
        """Pins that pull anchors to their targets [m], with a stiffness each [N/m]; each a support if none is given."""
        self.stencils = stencils
        self.support_of = np.arange(len(stencils)) if supports is None else supports
        self.supports = self.support_of
        self.weights, self.targets, self.stiffness = weights, targets, stiffness
        dim = targets.shape[1]
        self._rows, self._pulls = weights[:, None, :], stiffness[:, None, None] * weights[:, :, None]
        self._axis_stiffness = np.repeat(stiffness, dim)
        pairs = self._pulls * self._rows
        blocks = np.einsum("tab,ij->taibj", pairs, np.eye(dim))
        self._blocks = blocks.reshape(len(stencils), weights.shape[1] * dim, weights.shape[1] * dim)

    def _offsets(self, nodes: Nodes) -> Points:
        return np.matmul(self._rows, nodes.take(self.stencils, axis=0))[:, 0] - self.targets

    def value(self, nodes: Nodes, controls: Vector) -> float:
        offsets = self._offsets(nodes).ravel()
        return 0.5 * float(self._axis_stiffness @ (offsets * offsets))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self._pulls * self._offsets(nodes)[:, None, :]

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self._blocks

    def with_supports_moved(self, shifts: Points) -> "PinEnergy":
        other = copy(self)
        other.targets = self.targets + shifts[self.support_of]
        return other

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        works = (self.gradient(nodes, np.zeros(0)) * field[self.stencils]).sum(axis=(1, 2))
        wholes = np.bincount(self.support_of, self.stiffness)
        return {"support_stiffness": np.bincount(self.support_of, works, len(wholes)) / wholes}


class DrivenLoadEnergy(Energy):
    """a E(x) with the energy E of a whole load, which reads no control, and the share a of it that acts."""

    convex: ClassVar[bool] = False

    def __init__(self, whole: Energy, control: int) -> None:
        """Whole load, and the index of the control that scales it."""
        self.whole, self._index = whole, control
        self.stencils = whole.stencils
        self.controls = np.full(len(whole.stencils), control)

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return controls[self._index] * self.whole.value(nodes, controls)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return controls[self._index] * self.whole.gradient(nodes, controls)

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return controls[self._index] * self.whole.hessian(nodes, controls)

    def control_gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self.whole.gradient(nodes, controls)

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        return abs(controls[self._index]) * self.whole.largest_force(nodes, controls)

    def with_active_terms(self, nodes: Nodes) -> "DrivenLoadEnergy":
        whole = self.whole.with_active_terms(nodes)
        if whole is self.whole:
            return self
        other = copy(self)
        other.whole = whole
        return other

    def parameter_derivative_at(self, nodes: Nodes, field: Nodes, controls: Vector) -> Mapping[str, Vector]:
        """`parameter_derivative` of the share that acts."""
        works = self.whole.parameter_derivative(nodes, field)
        return {name: controls[self._index] * work for name, work in works.items()}


class DrivenPinEnergy(Energy):
    """Energy that moves targets p of a `PinEnergy` to t(a), a being the control of each term.

    The energy k/2 |y - t|^2 - k/2 |y - p|^2 of a pin is linear in the anchor y, so the Hessian of the body, of its
    pins and its factors at rest serve for all values of a drive. A turn by an angle a moves p by
    sin(a) D + (1 - cos a) E with D = n x (p - c), E = n x D; a slide by a D.
    """

    has_constant_hessian = True

    def __init__(
        self,
        pins: PinEnergy,
        *,
        terms: Int[np.ndarray, " terms"],
        controls: Int[np.ndarray, " terms"],
        directions: tuple[Points, Points],
        turns: Bool[np.ndarray, " terms"],
    ) -> None:
        """Drives of some terms of pins: their controls, directions D and E, and whether they turn."""
        self.stencils, self.controls = pins.stencils[terms], controls
        self._pins, self._weights = pins, pins.weights[terms]
        self._places, self._stiffness = pins.targets[terms], pins.stiffness[terms]
        self._first, self._second = directions
        self._turns = turns
        self._owners = self.supports = pins.support_of[terms]
        size = self.stencils.shape[1] * self._places.shape[1]
        self._blocks = np.zeros((len(terms), size, size))

    def _shifts(self, controls: Vector) -> Points:
        values = controls[self.controls]
        along = np.where(self._turns, np.sin(values), values)
        across = np.where(self._turns, 1 - np.cos(values), 0.0)
        return along[:, None] * self._first + across[:, None] * self._second

    def _anchors(self, nodes: Nodes) -> Points:
        return np.matmul(self._weights[:, None, :], nodes.take(self.stencils, axis=0))[:, 0]

    def value(self, nodes: Nodes, controls: Vector) -> float:
        shifts = self._shifts(controls)
        offsets = self._anchors(nodes) - self._places - 0.5 * shifts
        return -float(self._stiffness @ (shifts * offsets).sum(axis=1))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return -(self._stiffness[:, None] * self._weights)[:, :, None] * self._shifts(controls)[:, None, :]

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self._blocks

    def control_gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        values = controls[self.controls]
        along = np.where(self._turns, np.cos(values), 1.0)
        across = np.where(self._turns, np.sin(values), 0.0)
        speeds = along[:, None] * self._first + across[:, None] * self._second
        return -(self._stiffness[:, None] * self._weights)[:, :, None] * speeds[:, None, :]

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        pulls = self._stiffness[:, None] * (self._anchors(nodes) - self._places - self._shifts(controls))
        return float(np.abs(pulls).max(initial=0.0)) if controls[self.controls].any() else 0.0

    def with_supports_moved(self, shifts: Points) -> "DrivenPinEnergy":
        other = copy(self)
        other._places = self._places + shifts[self._owners]
        return other

    def support_work(self, field: Nodes, controls: Vector) -> Vector:
        """d(dE/dx . field) / dk of each support of the pins, to be added to the `parameter_derivative` of these."""
        works = (self.gradient(field, controls) * field[self.stencils]).sum(axis=(1, 2))
        wholes = np.bincount(self._pins.support_of, self._pins.stiffness)
        return np.bincount(self._owners, works, len(wholes)) / wholes
