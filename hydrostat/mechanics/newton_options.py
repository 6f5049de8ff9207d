"""Options, rounding-error bounds and stop reasons of the Newton solver."""

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
    """Convergence options for the Newton solver.

    Attributes:
        tolerance: largest residual nodal force, as a fraction of the largest applied force.
        iterations: maximum number of iterations.
        halvings: maximum number of halvings of one step.
        whole: give up immediately, at no cost, if the first step cannot be taken whole.
        deadline: latest time at which the solver stops [s], on the clock of `time.monotonic`.
        accuracy: approximate distance of a node from equilibrium [m], estimated from the next step. The solver stops
            there even if the residual force exceeds the tolerance. None: only the tolerance counts.
    """

    tolerance: float = 1e-10
    iterations: int = 200
    halvings: int = 50
    whole: bool = False
    deadline: float = np.inf
    accuracy: float | None = None


@dataclass(frozen=True, kw_only=True)
class RoundOff:
    """Rounding errors of force and energy for a body with a given modulus x volume.

    Attributes:
        force: rounding error of a nodal force [N].
        energy: rounding error of the energy [J].
    """

    force: float
    energy: float
