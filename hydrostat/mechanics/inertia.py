"""`InertiaEnergy`, `TimeScheme`: time integration as a sequence of minimizations."""

from dataclasses import dataclass
from math import sqrt
from types import MappingProxyType

import numpy as np

from hydrostat.arrays import Float, Nodes, Vector
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


@dataclass(frozen=True, kw_only=True)
class TimeScheme:
    """Diagonally implicit Runge-Kutta method whose last stage is its end.

    Stage i of a step h of y' = f(y) solves y_i = b_i + h a_ii f(y_i), b_i = y_n + h sum over j < i of a_ij f(y_j). With
    forces that have a potential each stage is a minimization, like a step of implicit Euler; and as the end of the
    step is itself minimized, no element is inverted there.

    Attributes:
        table: rows a_i0 ... a_ii.
        order: order of convergence in the step length.
    """

    table: tuple[tuple[float, ...], ...]
    order: int


_G = 1 - 1 / sqrt(2)
_H = 0.43586652150845899942

SCHEMES = MappingProxyType(
    {
        "euler": TimeScheme(table=((1.0,),), order=1),
        "sdirk2": TimeScheme(table=((_G,), (1 - _G, _G)), order=2),
        "sdirk3": TimeScheme(
            table=(
                (_H,),
                ((1 - _H) / 2, _H),
                (-1.5 * _H**2 + 4 * _H - 0.25, 1.5 * _H**2 - 5 * _H + 1.25, _H),
            ),
            order=3,
        ),
    }
)
"""By name: implicit Euler, and the L-stable methods of two and three stages (Alexander 1977)."""
