"""`NewtonResult`: where Newton stopped, and why."""

from dataclasses import dataclass, field

from hydrostat.arrays import Nodes
from hydrostat.mechanics.newton_options import Reason
from hydrostat.mechanics.stiffness import Stiffness


@dataclass(frozen=True, kw_only=True, eq=False)
class NewtonResult:
    """Result of the Newton solver.

    Attributes:
        nodes: best node positions found [m]; every element has J > 0.
        reason: reason for stopping.
        residual: largest component of a residual nodal force [N].
        allowed: residual [N] below which the result counts as converged.
        energy: total energy [J].
        iterations: number of steps taken.
        stable: True if the full Hessian at `nodes` is positive definite: a minimum, not a saddle.
        buckled: True if the solver left a saddle on the way: the body could also have moved elsewhere.
        stiffness: factorised Hessian at `nodes`, or where the last step began, if the residual there was below 1e-5 of
            the applied force or the iterate was within the accuracy.
        error: approximate distance of a node from equilibrium [m] if an accuracy was requested, infinite if it was not
            reached; 0 if none was requested.
    """

    nodes: Nodes
    reason: Reason
    residual: float
    allowed: float
    energy: float
    iterations: int
    stable: bool
    buckled: bool
    stiffness: Stiffness | None = field(repr=False)
    error: float = 0.0

    @property
    def converged(self) -> bool:
        """True if the residual, or with `accuracy` the estimated error, is small enough."""
        return self.reason is Reason.CONVERGED
