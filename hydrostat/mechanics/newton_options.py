"""What Newton is told: how far and how long it goes, what rounding hides; and the reasons why it ends."""

# Of the thesis (docs/thesis.md): M4

from dataclasses import dataclass
from enum import StrEnum

import numpy as np


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
    """How far and how long Newton goes.

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
