"""`descend`: from a state to the nearest optimum."""

from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.ik.reached_pose import InverseReason
from hydrostat.ik.search.curvature import Curvature
from hydrostat.ik.search.linear_model import LinearModel
from hydrostat.ik.search.search import Search, State


@dataclass(frozen=True, kw_only=True, eq=False)
class Descent:
    """Where a descent ended.

    Attributes:
        state: an equilibrium, the best within the limits.
        reason: why.
        iterations: steps tried.
        weight: of the effort at the end.
    """

    state: State
    reason: InverseReason
    iterations: int
    weight: float

    @property
    def allowed(self) -> bool:
        """Whether all tensions are within their limits."""
        return self.state.excess <= _EXCESS

    def after(self, iterations: int) -> "Descent":
        """The same, counted with what was tried before."""
        return replace(self, iterations=iterations)


def descend(search: Search, state: State, *, weight: float | None = None) -> Descent:
    """Steps until a goal is reached or nothing is left to gain.

    Args:
        search: the problem.
        state: where to begin.
        weight: of the effort; then it stays, and the end is an optimum of both. Else it falls with the error.
    """
    return _Descent(search, state, weight).run()


class _Descent:
    """One run: trust radius, weight of the effort, curvature, the last state to fall back on."""

    def __init__(self, search: Search, state: State, weight: float | None) -> None:
        self.search, self.state = search, state
        self.rested = state if state.sharp else None
        self.radius = search.options.largest_step
        self.fixed = weight is not None
        self.weight = search.weight(state) if weight is None else weight
        self.curvature = Curvature()
        self.model: LinearModel | None = None

    def run(self) -> Descent:
        search, options = self.search, self.search.options
        for iteration in range(options.iterations):
            if not self.fixed:
                if self.state.error <= search.reached and self._sharpen() and self._reached():
                    return self._end(InverseReason.REACHED, iteration)
                self.weight = min(self.weight, search.weight(self.state))
            objective = search.objective(self.state, self.weight)
            step, promise = self._step()
            # What a model promises is concave in its radius, so a smaller radius must not end the search sooner.
            progress = _ROUGH if self.fixed else options.progress
            least = progress * objective * min(self.radius / options.largest_step, 1.0)
            if promise <= least and self.state.excess <= _EXCESS:
                if self.state.sharp or not self._sharpen():
                    return self._end(InverseReason.OPTIMAL, iteration)
                continue
            trial = search.approach(self.state, step)
            ratio = -np.inf
            if trial is not None and promise > 0:
                ratio = (objective - search.objective(trial, self.weight)) / promise
            if trial is not None and self._accepts(trial, ratio):
                if self.state.excess <= _EXCESS:
                    self._resize(ratio, step)
                self._move(trial)
            elif not self._reconsider():
                self._resize(-np.inf, step)
                if self.radius < _SMALLEST_RADIUS:
                    reason = InverseReason.NO_EQUILIBRIUM if trial is None else InverseReason.OPTIMAL
                    return self._end(reason, iteration + 1)
        return self._end(InverseReason.ITERATION_LIMIT, options.iterations)

    def _step(self) -> tuple[Vector, float]:
        step = self.search.step(self.state, self.weight, self.radius, self.curvature.matrix)
        if self.model is not None and step.model.values is not self.model.values:
            self.curvature.learn(self.model, step.model)
            if self.curvature.matrix is not None:
                step = self.search.step(self.state, self.weight, self.radius, self.curvature.matrix)
        self.model = step.model
        return step.values, step.promise

    def _reconsider(self) -> bool:
        """After a step that failed: whether there is more to try than a shorter one."""
        if not self.state.sharp and self._sharpen():
            return True  # what a state that does not rest yet promised may have been too good
        return self.curvature.doubt()

    def _accepts(self, trial: State, ratio: float) -> bool:
        if self.state.excess > _EXCESS:
            return trial.excess < _MENDS * self.state.excess
        return ratio > 0 and trial.excess <= _FAR

    def _resize(self, ratio: float, step: Vector) -> None:
        """The trust radius after a step that gained `ratio` times what it promised."""
        used = float((np.abs(step - self.state.values) / self.search.bounds.span).max(initial=0.0))
        self.radius = min(_next_radius(self.radius, ratio, used), self.search.options.largest_step)

    def _move(self, state: State) -> None:
        self.state = state
        if state.sharp and state.excess <= _EXCESS:
            self.rested = state

    def _reached(self) -> bool:
        return self.state.error <= self.search.reached and self.state.excess <= _EXCESS

    def _sharpen(self) -> bool:
        """Whether the state rests, now."""
        sharp = self.search.sharpened(self.state)
        if sharp is None:
            return False
        self._move(sharp)
        return True

    def _end(self, reason: InverseReason, iterations: int) -> Descent:
        """The state if it rests within its limits, else the last one that did."""
        if not self._sharpen() or self.state.excess > _EXCESS:
            self.state = self.rested or self.state
        if self._reached():
            reason = InverseReason.REACHED
            self.state = self.search.tidied(self.state)
        elif self.state.excess > _EXCESS:
            reason = InverseReason.TOO_TIGHT
        elif reason is InverseReason.OPTIMAL and self.search.slope(self.state, self.weight) > _STEEP:
            reason = InverseReason.STUCK
        return Descent(state=self.state, reason=reason, iterations=iterations, weight=self.weight)


_STEEP = 1e-3
"""Where the residual's length still falls faster than this [m/m], it is no optimum."""

_MENDS = 0.995
"""A step that mends a tension too large must bring down what exceeds the limit at least so far."""

_ROUGH = 1e-2
"""Progress at which a descent with a fixed weight of the effort ends: it is a stage on the way."""

_EXCESS = 1e-6
"""A tension may exceed its limit by this share."""

_FAR = 0.1
"""A step may lead this far beyond the limit of a tension, for the next one to mend."""

_SMALLEST_RADIUS = 1e-7
"""Steps of less than this fraction of the range are not worth a solve."""


def _next_radius(radius: float, ratio: float, used: float) -> float:
    """Trust radius after a step that gained `ratio` times what it promised and used `used` of the range."""
    if ratio < 0.25:
        return 0.25 * min(radius, max(used, 1e-12))
    return 2 * radius if ratio > 0.75 and used > 0.9 * radius else radius
