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
        whole: True to stop immediately, at no cost, if the first full step fails.
        deadline: latest time at which the solver stops [s], on the clock of `time.monotonic`.
        accuracy: approximate distance of a node from equilibrium [m], estimated from the next step. The solver stops
            there even if the residual force exceeds the tolerance. None to use only the tolerance.
        near: largest residual nodal force at which the factorized Hessian is used again at the end of the step, as a
            fraction of the largest applied force.
        known: True if the factors of the first step, known before, may also be used there.
    """

    tolerance: float = 1e-10
    iterations: int = 200
    halvings: int = 50
    whole: bool = False
    deadline: float = np.inf
    accuracy: float | None = None
    near: float = 1e-5
    known: bool = False


@dataclass(frozen=True)
class NewtonRules:
    """Rules of the steps, the same for all problems."""

    margin: float = 1.1
    """Estimated distance to equilibrium over the length of Newton's step, which is it to first order."""

    linear: float = 1e-2
    """Residual, as a share of the largest applied force, below which Newton's step is the distance to equilibrium."""

    crushed: float = 0.2
    """No step leaves less than this share of the volume of the element that was squeezed most before it.

    An element near J = 0 pushes back so hard, and so far from linearly, that Newton then creeps for dozens of steps.
    """

    pays: float = 0.1
    """A step with old factors has to bring the residual down this far, or new ones are made."""

    short_step: float = 0.25
    """A step of which less is taken is damped from then on."""

    damps: float = 4.0
    """Factor by which damping then grows."""

    long_step: float = 0.5
    """After a step of which more was taken there is less damping."""

    eases: float = 8.0
    """Factor by which damping then falls."""

    min_damping_share: float = 0.05
    """Damping that takes less than this share of a step's curvature is left out."""

    fast_decrease: float = 0.1
    """After a step that leaves less than this share of the residual the full Hessian is tried immediately."""

    saddle_tolerance: float = 1e-4
    """Sharpness, as a share of the largest applied force, from which on an equilibrium differs from a saddle."""

    saddles: int = 3
    """Maximum number of saddles left in one solve."""


RULES = NewtonRules()
