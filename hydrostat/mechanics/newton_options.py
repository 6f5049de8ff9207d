"""`NewtonOptions`: tolerance and limits of the Newton solver."""

from dataclasses import dataclass

import numpy as np


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
        near: largest residual nodal force at which factors of the Hessian serve at the end of the step too, as a
            fraction of the largest applied force.
        known: True if those of the first step, known before, may also serve there.
    """

    tolerance: float = 1e-10
    iterations: int = 200
    halvings: int = 50
    whole: bool = False
    deadline: float = np.inf
    accuracy: float | None = None
    near: float = 1e-5
    known: bool = False
