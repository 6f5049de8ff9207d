"""`PinEnergy`: boundary conditions (Dirichlet, by penalty), as springs of zero length between body and world."""

from collections.abc import Mapping
from copy import copy

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, Stencils


class PinEnergy(Energy):
    """Penalty of boundary conditions: sum of k/2 |y - y_pin|^2 over anchors y = sum of weights x nodes (R29, E10)."""

    quadratic = True

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
        self.supports = self._support_of = np.arange(len(stencils)) if supports is None else supports
        self.weights, self.targets, self.stiffness = weights, targets, stiffness
        pairs = stiffness[:, None, None] * weights[:, :, None] * weights[:, None, :]
        dim = targets.shape[1]
        blocks = np.einsum("tab,ij->taibj", pairs, np.eye(dim))
        self._blocks = blocks.reshape(len(stencils), weights.shape[1] * dim, weights.shape[1] * dim)

    def _offsets(self, nodes: Nodes) -> Points:
        return np.einsum("tc,tcd->td", self.weights, nodes[self.stencils]) - self.targets

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return float(0.5 * self.stiffness @ (self._offsets(nodes) ** 2).sum(axis=1))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        forces = self.stiffness[:, None] * self._offsets(nodes)
        return self.weights[:, :, None] * forces[:, None, :]

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self._blocks

    def with_supports_moved(self, shifts: Points) -> "PinEnergy":
        other = copy(self)
        other.targets = self.targets + shifts[self._support_of]
        return other

    def parameter_work(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        works = (self.gradient(nodes, np.zeros(0)) * field[self.stencils]).sum(axis=(1, 2))
        wholes = np.bincount(self._support_of, self.stiffness)
        return {"support_stiffness": np.bincount(self._support_of, works, len(wholes)) / wholes}
