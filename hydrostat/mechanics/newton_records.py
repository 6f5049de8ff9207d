"""Records of a minimisation: how far Newton goes, what rounding hides, where it stopped and why."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Nodes
from hydrostat.mechanics.stiffness import Stiffness


class Reason(StrEnum):
    """Why a solve ended."""

    CONVERGED = "converged"
    ITERATION_LIMIT = "iteration limit reached"
    TIME_LIMIT = "time limit reached"
    NO_DESCENT = "no step lowers the energy"
    BAD_START = "the start has an inverted element"
    NO_BALANCE = "friction and the tensions of cables found no balance"


@dataclass(frozen=True, kw_only=True)
class NewtonOptions:
    """How far and how long Newton goes (M4).

    Attributes:
        tolerance: largest nodal force left over, as a fraction of the largest applied force.
        iterations: most iterations.
        halvings: most halvings of one step.
        whole: whether to give up at once, at no cost, where the first step cannot be taken whole.
        deadline: when it stops at the latest [s], as `time.monotonic` counts.
        accuracy: about how far a node may be from equilibrium [m], by the step that would come next; it stops there
            even with more force left over than the tolerance allows. None: the tolerance alone counts.
    """

    tolerance: float = 1e-10
    iterations: int = 200
    halvings: int = 50
    whole: bool = False
    deadline: float = np.inf
    accuracy: float | None = None


@dataclass(frozen=True, kw_only=True)
class RoundOff:
    """What is lost in the rounding errors of a body whose modulus x volume is some energy.

    Attributes:
        force: [N].
        energy: [J].
    """

    force: float
    energy: float


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


def furthest(moves: Nodes) -> float:
    """How far the node goes that goes furthest [m]."""
    return float(np.sqrt((moves**2).sum(axis=1).max()))
