"""`solve_ik`: the contractions that bring the markers nearest to a pose."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.geometry.anchors import locate
from hydrostat.ik.reached_pose import InverseReason, ReachedPose
from hydrostat.robot import Point, Pose, Robot
from hydrostat.simulation import Simulation, SolvedPose

Moves = Float[np.ndarray, "nodes dim winches"]


@dataclass(frozen=True, kw_only=True)
class InverseOptions:
    """How inverse kinematics searches (M7).

    Attributes:
        effort: marker error, as a fraction of the body's size, that full travel of one winch is worth: a small
            regulariser that keeps idle winches at rest (E18).
        tolerance: marker error, as a fraction of the body's size, at which a pose counts as reached.
        progress: the search ends where the linearised problem promises to lower the objective by less than this
            fraction.
        iterations: most Gauss-Newton steps.
        first_step: largest change of a contraction in the first step, as a fraction of the winch's whole range.
    """

    effort: float = 1e-3
    tolerance: float = 1e-6
    progress: float = 1e-8
    iterations: int = 60
    first_step: float = 0.3


def solve_ik(
    simulation: Simulation,
    targets: Pose | Mapping[str, Point],
    *,
    start: SolvedPose | None = None,
    options: InverseOptions | None = None,
) -> ReachedPose:
    """Bounded Gauss-Newton on the marker errors, through the sensitivities of the equilibrium (R31 to R33, E18).

    Minimises 1/2 |markers - targets|^2 + 1/2 |effort x contractions|^2 while the contraction of each winch stays
    between -release and travel. A slack cable has no sensitivity: where nothing is left to gain without them, slack
    winches are taken in to the edge of taut and may join (E15). The answer is a local optimum, no worse than rest.

    Args:
        simulation: the robot's physics.
        targets: where markers should go [m].
        start: a pose to begin from; the rest pose if left out, or nearer.
        options: tolerances and limits.

    Raises:
        InputError: a marker that does not exist, a robot without cables, or one whose cables have friction.
    """
    pose = targets if isinstance(targets, Pose) else Pose(name="target", targets=dict(targets))
    return _Search(simulation, pose, options or InverseOptions()).run(start)


class _State:
    """One equilibrium; its derivatives are made when they are first needed."""

    def __init__(self, search: "_Search", pose: SolvedPose) -> None:
        self.search, self.pose = search, pose
        offsets = search.anchors.positions(pose.nodes) - search.goals
        self.errors = np.linalg.norm(offsets, axis=1)
        self.residual = np.concatenate([offsets.ravel(), search.effort * pose.contractions])
        self.objective = float(self.residual @ self.residual) / 2
        self.stretches = search.simulation.cables.stretches(pose.nodes, pose.contractions)

    @cached_property
    def moves(self) -> Moves:
        """D nodes / d contractions."""
        return self.search.simulation.jacobian(self.pose)


@dataclass(frozen=True, eq=False)
class _Model:
    """Where the linearised problem holds, and what it goes by.

    Attributes:
        moves: d nodes / d contractions.
        low: least step [m].
        high: largest step [m].
        beyond_low: what a step that ends at `low` goes further, to be slack indeed [m].
        beyond_zero: what a step above 0 goes further, to be taut first [m].
    """

    moves: Moves
    low: Vector
    high: Vector
    beyond_low: Vector
    beyond_zero: Vector

    def applied(self, step: Vector) -> Vector:
        """The step of the winches that has the effect of a step of the model."""
        let_go = (step < 0) & (step <= (1 - 1e-9) * self.low)
        return step + np.where(let_go, self.beyond_low, 0.0) + np.where(step > 0, self.beyond_zero, 0.0)


class _Search:
    """One run: the problem's constants, and the counts."""

    def __init__(self, simulation: Simulation, target: Pose, options: InverseOptions) -> None:
        robot = simulation.robot
        if not robot.cables:
            raise InputError(
                "the robot has no cables to pull; add winches and cables, or let `hydrostat design` find them"
            )
        if simulation.friction is not None:
            raise InputError(
                "cables with friction end in another pose for every way there, so no contractions belong to a pose; "
                "set friction = 0 to find some, then simulate them with friction"
            )
        self.simulation, self.target, self.options = simulation, target, options
        self.low = np.array([-winch.release for winch in robot.winches])
        self.high = np.array([winch.travel for winch in robot.winches])
        self.anchors = locate(robot.body.mesh, np.array([_marker_place(robot, name) for name in target.targets]))
        for name, goal in target.targets.items():
            if len(goal) != robot.body.mesh.dim:
                raise InputError(
                    f"target {name} has {len(goal)} coordinates, the body {robot.body.mesh.dim} dimensions"
                )
        self.goals = np.array(list(target.targets.values()), dtype=float)
        size = robot.body.mesh.size
        self.reached = options.tolerance * size
        self.effort = options.effort * size / self.high
        self.solves = 0

    def run(self, start: SolvedPose | None) -> ReachedPose:
        """Steps until nothing is left to gain."""
        best, slack = self._begin(start), None
        radius = self.options.first_step
        for iteration in range(self.options.iterations):
            if best.errors.max() <= self.reached:
                return self._done(best, InverseReason.REACHED, iteration)
            # What a model promises is concave in its radius, so a smaller radius must not end the search sooner.
            least = self.options.progress * best.objective * min(radius / self.options.first_step, 1.0)
            model = self._model(best)
            step, promise = self._step(best, model, radius)
            if promise <= least:
                model = slack = slack or self._recruit(best, model)
                step, promise = self._step(best, model, radius)
                if promise <= least:
                    return self._done(best, InverseReason.OPTIMAL, iteration)
            trial = self._solve(best, model.applied(step), model.moves)
            ratio = -np.inf if trial is None else (best.objective - trial.objective) / promise
            radius = _next_radius(radius, ratio, float(np.abs(step / (self.high - self.low)).max()))
            if trial is not None and ratio > 0:
                best, slack = trial, None
            elif radius < _SMALLEST_RADIUS:
                reason = InverseReason.NO_EQUILIBRIUM if trial is None else InverseReason.OPTIMAL
                return self._done(best, reason, iteration + 1)
        return self._done(best, InverseReason.ITERATION_LIMIT, self.options.iterations)

    def _begin(self, start: SolvedPose | None) -> _State:
        """The start within the bounds, or the rest pose where that is no worse."""
        self.solves += 1
        rest = _State(self, self.simulation.solve(np.zeros_like(self.high)))
        if start is None:
            return rest
        goal = np.clip(self.simulation.contractions(start.contractions), self.low, self.high)
        if (goal == start.contractions).all() and _sound(start):
            begun = _State(self, start)
        else:
            self.solves += 1
            solved = self.simulation.solve(goal, start=start, strict=False)
            begun = _State(self, solved) if _sound(solved) else rest
        return begun if begun.objective < rest.objective else rest

    def _solve(self, state: _State, step: Vector, moves: Moves) -> _State | None:
        """The equilibrium one step on, predicted by `moves`; None if no stable one is found.

        Winches that it leaves slack return to rest, as far as they were taken in: nothing moves by that.
        """
        self.solves += 1
        assembly, nodes = self.simulation.assembly, state.pose.nodes
        goal = np.clip(state.pose.contractions + step, self.low, self.high)
        guess = nodes + moves @ step
        if not assembly.value(guess, goal) < assembly.value(nodes, goal):
            guess = nodes
        solved = self.simulation.solve(goal, start=replace(state.pose, nodes=guess, contractions=goal), strict=False)
        if not _sound(solved):
            return None
        cables = self.simulation.cables
        pulled = cables.winches[cables.stretches(solved.nodes, goal) > 0]
        idle = (goal > 0) & ~np.isin(np.arange(len(goal)), pulled)
        return _State(self, replace(solved, contractions=np.where(idle, 0.0, goal)) if idle.any() else solved)

    def _model(self, state: _State) -> _Model:
        """The problem linearised at a state; a cable cannot push, so it holds between slack and taut only.

        A winch lets out until the tension T of its last cable is 0 to first order, by T / T' / rate. To be slack
        indeed it then lets out more: on an elastic body as much as the stretch exceeds T / T', and a little. A slack
        one takes in until its first cable is almost taut.
        """
        let_out, let_go = np.zeros_like(self.low), np.zeros_like(self.low)
        take_in = np.full_like(self.low, np.inf)
        cables, nodes = self.simulation.cables, state.pose.nodes
        tangents, tensions = cables.law.tangent(state.stretches), cables.law.tension(state.stretches)
        moved = state.moves.reshape(nodes.size, -1)[:, cables.winches]
        rates = np.maximum(1.0 + np.einsum("dc,dc->c", cables.columns(nodes), moved), 1e-6)
        for cable, (winch, stretch) in enumerate(zip(cables.winches, state.stretches, strict=True)):
            margin = cables.law.smoothing[cable]
            if tangents[cable] == 0:
                take_in[winch] = min(take_in[winch], max(-stretch - margin, 0.0))
                continue
            until = tensions[cable] / tangents[cable]
            if until / rates[cable] >= let_out[winch]:
                let_out[winch], let_go[winch] = until / rates[cable], stretch - until + margin
        taut = let_out > 0
        return _Model(
            moves=state.moves,
            low=np.where(taut, -let_out, -np.inf),
            high=np.where(taut, np.inf, take_in),
            beyond_low=-let_go,
            beyond_zero=np.zeros_like(let_go),
        )

    def _recruit(self, state: _State, model: _Model) -> _Model:
        """The model with slack winches that may join: as if taken in until the first of their cables pulls a little."""
        gaps = np.zeros_like(self.high)
        cables = self.simulation.cables
        missing = cables.law.smoothing / 2 - state.stretches
        for winch in range(len(gaps)):
            own = missing[cables.winches == winch]
            gaps[winch] = min(max(min(own, default=0.0), 0.0), self.high[winch] - state.pose.contractions[winch])
        joined = gaps > 0
        taut = self._solve(state, gaps, model.moves) if joined.any() else None
        if taut is None:
            return model
        return _Model(
            moves=np.where(joined, taut.moves, model.moves),
            low=np.where(joined, 0.0, model.low),
            high=np.where(joined, np.inf, model.high),
            beyond_low=model.beyond_low,
            beyond_zero=gaps,
        )

    def _step(self, state: _State, model: _Model, radius: float) -> tuple[Vector, float]:
        """Best bounded step of a model, and by how much it promises to lower the objective."""
        from scipy.optimize import lsq_linear

        matrix = self._matrix(model.moves)
        reach = radius * (self.high - self.low)
        low = np.maximum.reduce([self.low - state.pose.contractions, -reach, model.low])
        high = np.minimum.reduce([self.high - state.pose.contractions - model.beyond_zero, reach, model.high])
        free = high > low
        step = np.zeros_like(low)
        if free.any():
            bounds = (low[free], high[free])
            step[free] = lsq_linear(matrix[:, free], -state.residual, bounds, method="bvls").x
        after = state.residual + matrix @ step
        return step, state.objective - float(after @ after) / 2

    def _matrix(self, moves: Moves) -> Float[np.ndarray, "rows winches"]:
        """D residual / d contractions."""
        jacobian = np.einsum("pc,pcdw->pdw", self.anchors.weights, moves[self.anchors.stencils])
        return np.vstack([jacobian.reshape(-1, len(self.high)), np.diag(self.effort)])

    def _done(self, state: _State, reason: InverseReason, iterations: int) -> ReachedPose:
        if state.errors.max() <= self.reached:
            reason = InverseReason.REACHED
        return ReachedPose(
            target=self.target,
            pose=state.pose,
            errors={name: float(error) for name, error in zip(self.target.targets, state.errors, strict=True)},
            reason=reason,
            iterations=iterations,
            solves=self.solves,
            optimality=self._optimality(state),
        )

    def _optimality(self, state: _State) -> float:
        """Largest slope of |residual| along a contraction that may still change that way."""
        length = np.linalg.norm(state.residual)
        if length == 0:
            return 0.0
        slopes = self._matrix(state.moves).T @ state.residual / length
        contractions = state.pose.contractions
        stuck = ((contractions <= self.low) & (slopes > 0)) | ((contractions >= self.high) & (slopes < 0))
        return float(np.abs(slopes[~stuck]).max(initial=0.0))


_SMALLEST_RADIUS = 1e-6
"""Steps of less than this fraction of the range are not worth a solve."""


def _sound(pose: SolvedPose) -> bool:
    """Whether a pose is a stable equilibrium."""
    return pose.result.converged and pose.result.stable


def _next_radius(radius: float, ratio: float, used: float) -> float:
    """Trust radius after a step that gained `ratio` times what it promised and used `used` of the range."""
    if ratio < 0.25:
        return 0.25 * min(radius, used)
    return min(2 * radius, 1.0) if ratio > 0.75 and used > 0.9 * radius else radius


def _marker_place(robot: Robot, name: str) -> Point:
    markers = {marker.name: marker.at for marker in robot.markers}
    if name not in markers:
        known = f"its markers are: {', '.join(markers)}" if markers else "it has no markers"
        raise InputError(f'the robot has no marker "{name}"; {known}')
    return markers[name]
