"""`Tracker`: contractions for targets that move, fit to be streamed."""

# Of the thesis (docs/thesis.md): R34

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Protocol, runtime_checkable

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.given import Point, check_type
from hydrostat.ik.ik_result import IKResult, IKStatus
from hydrostat.ik.inverse_kinematics import Targets, as_pose, wishes
from hydrostat.ik.limits import Limits, bounds
from hydrostat.ik.linearized_pose import LinearizedPose
from hydrostat.ik.objectives.objective import Objective, Residual
from hydrostat.ik.search.inverse_search import EXCESS, Descent, InverseSearch, StepRules, ends, reached_pose, try_step
from hydrostat.ik.search.problem import IKOptions, InverseProblem, InverseState
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Equilibrium, Simulation


@runtime_checkable
class ModelAnswer(Protocol):
    """Answer of a model: contractions [m] in the order of the winches, and their error."""

    @property
    def contractions(self) -> Vector:
        """Cable that each winch takes in [m]."""
        ...

    @property
    def error(self) -> float:
        """Mean distance of the markers from their targets that is expected [m]."""
        ...

    @property
    def uncertainty(self) -> float:
        """Uncertainty of the error [m]."""
        ...


@runtime_checkable
class PoseModel(Protocol):
    """Model that predicts contractions for targets without a simulation, such as `hydrostat.learning.LearnedModel`."""

    def check(self, robot: Robot) -> None:
        """Check that it is a model of this robot (InputError: it is another's)."""
        ...

    def solve(self, targets: Targets) -> ModelAnswer:
        """Predict contractions that bring markers to targets [m] (InputError: as for a tracker)."""
        ...


class Tracker:
    """Any-time inverse kinematics: each update takes one trust-region step and returns a pose.

    Every pose is a stable equilibrium within all limits, so you can send its contractions to motors immediately; with
    an accuracy, its nodes are within that distance of equilibrium [m]. Slack cables are kept just short of taut, so
    that they can pull without delay. With cable friction, each update continues straight from the previous pose: the
    poses are those of a robot that receives them in sequence::

        tracker = hs.Tracker(simulation, limits=hs.Limits(rate=0.1))
        while True:
            reached = tracker.update({"tip": (0.1, 0.02)}, seconds=1 / 30)

    Attributes:
        pose: current pose of the robot.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        limits: Limits | None = None,
        objectives: Sequence[Objective] = (),
        start: Equilibrium | None = None,
        options: IKOptions | None = None,
        accuracy: float | None = None,
        model: PoseModel | None = None,
    ) -> None:
        """Begin at `start`, the rest pose if left out; the other arguments are as for `solve_ik`.

        With an accuracy nodes may be so far from equilibrium [m], as in `Simulation.solve`. With a model, each new
        target is asked of it first: where it expects to leave less than half of the error, and the equilibrium there is
        better within the limits, the update leads there instead of a step; the next goes on by steps.

        Raises:
            InputError: no simulation, limits, start, accuracy or model, or a start or a model of another robot.
        """
        check_type(simulation, Simulation, "simulation must be a Simulation(robot)")
        check_type(limits, (Limits, type(None)), "limits must be Limits(...), such as Limits(rate=0.05)")
        simulation.check_start(start)
        simulation.solver.with_accuracy(accuracy, simulation.robot.body.mesh.size)
        if model is not None:
            if not hasattr(model, "check"):
                raise InputError(f"model must be one that LearnedModel.load returns, not {model!r:.60}")
            model.check(simulation.robot)
        self._model = model
        self._asked: Mapping[str, Point] | None = None  # the targets that the model was asked for last
        self._simulation, self._objectives = simulation, tuple(objectives)
        self._limits, self._options = limits or Limits(), options or IKOptions()
        self._radius, self._accuracy = self._options.largest_step, accuracy
        self._state: InverseState | None = None
        self._targets: Mapping[str, Point] = {}  # of the last update
        self._terms: Sequence[Residual] = ()
        self.pose = start or simulation.rest

    def update(
        self, targets: Targets | None = None, *, seconds: float, objectives: Sequence[Objective] = ()
    ) -> IKResult:
        """Take one step towards the current targets.

        Args:
            targets: target positions of markers [m].
            seconds: time since the last update, for rate limits [s].
            objectives: objectives for this update, in addition to those given at the start.

        Raises:
            InputError: as for `solve_ik`, or seconds not above 0.
            NotConvergedError: no equilibrium at the start.
        """
        if isinstance(seconds, bool) or not isinstance(seconds, int | float | np.number) or not seconds > 0:
            raise InputError(f"seconds since the last update must be above 0, not {seconds!r:.60}")
        target = as_pose(targets)
        search = self._search(target, seconds, objectives)
        state = search.begin(self.pose) if self._state is None else search.adopt_state(self._state)
        weight, status = search.problem.weight(state), IKStatus.REACHED
        if not _is_reached(search.problem, state):
            led = self._predict(search, state, target)
            weight = search.problem.weight(led or state)
            state, status = (led, IKStatus.ITERATION_LIMIT) if led else self._step(search, state, weight)
        self._state = state
        if _is_reached(search.problem, state):
            status = IKStatus.REACHED
        elif state.excess > _RULES.far:
            status = IKStatus.INFEASIBLE
        found = Descent(state=state, status=status, iterations=1, weight=weight)
        reached = reached_pose(search, found, target)
        self.pose, self._targets = reached.pose, {} if target is None else dict(target.targets)
        self._terms = search.problem.terms
        return reached

    def linearize(self, *, seconds: float) -> LinearizedPose:
        """Return the first-order model of the contractions around the pose of the last update.

        Use it to answer targets that have just moved, before the next update.

        Args:
            seconds: time over which rate limits apply [s].

        Raises:
            InputError: no update with targets yet.
        """
        if self._state is None or not self._targets:
            raise InputError("an outlook needs an update with targets before it")
        problem = self._problem(seconds, self._terms)
        return LinearizedPose(
            model=problem.linear(self._state),
            targets=self._targets,
            worth=problem.worth,
            size=problem.size,
            effort=self._options.effort,
            radius=self._radius,
            spread=problem.bounds.spread,
        )

    def __repr__(self) -> str:
        """Return a one-line summary."""
        return f"<Tracker at {self.pose!r}>"

    def _predict(self, search: InverseSearch, state: InverseState, target: PoseTarget | None) -> InverseState | None:
        """Return the state of the model's answer; None if it answered these targets before, or is no better."""
        if self._model is None or target is None or target.targets == self._asked:
            return None
        self._asked = dict(target.targets)
        answer, problem = self._model.solve(target), search.problem
        if answer.error + answer.uncertainty > _WORTH * np.mean([state.errors[name] for name in target.targets]):
            return None
        found = search.follow(state, problem.bounds.channel(answer.contractions))
        if found is None or found.excess > max(state.excess, _RULES.far):
            return None
        weight = problem.weight(state)
        return found if problem.objective(found, weight) < problem.objective(state, weight) else None

    def _step(self, search: InverseSearch, state: InverseState, weight: float) -> tuple[InverseState, IKStatus]:
        """Return the state after the first accepted step, and its status."""
        problem, largest = search.problem, self._options.largest_step
        least = self._options.progress * problem.objective(state, weight)
        first, found = self._radius, False
        tries = 3  # Steps tried in one update before the robot stays where it is
        for _ in range(tries):
            step = problem.step(state, weight, self._radius)
            if ends(problem, state, step, least, first):
                self._radius = largest
                return state, IKStatus.LOCAL_OPTIMUM
            tried = try_step(problem, state, step, weight, search.follow, _RULES)
            if tried.accepted and tried.trial is not None:
                self._radius = min(2.0 * self._radius, largest)
                return tried.trial, IKStatus.ITERATION_LIMIT
            found = found or tried.trial is not None
            self._radius = max(0.25 * self._radius, _MIN_STEP)
        return state, IKStatus.STALLED if found else IKStatus.NO_EQUILIBRIUM

    def _search(self, target: PoseTarget | None, seconds: float, objectives: Sequence[Objective]) -> InverseSearch:
        terms = [wish.bind(self._simulation) for wish in wishes(target, [*self._objectives, *objectives])]
        return InverseSearch(self._problem(seconds, terms), accuracy=self._accuracy, origin=self.pose)

    def _problem(self, seconds: float, terms: Sequence[Residual]) -> InverseProblem:
        """Inverse problem of these terms, within the bounds reachable from the pose in a given time [s]."""
        limits = self._limits if self._limits.rate is None else replace(self._limits, interval=seconds)
        allowed = bounds(self._simulation, limits)
        allowed = allowed.near(allowed.channel(self.pose.controls))
        return InverseProblem(self._simulation, terms, allowed, self._options, ready=True)


def _is_reached(problem: InverseProblem, state: InverseState) -> bool:
    return state.error <= problem.reached and state.excess <= EXCESS


_WORTH = 0.5
"""A model is followed where it expects to leave less than this share of the error: a step alone does as well else."""

_MIN_STEP = 1e-4
"""Steps do not become shorter than this share of a range; a target that moves on asks for longer ones again."""


_RULES = StepRules(excess_share=1.0, far=1e-3)
"""When an update takes a step; what exceeds a limit, the next one reduces."""
