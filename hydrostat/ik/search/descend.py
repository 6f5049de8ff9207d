"""`descend`, `least_effort`: from a state to an optimum of an inverse problem, by trust-region steps."""

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.ik.ik_result import IKStatus
from hydrostat.ik.search.inverse_search import EXCESS, Descent, InverseSearch, StepRules, ends, try_step
from hydrostat.ik.search.linear_model import LinearModel
from hydrostat.ik.search.problem import InverseState, ModelStep

Square = Float[np.ndarray, "channels channels"]


class Curvature:
    """Estimate of sum r_i d2r_i, which counts where a target is out of reach (Dennis, Gay and Welsch 1981).

    It follows from how the Jacobian of the residual changes along a step. It is used only while it tells the objective
    better than Gauss-Newton alone does and that falls slowly, and forgotten when a cable becomes taut or slack.
    """

    def __init__(self) -> None:
        self._matrix: Square | None = None
        self._trusted = False

    @property
    def matrix(self) -> Square | None:
        """Estimate, if it is to be used."""
        return self._matrix if self._trusted else None

    def distrust(self) -> bool:
        """Distrust the matrix for the next step; return True if it had been used."""
        used, self._trusted = self._trusted and self._matrix is not None, False
        return used

    def update(self, old: LinearModel, new: LinearModel) -> None:
        """Take in a step from one model to the next."""
        if not old.alike(new):
            self._matrix, self._trusted = None, False
            return
        step = new.values - old.values
        plain = old.residual + old.matrix @ step
        missed = 0.5 * float(new.residual @ new.residual - plain @ plain)
        known = np.zeros((len(step), len(step))) if self._matrix is None else self._matrix
        poor = 0.1  # Gauss-Newton is poor if it misses the fall of the objective by this share
        if self._matrix is None:
            fallen = 0.5 * abs(float(old.residual @ old.residual - new.residual @ new.residual))
            self._trusted = abs(missed) > poor * fallen
        else:
            self._trusted = abs(missed - 0.5 * float(step @ known @ step)) < abs(missed)
        # where squares fall to less than this share in a step, Gauss-Newton is on its way to a target in reach
        falls = 0.25
        if new.residual @ new.residual < falls * (old.residual @ old.residual):
            self._trusted = False
        self._matrix = _broyden_update(
            known, step, new.gradient() - old.gradient(new.residual), new.gradient() - old.gradient()
        )


def _broyden_update(known: Square, step: np.ndarray, change: np.ndarray, total: np.ndarray) -> Square:
    """Least change of an estimate, scaled down if too large, that makes it true along a step of the channels.

    The estimate times the step should be `change`; `total` is the change of the whole gradient.
    """
    along = float(step @ total)
    if not along > 0.0:
        return known
    bent = float(step @ known @ step)
    if bent != 0.0:
        known = known * min(1.0, abs(float(step @ change)) / abs(bent))
    miss = change - known @ step
    outer = np.outer(miss, total)
    return known + (outer + outer.T) / along - float(step @ miss) / along**2 * np.outer(total, total)


def descend(search: InverseSearch, state: InverseState, *, weight: float | None = None) -> Descent:
    """Trust-region steps until a goal is reached or nothing is left to gain.

    A weight of the effort that is given stays, and the end is an optimum of both; else it falls with the error.
    """
    return _TrustRegionDescent(search, state, weight).run()


def least_effort(search: InverseSearch, state: InverseState) -> Descent:
    """Approach the goal with least squared tensions, where it leaves a choice (E18).

    With a heavy effort the optimum is near rest. It is followed while the weight of the effort falls. Walking along the
    poses that reach the goal would be slow, as these are curved.
    """
    spent = 0
    weights = (1.0, 0.1, 1e-2, 1e-3)  # of the effort, one after the other
    for weight in weights:
        lighter = descend(search, state, weight=weight)
        state, spent = lighter.state, spent + lighter.iterations
        if lighter.status is IKStatus.TIME_LIMIT:
            return lighter.after(spent)
    found = descend(search, state)
    return found.after(spent + found.iterations)


class _TrustRegionDescent:
    """One run: trust radius, weight of the effort, curvature, the last state to fall back on."""

    def __init__(self, search: InverseSearch, state: InverseState, weight: float | None) -> None:
        self.search, self.problem, self.state = search, search.problem, state
        self.rested = state if state.sharp else None
        self.radius = search.problem.options.largest_step
        self.fixed = weight is not None
        self.weight = search.problem.weight(state) if weight is None else weight
        self.curvature = Curvature()
        self.model: LinearModel | None = None

    def run(self) -> Descent:
        problem, options = self.problem, self.problem.options
        # progress at which a descent with a fixed weight of the effort ends: it is a stage on the way
        rough = 1e-2
        smallest_radius = 1e-7  # steps of less than this fraction of the range are not worth a solve
        for iteration in range(options.iterations):
            if self.search.budget.over:
                return self._end(IKStatus.TIME_LIMIT, iteration)
            self.search.report_progress(self.state)
            if not self.fixed:
                if self.state.error <= problem.reached and self._sharpen() and self._is_reached():
                    return self._end(IKStatus.REACHED, iteration)
                self.weight = min(self.weight, problem.weight(self.state))
            step = self._step()
            progress = rough if self.fixed else options.progress
            least = progress * problem.objective(self.state, self.weight)
            if ends(problem, self.state, step, least, self.radius):
                if self.state.sharp or not self._sharpen():
                    return self._end(IKStatus.LOCAL_OPTIMUM, iteration)
                continue
            tried = try_step(problem, self.state, step, self.weight, self.search.approach, _RULES)
            if tried.accepted and tried.trial is not None:
                if self.state.excess <= EXCESS:
                    self._resize(tried.ratio, step.values)
                self._move(tried.trial)
            elif not self._reconsider():
                self._resize(-np.inf, step.values)
                if self.radius < smallest_radius:
                    status = IKStatus.NO_EQUILIBRIUM if tried.trial is None else IKStatus.LOCAL_OPTIMUM
                    return self._end(status, iteration + 1)
        return self._end(IKStatus.ITERATION_LIMIT, options.iterations)

    def _step(self) -> ModelStep:
        step = self.problem.step(self.state, self.weight, self.radius, self.curvature.matrix)
        if self.model is not None and step.model.values is not self.model.values:
            self.curvature.update(self.model, step.model)
            if self.curvature.matrix is not None:
                step = self.problem.step(self.state, self.weight, self.radius, self.curvature.matrix)
        self.model = step.model
        return step

    def _reconsider(self) -> bool:
        """Return True if, after a failed step, there is more to try than a shorter one."""
        if not self.state.sharp and self._sharpen():
            return True  # what a state that does not rest yet promised may have been too good
        return self.curvature.distrust()

    def _resize(self, ratio: float, step: Vector) -> None:
        """Update the trust radius after a step with a given ratio of actual to predicted decrease."""
        used = float((np.abs(step - self.state.values) / self.problem.bounds.span).max(initial=0.0))
        self.radius = min(_next_radius(self.radius, ratio, used), self.problem.options.largest_step)

    def _move(self, state: InverseState) -> None:
        self.state = state
        if state.sharp and state.excess <= EXCESS:
            self.rested = state

    def _is_reached(self) -> bool:
        return self.state.error <= self.problem.reached and self.state.excess <= EXCESS

    def _sharpen(self) -> bool:
        """Solve the state to equilibrium; return True if that succeeds."""
        sharp = self.search.refine_equilibrium(self.state)
        if sharp is None:
            return False
        self._move(sharp)
        return True

    def _end(self, status: IKStatus, iterations: int) -> Descent:
        """State if it rests within its limits, else the last one that did."""
        if not self._sharpen() or self.state.excess > EXCESS:
            self.state = self.rested or self.state
        steep = 1e-3  # where the residual's length still falls faster than this [m/m], it is no optimum
        if self._is_reached():
            status = IKStatus.REACHED
            self.state = self.search.drop_slack(self.state)
        elif self.state.excess > EXCESS:
            status = IKStatus.INFEASIBLE
        elif status is IKStatus.LOCAL_OPTIMUM and self.problem.descent_rate(self.state, self.weight) > steep:
            status = IKStatus.STALLED
        return Descent(state=self.state, status=status, iterations=iterations, weight=self.weight)


_RULES = StepRules(excess_share=0.995, far=0.1)  # when a descent takes a step


def _next_radius(radius: float, ratio: float, used: float) -> float:
    """Trust radius after a step with this ratio of actual to predicted decrease that used `used` of the range."""
    if ratio < 0.25:
        return 0.25 * min(radius, max(used, 1e-12))
    return 2 * radius if ratio > 0.75 and used > 0.9 * radius else radius
