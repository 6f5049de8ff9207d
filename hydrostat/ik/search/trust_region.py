"""`try_step`: one trust-region step of an inverse search, for descents and for trackers alike."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.ik.search.problem import InverseProblem, InverseState, ModelStep

EXCESS = 1e-6
"""A tension may exceed its limit by this share."""


@dataclass(frozen=True, kw_only=True)
class StepRules:
    """When a step is taken.

    Attributes:
        mends: a step that mends a tension too large must bring down what exceeds the limit at least so far, as a share.
        far: share of a tension's limit by which a step may lead beyond it, for the next one to mend.
    """

    mends: float
    far: float


class StepTried(NamedTuple):
    """Where a step led.

    Attributes:
        trial: the state there; None where no equilibrium was found.
        ratio: what it gained, as a share of what it promised; minus infinity where nothing is known.
        accepted: whether it is better than before by the rules.
    """

    trial: InverseState | None
    ratio: float
    accepted: bool


def ends(problem: InverseProblem, state: InverseState, step: ModelStep, objective: float, radius: float) -> bool:
    """Tell whether a step promises too little to be tried: within its limits the state is optimal to first order.

    What a model promises is concave in its radius, so a smaller radius must not end the search sooner; `objective` is
    that of the state times the progress below which it is not worth a step.
    """
    least = objective * min(radius / problem.options.largest_step, 1.0)
    return step.promise <= least and state.excess <= EXCESS


def try_step(
    problem: InverseProblem,
    state: InverseState,
    step: ModelStep,
    weight: float,
    move: Callable[[InverseState, Vector], InverseState | None],
    rules: StepRules,
) -> StepTried:
    """Try a step of the linear model and judge it.

    Args:
        problem: what is sought.
        state: where the step begins.
        step: where it leads, and its promise.
        weight: of the effort.
        move: finds the state at other contractions.
        rules: when it is taken.
    """
    trial = move(state, step.values)
    if trial is None:
        return StepTried(None, -np.inf, False)
    gain = problem.objective(state, weight) - problem.objective(trial, weight)
    ratio = gain / step.promise if step.promise > 0 else -np.inf
    if state.excess > EXCESS:
        return StepTried(trial, ratio, trial.excess < rules.mends * state.excess)
    return StepTried(trial, ratio, gain > 0 and trial.excess <= rules.far)
