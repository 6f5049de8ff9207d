"""`Tracker`: contractions for targets that move, fit to be streamed."""

from collections.abc import Sequence
from dataclasses import replace

from hydrostat.errors import InputError
from hydrostat.ik.limits import Limits, bounds
from hydrostat.ik.objectives.objective import Objective
from hydrostat.ik.reached_pose import InverseReason, ReachedPose
from hydrostat.ik.search.inverse_search import EXCESS, Descent, InverseSearch, StepRules, ends, reached_pose, try_step
from hydrostat.ik.search.problem import InverseOptions, InverseProblem, InverseState
from hydrostat.ik.solve_ik import Targets, as_pose, wishes
from hydrostat.robot import Pose
from hydrostat.simulation import Simulation, SolvedPose


class Tracker:
    """Any-time inverse kinematics: each update is one trust-region step nearer, and a pose of its own (R34).

    Every pose is a stable equilibrium within all limits, so its contractions can be sent to motors at once; with an
    accuracy its nodes may be so far from it [m]. Slack cables are kept just short of taut, so that they can join
    without a delay. Where cables rub, each update goes straight on from the pose before: its poses are those of a robot
    to which they are sent one after the other.

        tracker = hs.Tracker(simulation, limits=hs.Limits(rate=0.1))
        while True:
            reached = tracker.update({"tip": (0.1, 0.02)}, seconds=1 / 30)

    Attributes:
        pose: where the robot is.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        limits: Limits | None = None,
        objectives: Sequence[Objective] = (),
        start: SolvedPose | None = None,
        options: InverseOptions | None = None,
        accuracy: float | None = None,
    ) -> None:
        """Begin at `start`, the rest pose if left out; the other arguments are as for `solve_ik`.

        With an accuracy nodes may be so far from equilibrium [m], as in `Simulation.solve`.
        """
        self._simulation, self._objectives = simulation, tuple(objectives)
        self._limits, self._options = limits or Limits(), options or InverseOptions()
        self._radius, self._accuracy = self._options.largest_step, accuracy
        self._state = None
        self.pose = start or simulation.rest

    def update(
        self, targets: Targets | None = None, *, seconds: float, objectives: Sequence[Objective] = ()
    ) -> ReachedPose:
        """One step towards where the targets are now.

        Args:
            targets: where markers should go [m].
            seconds: since the last update; what a limit on the rate allows follows from it.
            objectives: what is wished for just now, beside what was given at the start.

        Raises:
            InputError: as for `solve_ik`, or seconds not above 0.
            NotConvergedError: no equilibrium where it begins.
        """
        if not seconds > 0:
            raise InputError(f"seconds since the last update must be above 0, not {seconds:g}")
        target = as_pose(targets)
        search = self._search(target, seconds, objectives)
        state = search.begin(self.pose) if self._state is None else search.renewed(self._state)
        weight, reason = search.problem.weight(state), InverseReason.REACHED
        if not _reached(search.problem, state):
            state, reason = self._step(search, state, weight)
        self._state = state
        if _reached(search.problem, state):
            reason = InverseReason.REACHED
        elif state.excess > _RULES.far:
            reason = InverseReason.TOO_TIGHT
        found = Descent(state=state, reason=reason, iterations=1, weight=weight)
        reached = reached_pose(search, found, target)
        self.pose = reached.pose
        return reached

    def _step(self, search: InverseSearch, state: InverseState, weight: float) -> tuple[InverseState, InverseReason]:
        """The state after the first step that is accepted, and what to say of it."""
        problem, largest = search.problem, self._options.largest_step
        least = self._options.progress * problem.objective(state, weight)
        first, found = self._radius, False
        for _ in range(_TRIES):
            step = problem.step(state, weight, self._radius)
            if ends(problem, state, step, least, first):
                self._radius = largest
                return state, InverseReason.OPTIMAL
            tried = try_step(problem, state, step, weight, search.follow, _RULES)
            if tried.accepted and tried.trial is not None:
                self._radius = min(2.0 * self._radius, largest)
                return tried.trial, InverseReason.ITERATION_LIMIT
            found = found or tried.trial is not None
            self._radius = max(0.25 * self._radius, _SMALLEST)
        return state, InverseReason.STUCK if found else InverseReason.NO_EQUILIBRIUM

    def _search(self, target: Pose | None, seconds: float, objectives: Sequence[Objective]) -> InverseSearch:
        limits = self._limits if self._limits.rate is None else replace(self._limits, interval=seconds)
        allowed = bounds(self._simulation, limits)
        allowed = allowed.near(allowed.channel(self.pose.contractions))
        terms = [wish.on(self._simulation) for wish in wishes(target, [*self._objectives, *objectives])]
        return InverseSearch(
            InverseProblem(self._simulation, terms, allowed, self._options, ready=True),
            accuracy=self._accuracy,
            origin=self.pose,
        )


def _reached(problem: InverseProblem, state: InverseState) -> bool:
    return state.error <= problem.reached and state.excess <= EXCESS


_SMALLEST = 1e-4
"""Steps do not become shorter than this share of a range; a target that moves on asks for longer ones again."""

_TRIES = 3
"""Steps tried in one update before the robot stays where it is."""

_RULES = StepRules(mends=1.0, far=1e-3)
"""When an update takes a step; what exceeds a limit, the next one mends."""
