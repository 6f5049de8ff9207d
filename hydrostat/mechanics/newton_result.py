"""`NewtonResult`: result of the Newton solver, with the reason for stopping."""
# Of the thesis (docs/thesis.md): M4

from dataclasses import dataclass, field
from enum import StrEnum

from hydrostat.arrays import Nodes
from hydrostat.mechanics.factorized_hessian import FactorizedHessian


class NewtonStatus(StrEnum):
    """Why a solve ended."""

    CONVERGED = "converged"
    ITERATION_LIMIT = "iteration limit reached"
    TIME_LIMIT = "time limit reached"
    NO_DESCENT = "no step lowers the energy"
    BAD_START = "the start has an inverted element"
    NO_BALANCE = "friction and the tensions of cables found no balance"


@dataclass(frozen=True, kw_only=True)
class RoundOff:
    """Rounding errors of force and energy for a body with a given modulus x volume.

    Attributes:
        force: rounding error of a nodal force [N].
        energy: rounding error of the energy [J].
    """

    force: float
    energy: float


@dataclass(frozen=True, kw_only=True, eq=False)
class NewtonResult:
    """Result of the Newton solver.

    Attributes:
        nodes: best node positions found [m]; every element has J > 0.
        status: reason for stopping.
        residual: largest component of a residual nodal force [N].
        allowed: residual [N] below which the result counts as converged.
        energy: total energy [J].
        iterations: number of steps taken.
        stable: True if the full Hessian at `nodes` is positive definite: a minimum, not a saddle.
        buckled: True if the solver left a saddle on the way: the body could also have moved elsewhere.
        stiffness: factorized Hessian at `nodes`, or where the last step began, if the residual there was below 1e-5 of
            the applied force or the iterate was within the accuracy.
        error: approximate distance of a node from equilibrium [m] if an accuracy was requested, infinite if it was not
            reached; 0 if none was requested.
    """

    nodes: Nodes
    status: NewtonStatus
    residual: float
    allowed: float
    energy: float
    iterations: int
    stable: bool
    buckled: bool
    stiffness: FactorizedHessian | None = field(repr=False)
    error: float = 0.0

    @property
    def converged(self) -> bool:
        """True if the residual, or with `accuracy` the estimated error, is small enough."""
        return self.status is NewtonStatus.CONVERGED
