"""`NewtonResult`: where Newton stopped, and why."""

from dataclasses import dataclass, field

from hydrostat.arrays import Nodes
from hydrostat.mechanics.newton_options import Reason
from hydrostat.mechanics.stiffness import Stiffness


@dataclass(frozen=True, kw_only=True, eq=False)
class NewtonResult:
    """Where Newton stopped.

    Attributes:
        nodes: the best positions found [m]; every element has J > 0.
        reason: why it stopped.
        residual: largest component of a nodal force [N].
        allowed: residual [N] at which it counts as converged.
        energy: total energy [J].
        iterations: steps taken.
        stable: whether the full Hessian there is positive definite: a minimum, no saddle.
        buckled: whether a saddle was left on the way: the body could as well have gone elsewhere.
        stiffness: the Hessian there, factorised, or where the last step began, if that was with less than 1e-5 of the
            applied force left over, or within the accuracy.
        error: about how far a node is from equilibrium [m], where an accuracy was asked for, infinite where it was not
            reached; 0 where none was asked for.
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
        """Whether the residual is as small as allowed."""
        return self.reason is Reason.CONVERGED
