"""`InertiaEnergy`: inertia of the nodes in one time step, as a quadratic potential around their free flight."""

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks


class InertiaEnergy(Energy):
    """Sum of w/2 |x - y|^2 over the nodes.

    With w = m / h^2 and y = x_n + h v_n its minimum together with the potential is a step of implicit Euler (E4, E5):
    m (x - y) / h^2 = -dE/dx.
    """

    def __init__(self, targets: Nodes, weights: Float[np.ndarray, " nodes"]) -> None:
        """Take the position that each node reaches without forces [m], and the stiffness that pulls it there [N/m]."""
        count, dim = targets.shape
        self.stencils = np.arange(count)[:, None]
        self.targets, self.weights = targets, weights
        self._blocks = weights[:, None, None] * np.eye(dim)

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return float(0.5 * self.weights @ ((nodes - self.targets) ** 2).sum(axis=1))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return (self.weights[:, None] * (nodes - self.targets))[:, None, :]

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self._blocks

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        return float(np.abs(self.gradient(nodes, controls)).max())
