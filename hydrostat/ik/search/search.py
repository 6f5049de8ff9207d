"""`Search`: steps of bounded Gauss-Newton towards a pose, with equilibria only as sharp as they must be."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik.limits import Bounds
from hydrostat.ik.objectives.objective import Posture, Rows, Slopes, Term
from hydrostat.ik.search.linear_model import LinearModel, channels, slopes
from hydrostat.mechanics import NewtonResult
from hydrostat.simulation import Simulation, SolvedPose


@dataclass(frozen=True, kw_only=True)
class InverseOptions:
    """How inverse kinematics searches (M7).

    Attributes:
        effort: marker error, as a fraction of the body's size, that the tension at full travel of a winch is worth: a
            small regulariser against cables that pull in vain (E18). It falls with the error, so it hides no target.
        tolerance: error, as a fraction of the body's size, at which a goal counts as reached.
        progress: the search ends where the linearised problem promises to lower the objective by less than this
            fraction.
        iterations: most Gauss-Newton steps.
        largest_step: largest change of a contraction in one step, as a fraction of the winch's whole range.
        unique: where the goals leave a choice, take the contractions that pull least, whatever the start.
        restarts: how often to begin elsewhere while a goal is not reached; none where time matters more.
    """

    effort: float = 1e-3
    tolerance: float = 1e-6
    progress: float = 1e-10
    iterations: int = 100
    largest_step: float = 0.3
    unique: bool = True
    restarts: int = 3


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """Where a search is.

    Attributes:
        values: contraction of each channel [m].
        result: nodes near equilibrium, and the Hessian there.
        posture: where these nodes come to rest, to first order where they do not rest yet.
        residual: of all terms there [m].
        errors: what is left of each goal [m].
        excess: by how much the largest tension exceeds its limit, as a share of it.
        sharp: whether the nodes rest.
    """

    values: Vector
    result: NewtonResult
    posture: Posture
    residual: Rows
    errors: Mapping[str, float]
    excess: float
    sharp: bool

    @property
    def error(self) -> float:
        """The largest error that is left of a goal [m]; infinite without goals."""
        return max(self.errors.values(), default=np.inf)


class Step(NamedTuple):
    """A step, and by how much it should lower the objective [m^2]."""

    values: Vector
    promise: float


class Search:
    """States and steps of one problem: a robot, terms, limits.

    Attributes:
        solves: equilibria approached so far.
        reached: error [m] at which a goal counts as reached.
    """

    def __init__(
        self,
        simulation: Simulation,
        terms: Sequence[Term],
        bounds: Bounds,
        options: InverseOptions,
        *,
        ready: bool = False,
    ) -> None:
        """What is sought.

        Args:
            simulation: the robot's physics.
            terms: what should become small.
            bounds: what the channels may do.
            options: tolerances and limits of the search.
            ready: keep slack cables just short of taut, so that they can join at once.

        Raises:
            InputError: a robot without cables, or one whose cables have friction.
        """
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
        self.simulation, self.terms, self.bounds, self.options = simulation, tuple(terms), bounds, options
        size = robot.body.mesh.size
        self.reached = options.tolerance * size
        self._worth = size / _full_tensions(simulation)
        self._size = size
        self._ready = ready
        self.solves = 0

    def begin(self, start: SolvedPose | None) -> State:
        """The state of a pose, of rest if it is left out, within the limits.

        Raises:
            NotConvergedError: no equilibrium is found there.
        """
        pose = start or self.simulation.rest
        values = self.bounds.channel(pose.contractions)
        if (self.bounds.spread @ values == pose.contractions).all() and _sound(pose.result):
            return self._state(values, self._result(pose))
        found = self._relaxed(values, self._result(pose))
        if found is not None:
            return found
        solved = self.simulation.solve(self.bounds.spread @ values, start=pose, strict=False)
        if not _sound(solved.result):
            raise NotConvergedError(
                f"inverse kinematics finds no stable equilibrium to begin from: {solved.result.reason}; give a start",
                solved.result,
            )
        return self._state(values, self._result(solved))

    def step(self, state: State, weight: float, radius: float) -> Step:
        """Where to go from a state: contractions of the channels [m], and what that promises."""
        model = self._model(state)
        step, promise = model.best(weight * self._worth, radius)
        return Step(model.applied(step), promise)

    def slope(self, state: State, weight: float) -> float:
        """The steepest fall of the residual's length along a channel that may go that way [m/m]."""
        return self._model(state).slope(weight * self._worth)

    def redundant(self, state: State) -> bool:
        """Whether some change of the contractions moves nothing that counts."""
        model = self._model(state)
        moves = (model.matrix * model.range)[:, model.active]
        if not moves.size:
            return False
        values = np.linalg.svd(moves, compute_uv=False)
        return moves.shape[0] < moves.shape[1] or bool(values[-1] < _IDLE * values[0])

    def slopes(self, state: State) -> Slopes:
        """D residual / d contractions of the channels; slack ones as if they had just become taut."""
        return self._model(state).matrix

    def jump(self, values: Vector) -> State | None:
        """The state to which contractions of the channels [m] lead at once from rest; None if that is none."""
        self.solves += 1
        return self._relaxed(values, self._result(self.simulation.rest))

    def approach(self, state: State, values: Vector) -> State | None:
        """The state at other contractions, near enough to equilibrium to go on; None if no stable one is found."""
        self.solves += 1
        contractions = self.bounds.spread @ values
        result = state.result
        far = (np.abs(values - state.values) > _FAR * self.bounds.span).any()
        for _ in range(_RELAXATIONS):
            before = result.nodes
            iterations, tolerance = (_ITERATIONS, _LOOSE) if far else (1, None)
            result = self.simulation.relax(
                before, contractions, result.stiffness, iterations=iterations, tolerance=tolerance
            )
            if not result.stable:
                return None if far else self._relaxed(values, state.result)
            found = self._state(values, result)
            left = np.abs(found.posture.nodes - result.nodes).max()
            if found.sharp or left <= _LEFT * np.abs(result.nodes - before).max():
                return self._idle(found)
            far = False
        return self._relaxed(values, state.result)

    def follow(self, state: State, values: Vector) -> State | None:
        """The state at other contractions, at equilibrium; None if Newton alone does not find it."""
        self.solves += 1
        return self._relaxed(values, state.result)

    def renewed(self, state: State) -> State:
        """A state of another search of the same robot, in the eyes of this one."""
        return self._state(state.values, state.result)

    def sharpened(self, state: State) -> State | None:
        """The same contractions at equilibrium."""
        if state.sharp:
            return state
        self.solves += 1
        contractions = self.bounds.spread @ state.values
        result = self.simulation.relax(state.result.nodes, contractions, state.result.stiffness, exact=True)
        return self._state(state.values, result) if _sound(result) else None

    def objective(self, state: State, weight: float) -> float:
        """Half the squares of residual and effort [m^2]."""
        effort = weight * self._worth * state.posture.tensions
        return 0.5 * float(state.residual @ state.residual + effort @ effort)

    def weight(self, state: State) -> float:
        """Of the effort: a share of the error, for then it fades as fast as the search converges."""
        error = float(np.sqrt(state.residual @ state.residual)) / self._size
        return min(self.options.effort, max(_SHARE * error, _LEAST_WEIGHT))

    def _result(self, pose: SolvedPose) -> NewtonResult:
        return replace(pose.result, stiffness=self.simulation.stiffness(pose))

    def _model(self, state: State) -> LinearModel:
        assert state.result.stiffness is not None
        places = channels(self.simulation.cables.law, state.posture, state.values, self.bounds)
        taut = places.first[places.active]
        moves = slopes(self.simulation, state.posture, state.result.stiffness, taut)
        rows = [np.zeros((0, len(self.bounds.channels))), *(term.slopes(state.posture, moves) for term in self.terms)]
        matrix = np.vstack(rows) @ self.bounds.spread
        tensions = moves.tensions @ self.bounds.spread
        return LinearModel(state.posture, state.residual, matrix, tensions, places, self.bounds, state.values)

    def _relaxed(self, values: Vector, start: NewtonResult) -> State | None:
        """By Newton alone, to the end: what takes longer is better reached in smaller steps."""
        result = self.simulation.relax(
            start.nodes, self.bounds.spread @ values, start.stiffness, iterations=_ITERATIONS
        )
        return self._idle(self._state(values, result)) if _sound(result) else None

    def _state(self, values: Vector, result: NewtonResult) -> State:
        """What the terms see, where the nodes come to rest to first order."""
        contractions = self.bounds.spread @ values
        sharp = result.residual <= self.simulation.allowed(result.nodes, contractions)
        posture = self._posture(result.nodes if sharp else self._resting(result, contractions), contractions)
        errors: dict[str, float] = {}
        for term in self.terms:
            errors.update(term.errors(posture))
        limited = np.isfinite(self.bounds.tension)
        excess = posture.tensions[limited] / self.bounds.tension[limited] - 1.0
        return State(
            values=values,
            result=result,
            posture=posture,
            residual=np.concatenate([np.zeros(0), *(term.residual(posture) for term in self.terms)]),
            errors=errors,
            excess=max(float(excess.max(initial=0.0)), 0.0),
            sharp=sharp,
        )

    def _resting(self, result: NewtonResult, contractions: Vector) -> Nodes:
        """Where the nodes would come to rest, were the forces linear."""
        if result.stiffness is None or result.stiffness.singular:
            return result.nodes
        gradient = self.simulation.assembly.gradient(result.nodes, contractions)
        return result.nodes - result.stiffness.solve(gradient).reshape(result.nodes.shape)

    def _posture(self, nodes: Nodes, contractions: Vector) -> Posture:
        cables = self.simulation.cables
        stretches = cables.stretches(nodes, contractions)
        return Posture(
            nodes=nodes, contractions=contractions, stretches=stretches, tensions=cables.law.tension(stretches)
        )

    def _idle(self, state: State) -> State:
        """Slack channels go towards rest, or to the edge of taut, as far as they stay slack: nothing moves by that."""
        gaps = channels(self.simulation.cables.law, state.posture, state.values, self.bounds).gaps
        slack = (gaps > 0) & np.isfinite(gaps)
        edge = state.values + np.where(slack, gaps, 0.0)
        wanted = np.clip(edge if self._ready else np.minimum(edge, 0.0), self.bounds.low, self.bounds.high)
        values = np.where(slack, np.minimum(wanted, edge), state.values)
        return state if (values == state.values).all() else self._state(values, state.result)


_RELAXATIONS = 6
"""Steps of Newton towards an equilibrium before stronger means are used."""

_ITERATIONS = 30
"""Steps of Newton before an equilibrium is given up."""

_FAR = 0.02
"""A step of more than this share of a channel's range is far: it takes more than one step of Newton."""

_LOOSE = 0.1
"""Force left over after these, as a share of the largest tension."""

_LEFT = 0.2
"""An equilibrium is near enough when what is left is this share of the last step of Newton."""

_IDLE = 1e-3
"""A change that moves less than this share of what the best one moves counts as none."""

_SHARE = 0.1
"""Weight of the effort, as a share of the error in sizes of the body."""

_LEAST_WEIGHT = 1e-8
"""Of the effort; enough to keep the linearised problem well posed."""


def _full_tensions(simulation: Simulation) -> Vector:
    """What each cable would pull at the full travel of its winch, were the body linear [N]."""
    robot, cables = simulation.robot, simulation.cables
    travel = np.array([winch.travel for winch in robot.winches])[cables.winches]
    compliance = simulation.stiffness(simulation.rest).compliance.diagonal()
    return travel / (1.0 / cables.law.stiffness + compliance)


def _sound(result: NewtonResult) -> bool:
    """Whether it is a stable equilibrium."""
    return result.converged and result.stable
