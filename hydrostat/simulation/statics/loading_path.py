"""`LoadingPath`: incremental loading, where the loading path decides the final pose."""

from copy import copy
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics import Assembly, FactorizedHessian, NewtonResult, NewtonStatus
from hydrostat.robot import Robot
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.statics.history_equilibrium import find_history_equilibrium
from hydrostat.simulation.statics.static_solver import StaticSolver


@dataclass(frozen=True, eq=False)
class _PathState:
    """Equilibrium on the loading path; the energies hold the history up to it."""

    nodes: Nodes
    contractions: Vector
    assembly: Assembly
    result: NewtonResult | None = None
    known: FactorizedHessian | None = None

    @property
    def reaches_goal(self) -> bool:
        return self.result is not None and self.result.converged


class LoadingPath:
    """Incremental loading: follows contractions from pose to pose, as energies with a history ask for (E14).

    Contractions go straight from where they are to where they shall be, in even increments that take in or let out at
    most a small part of a cable. In each the energy is minimized while what depends on the path, such as the limits of
    friction, is held fixed; this is corrected until it is in balance with the shape that is found.
    """

    def __init__(self, robot: Robot, solver: StaticSolver, begin: Nodes) -> None:
        """Physics of a robot, and its unknowns at rest [m]."""
        self._rest = _PathState(begin, np.zeros(robot.num_controls), solver.assembly)
        self._solver = solver
        wholes = [
            (cable.winch, cable.length / abs(ratio))
            for cable, ratio in zip(robot.cables, robot.spool_ratios, strict=True)
        ]
        lengths = [
            min((whole for own, whole in wholes if own == winch.name), default=np.inf) for winch in robot.winches
        ]
        steps = [_TURN if drive.turns else _INCREMENT * robot.body.mesh.size for drive in robot.drives]
        self._increment = np.append(_INCREMENT * np.array(lengths), steps)

    def with_timeout(self, seconds: float | None) -> "LoadingPath":
        """Return the same path with a timeout counted from now [s]; itself if that is None."""
        return self if seconds is None else self._by(self._solver.with_timeout(seconds))

    def until(self, deadline: float) -> "LoadingPath":
        """Return the same path with a deadline on the clock of `time.monotonic` [s]."""
        return self._by(self._solver.with_deadline(deadline))

    def _by(self, solver: StaticSolver) -> "LoadingPath":
        other = copy(self)
        other._solver = solver
        return other

    def solve(
        self, goal: Vector, start: Equilibrium | None, known: FactorizedHessian | None = None
    ) -> tuple[NewtonResult, Vector]:
        """Equilibrium at contractions `goal` [m], on the path from `start` or from rest, and its history variables.

        `known` is the Hessian at the start, if it is at hand. If the way cannot be followed to its end, the result is
        where it broke off, and has not converged.
        """
        state = replace(self._rest, known=known)
        if start is not None:
            state = _PathState(start.unknowns, start.controls, self.with_history(start), known=known)
        begin = state.contractions
        steps = max(1, ceil(float((np.abs(goal - begin) / self._increment).max(initial=0.0)) - 1e-9))
        iterations = 0
        for step in range(1, steps + 1):
            state = self._advance(state, goal if step == steps else begin + (goal - begin) * (step / steps))
            assert state.result is not None
            iterations += state.result.iterations
            if not state.reaches_goal:
                break
        assert state.result is not None
        return replace(state.result, iterations=iterations), state.assembly.history

    def at_once(self, goal: Vector, start: Equilibrium | None, near: NewtonResult) -> tuple[NewtonResult, Vector]:
        """Return the same path in a single increment, solved from a state near its end."""
        assembly = self._rest.assembly if start is None else self.with_history(start)
        assembly = assembly.with_active_terms(near.nodes)
        guesses = 5  # Corrections of a first guess, while nothing moves
        for _ in range(guesses):  # balance there: a better guess than none of what friction holds
            assembly = assembly.with_corrected_history(near.nodes, goal, None)
        state = self._solve(_PathState(near.nodes, goal, assembly, near), goal)
        assert state.result is not None
        return state.result, state.assembly.history

    def with_history(self, pose: Equilibrium) -> Assembly:
        """Return the physics with the history of a pose."""
        return self._rest.assembly.with_active_terms(pose.unknowns).with_history(
            pose.history, pose.unknowns, pose.controls
        )

    def _advance(self, state: _PathState, goal: Vector, halvings: int = 0) -> _PathState:
        """Next equilibrium: by half increments where it is not found, and by sliding where these fail too."""
        found = self._solve(state, goal)
        if found.reaches_goal or _late(found) or (goal == state.contractions).all():
            return found
        if halvings:
            slid = self._slide(state, goal)
            if slid.reaches_goal or _late(slid) or halvings == _HALVINGS:
                return slid
        middle = self._advance(state, 0.5 * (state.contractions + goal), halvings + 1)
        return self._advance(middle, goal, halvings + 1) if middle.reaches_goal else found

    def _slide(self, state: _PathState, goal: Vector) -> _PathState:
        """Next equilibrium after a snap-through: friction follows behind it, and slipped points stick.

        Cable slips against the limits of where it was, a little too far. This is repeated until balance is near.
        """
        found, iterations = state, 0
        for slides in _SLIDES:
            for _ in range(slides):
                result = self._relax(state.assembly, state.nodes, goal, _stiffness(state))
                iterations += result.iterations
                assembly = state.assembly.with_active_terms(result.nodes)
                state = _PathState(result.nodes, goal, assembly.with_advanced_history(result.nodes, goal), result)
                if not result.converged:
                    return _with_count(state, iterations)
            found = self._solve(state, goal)
            assert found.result is not None
            iterations += found.result.iterations
            if found.reaches_goal:
                break
        return _with_count(found, iterations)

    def _solve(self, state: _PathState, goal: Vector) -> _PathState:
        """Equilibrium at `goal` after one increment, consistent with the path-dependent quantities."""

        def relax(assembly: Assembly, nodes: Nodes, known: FactorizedHessian | None, tolerance: float) -> NewtonResult:
            return self._relax(assembly, nodes, goal, known, tolerance)

        start = state.nodes, _stiffness(state)
        assembly, result = find_history_equilibrium(state.assembly, start, goal, relax, self._solver.round_off.force)
        after = assembly.with_advanced_history(result.nodes, goal)
        return _PathState(result.nodes, goal, after, replace(result, energy=after.value(result.nodes, goal)))

    def _relax(
        self, assembly: Assembly, nodes: Nodes, goal: Vector, known: FactorizedHessian | None, tolerance: float = 0.0
    ) -> NewtonResult:
        return replace(self._solver, assembly=assembly).relax(
            nodes, goal, known, tolerance=tolerance, rough=tolerance > 0
        )


def _late(state: _PathState) -> bool:
    return state.result is not None and state.result.status is NewtonStatus.TIME_LIMIT


def _stiffness(state: _PathState) -> FactorizedHessian | None:
    return state.known if state.result is None else state.result.stiffness


def _with_count(state: _PathState, iterations: int) -> _PathState:
    """State with another count of iterations."""
    assert state.result is not None
    return replace(state, result=replace(state.result, iterations=iterations))


_INCREMENT = 0.05
_TURN = 0.1  # Largest increment of an angle [rad]
"""Largest increment of a contraction, as a share of that which would take in a whole cable of the winch."""


_HALVINGS = 4
"""So often at most is an increment halved."""

_SLIDES = (2, 4, 8, 16)
"""So often cable slides before each trial of balance, where a body snaps."""
