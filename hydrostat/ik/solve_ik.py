"""`solve_ik`: the contractions that bring a robot nearest to a pose, by descents from several beginnings."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import count, islice

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik.limits import Limits, bounds
from hydrostat.ik.objectives.effort import keeps_taut
from hydrostat.ik.objectives.marker_goal import MarkerGoal, named_targets
from hydrostat.ik.objectives.objective import Objective, checked_objectives
from hydrostat.ik.reached_pose import InverseReason, ReachedPose
from hydrostat.ik.search.inverse_search import EXCESS, Descent, InverseSearch, StepRules, ends, reached_pose, try_step
from hydrostat.ik.search.linear_model import LinearModel
from hydrostat.ik.search.problem import InverseOptions, InverseProblem, InverseState, ModelStep
from hydrostat.robot import Point, Pose
from hydrostat.simulation import Simulation, SolvedPose, friction_band

Targets = Pose | Mapping[str, Point]  # where markers should go [m]: a pose, or points by name


def solve_ik(
    simulation: Simulation,
    targets: Targets | None = None,
    *,
    limits: Limits | None = None,
    objectives: Sequence[Objective] = (),
    start: SolvedPose | None = None,
    options: InverseOptions | None = None,
) -> ReachedPose:
    """Bounded Gauss-Newton through the sensitivities of the equilibrium (R31 to R33, E18).

    Minimises half the squares of what targets and objectives miss while the winches stay within their limits. Each step
    is linearised by dx/da; equilibria on the way are only as sharp as they must be, the last one is exact. The answer
    is a local optimum; where it misses its goal, the search begins elsewhere a few times. docs/theory/inverse.md.

    Where cables rub, the way counts. The answer is the pose in which the robot ends when the winches go straight from
    `start`, or from rest, to the contractions, all in proportion, as in `Simulation.solve`.

    Args:
        simulation: the robot's physics.
        targets: where markers should go [m].
        limits: what the winches may do, beside their travel and release.
        objectives: more that is wished for, or instead.
        start: a pose to begin from, and to count rates from; the rest pose if left out. Where the goals leave a choice
            it does not matter, unless `options.unique` is off.
        options: tolerances and limits of the search.

    Raises:
        InputError: nothing to reach, something that the robot does not have, limits without room, a robot without
            cables, or other physics that remember the way.
        NotConvergedError: no equilibrium where the search begins.
    """
    target = as_pose(targets)
    given = limits or Limits()
    allowed = bounds(simulation, given)
    if given.rate is not None:
        allowed = allowed.near(allowed.channel((start or simulation.rest).contractions))
    terms = [wish.on(simulation) for wish in wishes(target, objectives)]
    ready = given.rate is not None or any(keeps_taut(wish) for wish in objectives)
    problem = InverseProblem(simulation, terms, allowed, options or InverseOptions(), ready=ready)
    search = InverseSearch(problem, origin=start)
    begun = search.begin(start)
    seek = descend
    if problem.options.unique and problem.redundant(begun):
        seek = least_effort
        begun = begun if start is None or given.rate is not None else search.begin(None)
    found = _best(search, seek(search, begun), seek)
    reached = reached_pose(search, found, target)
    if not simulation.assembly.has_history:
        return reached
    return replace(reached, friction_band=_band(simulation, reached.pose))


def _band(simulation: Simulation, pose: SolvedPose) -> Mapping[str, float]:
    """What friction leaves open; empty where the way there and back breaks off."""
    try:
        return friction_band(simulation, pose)
    except NotConvergedError:
        return {}


def as_pose(targets: Targets | None) -> Pose | None:
    """Targets as a pose; None if there are none."""
    if targets is None or isinstance(targets, Pose):
        return targets
    return Pose(name="target", targets=dict(named_targets(targets))) if targets else None


def wishes(target: Pose | None, objectives: Sequence[Objective]) -> list[Objective]:
    """All that is wished for (InputError: nothing)."""
    found = [*([MarkerGoal(targets=target.targets)] if target else []), *checked_objectives(objectives)]
    if not found:
        raise InputError("there is nothing to reach: give targets for markers, or objectives")
    return found


def _best(search: InverseSearch, found: Descent, seek: Callable[[InverseSearch, InverseState], Descent]) -> Descent:
    """The best of several beginnings; the first that reaches its goal."""
    if found.reason is InverseReason.REACHED or not found.state.errors:
        return found
    spent = found.iterations
    best = [found.state]
    for begun in islice(restarts(search, lambda: best[-1]), search.problem.options.restarts):
        other = seek(search, begun)
        spent += other.iterations
        new, old = (search.problem.objective(one.state, found.weight) for one in (other, found))
        if (other.allowed and not found.allowed) or (other.allowed >= found.allowed and new < old):
            found = other
            best.append(other.state)
        if found.reason is InverseReason.REACHED:
            break
    return found.after(spent)


SEED = 0


def restarts(search: InverseSearch, best: Callable[[], InverseState]) -> Iterator[InverseState]:
    """States to begin from: each the pose that leads at once from rest to other contractions.

    A body with several poses at the same contractions ends on the branch that its way leads to (E20), and the errors of
    markers have local optima. So first the best contractions are tried from rest; then in turn ones near them and ones
    anywhere. Only channels that move what is missed are changed: the fingers that are right stay. It ends after a few
    jumps that lead nowhere.
    """
    state = best()
    found = search.jump(state.values)
    if found is not None and not _same(found, state):
        yield found
    draw = np.random.default_rng(SEED)
    failures = 0
    for number in count():
        found = search.jump(_contractions(search, best(), number, draw))
        if found is not None:
            yield found
            continue
        failures += 1
        if failures == _FAILURES:  # few contractions of this robot can be jumped to: a way there would be long
            return


def _contractions(search: InverseSearch, state: InverseState, number: int, draw: np.random.Generator) -> Vector:
    """In turn: one concerned channel alone, some near the best, some anywhere."""
    bounds = search.problem.bounds
    moved = np.flatnonzero(_concerned(search, state))
    kind, turn = number % 3, number // 3
    values = state.values.copy()
    span = bounds.span[moved]
    if kind == 0:
        values[moved] = np.clip(0.0, bounds.low, bounds.high)[moved]
        alone = moved[turn % len(moved)]
        values[alone] = bounds.high[alone] * 2.0 ** -(turn // len(moved))
    elif kind == 1:
        values[moved] += _NEAR * span * draw.standard_normal(len(moved))
    else:
        values[moved] = bounds.low[moved] + span * draw.uniform(size=len(moved))
    return np.clip(values, bounds.low, bounds.high)


def _concerned(search: InverseSearch, state: InverseState) -> np.ndarray:
    """Which channels act mostly on what is missed."""
    slopes = search.problem.slopes(state) ** 2
    missed = state.residual**2 / max(float(np.max(state.residual**2, initial=0.0)), np.finfo(float).tiny)
    share = (missed @ slopes) / np.maximum(slopes.sum(axis=0), np.finfo(float).tiny)
    return share >= _CONCERNED * share.max(initial=0.0)


def _same(first: InverseState, second: InverseState) -> bool:
    nodes = second.result.nodes
    return bool(np.abs(first.result.nodes - nodes).max() < _APART * np.ptp(nodes, axis=0).max())


_FAILURES = 6  # jumps that lead to no pose, after which there are no more
_NEAR = 0.03  # distance of contractions near the best ones: a share of the range, in the root of the mean square
_CONCERNED = 0.3  # channels that act on what is missed at least this well, beside the one that does so best
_APART = 1e-6  # poses that differ by less, in sizes of the body, are one


Square = Float[np.ndarray, "channels channels"]


class Curvature:
    """An estimate of sum r_i d2r_i, which counts where a target is out of reach (Dennis, Gay and Welsch 1981).

    It follows from how the slopes of the residual change along a step. It is used only while it tells the objective
    better than Gauss-Newton alone does and that falls slowly, and forgotten when a cable becomes taut or slack.
    """

    def __init__(self) -> None:
        self._matrix: Square | None = None
        self._trusted = False

    @property
    def matrix(self) -> Square | None:
        """The estimate, if it is to be used."""
        return self._matrix if self._trusted else None

    def doubt(self) -> bool:
        """Whether it had been used; it will not be for the next step."""
        used, self._trusted = self._trusted and self._matrix is not None, False
        return used

    def learn(self, old: LinearModel, new: LinearModel) -> None:
        """Take in a step from one model to the next."""
        if not old.alike(new):
            self._matrix, self._trusted = None, False
            return
        step = new.values - old.values
        plain = old.residual + old.matrix @ step
        missed = 0.5 * float(new.residual @ new.residual - plain @ plain)
        known = np.zeros((len(step), len(step))) if self._matrix is None else self._matrix
        if self._matrix is None:
            fallen = 0.5 * abs(float(old.residual @ old.residual - new.residual @ new.residual))
            self._trusted = abs(missed) > _POOR * fallen
        else:
            self._trusted = abs(missed - 0.5 * float(step @ known @ step)) < abs(missed)
        if new.residual @ new.residual < _FALLS * (old.residual @ old.residual):
            self._trusted = False
        self._matrix = _updated(
            known, step, new.gradient() - old.gradient(new.residual), new.gradient() - old.gradient()
        )


def _updated(known: Square, step: np.ndarray, change: np.ndarray, total: np.ndarray) -> Square:
    """The least change of an estimate, scaled down if too large, that makes it true along a step of the channels.

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


_FALLS = 0.25  # where squares fall to less than this share in a step, Gauss-Newton is on its way to a target in reach
_POOR = 0.1  # Gauss-Newton is poor if it misses the fall of the objective by this share


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
    for weight in _WEIGHTS:
        lighter = descend(search, state, weight=weight)
        state, spent = lighter.state, spent + lighter.iterations
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
        for iteration in range(options.iterations):
            if not self.fixed:
                if self.state.error <= problem.reached and self._sharpen() and self._reached():
                    return self._end(InverseReason.REACHED, iteration)
                self.weight = min(self.weight, problem.weight(self.state))
            step = self._step()
            progress = _ROUGH if self.fixed else options.progress
            least = progress * problem.objective(self.state, self.weight)
            if ends(problem, self.state, step, least, self.radius):
                if self.state.sharp or not self._sharpen():
                    return self._end(InverseReason.OPTIMAL, iteration)
                continue
            tried = try_step(problem, self.state, step, self.weight, self.search.approach, _RULES)
            if tried.accepted and tried.trial is not None:
                if self.state.excess <= EXCESS:
                    self._resize(tried.ratio, step.values)
                self._move(tried.trial)
            elif not self._reconsider():
                self._resize(-np.inf, step.values)
                if self.radius < _SMALLEST_RADIUS:
                    reason = InverseReason.NO_EQUILIBRIUM if tried.trial is None else InverseReason.OPTIMAL
                    return self._end(reason, iteration + 1)
        return self._end(InverseReason.ITERATION_LIMIT, options.iterations)

    def _step(self) -> ModelStep:
        step = self.problem.step(self.state, self.weight, self.radius, self.curvature.matrix)
        if self.model is not None and step.model.values is not self.model.values:
            self.curvature.learn(self.model, step.model)
            if self.curvature.matrix is not None:
                step = self.problem.step(self.state, self.weight, self.radius, self.curvature.matrix)
        self.model = step.model
        return step

    def _reconsider(self) -> bool:
        """After a step that failed: whether there is more to try than a shorter one."""
        if not self.state.sharp and self._sharpen():
            return True  # what a state that does not rest yet promised may have been too good
        return self.curvature.doubt()

    def _resize(self, ratio: float, step: Vector) -> None:
        """The trust radius after a step that gained `ratio` times what it promised."""
        used = float((np.abs(step - self.state.values) / self.problem.bounds.span).max(initial=0.0))
        self.radius = min(_next_radius(self.radius, ratio, used), self.problem.options.largest_step)

    def _move(self, state: InverseState) -> None:
        self.state = state
        if state.sharp and state.excess <= EXCESS:
            self.rested = state

    def _reached(self) -> bool:
        return self.state.error <= self.problem.reached and self.state.excess <= EXCESS

    def _sharpen(self) -> bool:
        """Whether the state rests, now."""
        sharp = self.search.sharpened(self.state)
        if sharp is None:
            return False
        self._move(sharp)
        return True

    def _end(self, reason: InverseReason, iterations: int) -> Descent:
        """The state if it rests within its limits, else the last one that did."""
        if not self._sharpen() or self.state.excess > EXCESS:
            self.state = self.rested or self.state
        if self._reached():
            reason = InverseReason.REACHED
            self.state = self.search.tidied(self.state)
        elif self.state.excess > EXCESS:
            reason = InverseReason.TOO_TIGHT
        elif reason is InverseReason.OPTIMAL and self.problem.slope(self.state, self.weight) > _STEEP:
            reason = InverseReason.STUCK
        return Descent(state=self.state, reason=reason, iterations=iterations, weight=self.weight)


_STEEP = 1e-3  # where the residual's length still falls faster than this [m/m], it is no optimum
_ROUGH = 1e-2  # progress at which a descent with a fixed weight of the effort ends: it is a stage on the way
_RULES = StepRules(mends=0.995, far=0.1)  # when a descent takes a step
_SMALLEST_RADIUS = 1e-7  # steps of less than this fraction of the range are not worth a solve


def _next_radius(radius: float, ratio: float, used: float) -> float:
    """Trust radius after a step that gained `ratio` times what it promised and used `used` of the range."""
    if ratio < 0.25:
        return 0.25 * min(radius, max(used, 1e-12))
    return 2 * radius if ratio > 0.75 and used > 0.9 * radius else radius


_WEIGHTS = (1.0, 0.1, 1e-2, 1e-3)  # of the effort, one after the other
