"""`DeadLoadEnergy`, `LoadEnergy`, `PinEnergy`: gravity, loads and boundary conditions, energies of single nodes."""

from collections.abc import Mapping
from copy import copy
from typing import Self

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Points, Vector
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
