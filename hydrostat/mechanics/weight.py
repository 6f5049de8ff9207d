"""`WeightEnergy`: dead loads, such as gravity."""

from collections.abc import Mapping

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks


class WeightEnergy(Energy):
    """-sum of f . (x - X), with a force f at each node that does not change (E5)."""

    quadratic = True

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

    def with_load(self, share: float) -> "WeightEnergy":
        return WeightEnergy(self._rest, share * self.forces)

    def parameter_work(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        work = np.array([float((self.gradient(nodes, np.zeros(0)) * field[self.stencils]).sum())])
        return {"load": work, "thickness": work}
