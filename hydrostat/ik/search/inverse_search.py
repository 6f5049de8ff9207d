"""`InverseSearch`: states of an inverse problem, connected by trust-region steps; `reached_pose`: its result."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf
from typing import NamedTuple, Self

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik.ik_result import IKResult, IKStatus
from hydrostat.ik.search.linear_model import channels
from hydrostat.ik.search.problem import InverseProblem, InverseState, ModelStep
from hydrostat.mechanics import NewtonResult
from hydrostat.robot import LoadDrive, PinDrive, PoseTarget
from hydrostat.simulation import Equilibrium

SearchProgress = Callable[[int, float], None]
"""Called with the steps tried so far and the rms error of the best that is known [m]."""


@dataclass(frozen=True, kw_only=True)
class SearchBudget:
    """Deadline of a search, and the callback for its progress; an exception of `tell` ends the search."""

    deadline: float = inf  # deadline on the clock of `time.monotonic` [s]
    tell: SearchProgress | None = None

    @classmethod
    def of(cls, seconds: float | None, tell: SearchProgress | None) -> Self:
        """Budget of a number of seconds from now; None: no limit (InputError: not above 0)."""
        if tell is not None and not callable(tell):
            raise InputError(f"progress must be a function that is called with a step and an error, not {tell!r:.60}")
        if seconds is None:
            return cls(tell=tell)
        if isinstance(seconds, bool) or not isinstance(seconds, int | float) or not seconds > 0:
            raise InputError(f"seconds must be above 0, not {seconds!r}")
        return cls(deadline=time.monotonic() + seconds, tell=tell)

    @property
    def over(self) -> bool:
        """True if the time is up."""
        return time.monotonic() >= self.deadline


class InverseSearch:
    """Equilibria along the search for a solution; `solves` counts the equilibria solved for.

    With an accuracy [m] nodes may be so far from equilibrium. Where physics remember the way, as cables that rub do,
    each state is reached straight from the pose `origin`, or from rest if there is none: all contractions change in
    proportion, as in `Simulation.solve`.
    """

    def __init__(
        self,
        problem: InverseProblem,
        *,
        accuracy: float | None = None,
        origin: Equilibrium | None = None,
        budget: SearchBudget | None = None,
    ) -> None:
        self.problem, self.solves, self._origin = problem, 0, origin
        self.budget, self.steps = budget or SearchBudget(), 0
        self.solver = problem.simulation.solver.with_accuracy(accuracy)
        self._remembers, self._turns = problem.simulation.assembly.has_history, False

    def report_progress(self, state: InverseState) -> None:
        """Report the progress of the search to its listener: one more step, and the errors of a state."""
        self.steps += 1
        if self.budget.tell is not None:
            errors = list(state.errors.values())
            self.budget.tell(self.steps, float(np.sqrt(np.mean(np.square(errors)))) if errors else 0.0)

    def begin(self, start: Equilibrium | None) -> InverseState:
        """State of a pose, or of rest, within the limits (NotConvergedError: there is no equilibrium)."""
        pose = start or self.problem.simulation.rest
        self.problem.simulation.check_start(pose)
        values = self.problem.bounds.channel(pose.controls)
        if self._remembers:
            return self._begin_where(values, pose)
        given = self._result(pose)
        if (self.problem.bounds.spread @ values == pose.controls).all() and given.stable:
            found = self.problem.state(values, given)
            if found.sharp:
                return self.problem.idle(found)
        found = self._solve_newton(values, given)
        if found is not None:
            return found
        solved = self.problem.simulation.solve(self.problem.bounds.spread @ values, start=pose, strict=False)
        return self.problem.state(values, self._result(_usable_start(solved)))

    def _begin_where(self, values: Vector, pose: Equilibrium) -> InverseState:
        """Return the state of a pose if loading paths start there, else that at the end of the path to it."""
        simulation = self.problem.simulation
        origin = self._origin or simulation.rest
        contractions = self.problem.bounds.spread @ values
        if pose is not origin or (contractions != pose.controls).any():
            pose = _usable_start(simulation.solve(contractions, start=self._origin, strict=False))
        stiffness = simulation.stiffness(pose)
        return self._idle_slack(self.problem.state(values, replace(pose.result, stiffness=stiffness), pose.history))

    def _follow_path(self, values: Vector) -> InverseState | None:
        """State at the end of the straight path to contractions of the channels [m]; None if it cannot be followed."""
        simulation = self.problem.simulation
        pose = simulation.solve(self.problem.bounds.spread @ values, start=self._origin, strict=False)
        if not _sound(pose.result) or pose.result.stiffness is None:
            return None
        return self.problem.state(values, pose.result, pose.history)

    def _reached_at_once(self, near: NewtonResult, values: Vector) -> InverseState | None:
        """Solve from nodes close by in a single increment while that does as well as many."""
        if self._turns:
            return self._follow_path(values)
        path, contractions = self.problem.simulation.path, self.problem.bounds.spread @ values
        result, history = path.at_once(contractions, self._origin, near)
        if not _sound(result) or result.stiffness is None:
            return None
        return self.problem.state(values, result, history, whole=False)

    def _idle_slack(self, state: InverseState) -> InverseState:
        """State with slack channels at their preferred positions, at the end of the path to these contractions."""
        idle = self.problem.idle(state)
        return state if idle is state else self._follow_path(idle.values) or state

    def jump(self, values: Vector) -> InverseState | None:
        """State reached directly from rest by contractions of the channels [m]; None without an equilibrium."""
        self.solves += 1
        simulation = self.problem.simulation
        if self._remembers:
            begin = self._origin or simulation.rest
            near = self._reached_at_once(replace(begin.result, stiffness=simulation.stiffness(begin)), values)
            return self.problem.idle(near) if near else self._solve_newton(values, begin.result)
        return self._solve_newton(values, self._result(simulation.rest))

    def approach(self, state: InverseState, values: Vector) -> InverseState | None:
        """State at other contractions, near enough to equilibrium to continue; None if no stable one is found."""
        self.solves += 1
        if self._remembers:
            near = self._reached_at_once(state.result, values)
            return near and self.problem.idle(near)
        contractions = self.problem.bounds.spread @ values
        result = state.result
        far = (np.abs(values - state.values) > _LARGE_STEP * self.problem.bounds.span).any()
        relaxations = 6  # steps of Newton towards an equilibrium before stronger means are used
        loose = 0.1  # force left over after these, as a share of the largest tension
        for _ in range(relaxations):
            before = result.nodes
            iterations, tolerance = (_ITERATIONS, loose) if far else (1, None)
            result = self.problem.simulation.solver.relax(
                before, contractions, result.stiffness, iterations=iterations, tolerance=tolerance
            )
            if not result.stable:
                return None if far else self._solve_newton(values, state.result)
            found = self.problem.state(values, result)
            left = np.abs(found.posture.nodes - result.nodes).max()
            if found.sharp or left <= _LEFT * np.abs(result.nodes - before).max():
                return self.problem.idle(found)
            far = False
        return self._solve_newton(values, state.result)

    def follow(self, state: InverseState, values: Vector) -> InverseState | None:
        """State at other contractions, at equilibrium; None if Newton alone does not find it."""
        self.solves += 1
        return self._solve_newton(values, state.result)

    def adopt_state(self, state: InverseState) -> InverseState:
        """Return a state of another search of the same robot as a state of this one."""
        history = state.history if self._remembers else None
        return self.problem.idle(self.problem.state(state.values, state.result, history))

    def refine_equilibrium(self, state: InverseState) -> InverseState | None:
        """Return the equilibrium at the same contractions."""
        if state.sharp:
            return state
        self.solves += 1
        if self._remembers:
            whole = self._follow_path(state.values)
            if whole is not None:
                apart = np.abs(whole.result.nodes - state.result.nodes).max()
                self._turns = self._turns or bool(
                    apart > _SAME_POSE_TOLERANCE * self.problem.simulation.robot.body.mesh.size
                )
            return whole
        contractions = self.problem.bounds.spread @ state.values
        result = self.problem.simulation.solver.relax(
            state.result.nodes, contractions, state.result.stiffness, exact=True
        )
        return self.problem.state(state.values, result) if _sound(result) else None

    def drop_slack(self, state: InverseState) -> InverseState:
        """Release channels with hardly any tension, if the goals stay reached."""
        cables, posture = self.problem.simulation.cables, state.posture
        places = channels(cables, posture, state.values, self.problem.bounds)
        winches = ~self.problem.bounds.driven
        hardly = winches & (places.gaps == 0)
        hardly[winches] &= posture.tensions[places.first[winches]] < _HARDLY * posture.tensions.max(initial=0.0)
        if not hardly.any():
            return state
        values = state.values.copy()
        values[hardly] -= (posture.elongations / cables.ratios)[places.first[hardly]] + places.beyond[hardly]
        found = self.follow(state, np.clip(values, self.problem.bounds.low, self.problem.bounds.high))
        if found is not None and found.error > self.problem.reached:
            step = self.problem.step(found, self.problem.weight(found), self.problem.options.largest_step)
            found = self.follow(found, step.values)
        kept = found is not None and found.error <= self.problem.reached and found.excess <= state.excess
        return found if found is not None and kept else state

    def _result(self, pose: Equilibrium) -> NewtonResult:
        """Return the solver result of a pose in this simulation; another one may have found it."""
        stiffness = self.problem.simulation.stiffness(pose)
        residual = float(np.abs(self.problem.simulation.forces(pose.nodes, pose.controls)).max())
        return replace(pose.result, stiffness=stiffness, residual=residual, stable=stiffness.definite)

    def _solve_newton(self, values: Vector, start: NewtonResult) -> InverseState | None:
        """Solve by Newton's method alone; a longer solve is better done in smaller steps."""
        if self._remembers:
            found = self._follow_path(values)
            return found and self._idle_slack(found)
        result = self.solver.relax(
            start.nodes, self.problem.bounds.spread @ values, start.stiffness, iterations=_ITERATIONS
        )
        return self.problem.idle(self.problem.state(values, result)) if _sound(result) else None


_ITERATIONS = 30  # steps of Newton before an equilibrium is given up
_LARGE_STEP = 0.02  # a step of more than this share of a channel's range is far: it takes more than one step of Newton
_SAME_POSE_TOLERANCE = 1e-8  # ways that end within this share of the body's size end in the same pose
_LEFT = 0.2  # an equilibrium is near enough when what is left is this share of the last step of Newton
_HARDLY = 1e-3  # a channel whose tautest cable pulls less than this share of the largest tension may as well be slack


def _sound(result: NewtonResult) -> bool:
    """Return True if a result is a stable equilibrium."""
    return result.converged and result.stable


def _usable_start(pose: Equilibrium) -> Equilibrium:
    """Pose, if a search can begin from it."""
    if not _sound(pose.result):
        raise NotConvergedError(
            f"inverse kinematics finds no stable equilibrium to begin from: {pose.result.status}; give a start",
            pose.result,
        )
    return pose


EXCESS = 1e-6  # a tension may exceed its limit by this share


@dataclass(frozen=True, kw_only=True)
class StepRules:
    """When a trust-region step is taken."""

    excess_share: float  # a step that reduces a tension must reduce its excess to this share
    far: float  # share by which a step may exceed a tension limit, for the next one to correct


class StepOutcome(NamedTuple):
    """Outcome of a trial step."""

    trial: InverseState | None  # state after the step; None without an equilibrium
    ratio: float  # actual decrease / predicted decrease; minus infinity if unknown
    accepted: bool  # True if the rules accept it as an improvement


def ends(problem: InverseProblem, state: InverseState, step: ModelStep, objective: float, radius: float) -> bool:
    """Return True if the predicted decrease is too small to try: within its limits the state is optimal to first order.

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
) -> StepOutcome:
    """Try a trust-region step of the linear model from a state, with a weight of the effort, and judge it by the rules.

    The move finds the state at other contractions, if there is one.
    """
    trial = move(state, step.values)
    if trial is None:
        return StepOutcome(None, -np.inf, False)
    gain = problem.objective(state, weight) - problem.objective(trial, weight)
    ratio = gain / step.promise if step.promise > 0 else -np.inf
    if state.excess > EXCESS:
        return StepOutcome(trial, ratio, trial.excess < rules.excess_share * state.excess)
    return StepOutcome(trial, ratio, gain > 0 and trial.excess <= rules.far)


@dataclass(frozen=True, kw_only=True, eq=False)
class Descent:
    """Result of one descent."""

    state: InverseState  # best equilibrium within the limits
    status: IKStatus  # reason why the descent ended
    iterations: int  # number of steps tried
    weight: float  # weight of the effort at the end

    @property
    def within_limits(self) -> bool:
        """True if all tensions are within their limits."""
        return self.state.excess <= EXCESS

    def after(self, iterations: int) -> "Descent":
        """Return the same result with the steps of an earlier descent counted in."""
        return replace(self, iterations=iterations)


def reached_pose(search: InverseSearch, found: Descent, target: PoseTarget | None) -> IKResult:
    """Return the result of a search, with its optimality and the active limits."""
    state, problem = found.state, search.problem
    pose = problem.simulation.make_pose(problem.bounds.spread @ state.values, state.result, state.history)
    return IKResult(
        target=target,
        pose=pose,
        errors=state.errors,
        status=found.status,
        iterations=found.iterations,
        solves=search.solves,
        optimality=problem.descent_rate(state, found.weight),
        active_limits=() if found.status is IKStatus.REACHED else limits_that_hold(search, found),
    )


def limits_that_hold(search: InverseSearch, found: Descent) -> tuple[str, ...]:
    """Limits that hold, in words: winches at their ends, cables at their largest tension."""
    state, bounds, robot = found.state, search.problem.bounds, search.problem.simulation.robot
    words = []
    hair = _LIMIT_TOLERANCE * bounds.span
    for channel, value in enumerate(state.values):
        if bounds.driven[channel]:
            words += drive_at_end(robot.drives[channel - len(bounds.driven)], value, hair[channel])
            continue
        winches = [winch.name for winch, own in zip(robot.winches, bounds.channels, strict=False) if own == channel]
        name = " and ".join(winches)
        if value >= bounds.high[channel] - hair[channel]:
            words.append(f"{name}: at maximum contraction, {1e3 * value:.4g} mm")
        elif value <= bounds.low[channel] + hair[channel] and state.posture.tensions[bounds.cables == channel].any():
            words.append(f"{name}: at maximum payout, {abs(round(1e3 * value, 3)):g} mm")
    full = state.posture.tensions >= (1.0 - _LIMIT_TOLERANCE) * bounds.tension
    pulling = {robot.cables[cable].winch: bounds.tension[cable] for cable in np.flatnonzero(full)}
    words.extend(f"{name}: at maximum tension, {most:.4g} N" for name, most in pulling.items())
    first = len(bounds.most) - len(bounds.motors)
    torques = (bounds.loads @ state.posture.tensions)[first:]
    words.extend(
        f"{name}: at maximum torque, {1e3 * most:.4g} N mm"
        for name, torque, most in zip(bounds.motors, torques, bounds.most[first:], strict=True)
        if torque >= (1.0 - _LIMIT_TOLERANCE) * most
    )
    return tuple(words)


def drive_at_end(drive: PinDrive | LoadDrive, value: float, hair: float) -> list[str]:
    """Limit at which a drive stands, in words; empty within its limits."""
    low, high = drive.limits
    ends = {"maximum": value >= high - hair, "minimum": value <= low + hair}
    return [f"{drive.name}: at {name}, {drive.format_value(value)}" for name, holds in ends.items() if holds]


_LIMIT_TOLERANCE = 1e-6  # a limit holds within this share of it
