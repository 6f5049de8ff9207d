"""`LoadingPath`: incremental loading, where the way to contractions decides where a robot ends."""

from copy import copy
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics import Assembly, NewtonResult, Reason, Stiffness
from hydrostat.robot import Robot
from hydrostat.simulation.balanced import balanced
from hydrostat.simulation.solved_pose import SolvedPose
from hydrostat.simulation.static_solver import StaticSolver


@dataclass(frozen=True, eq=False)
class _PathState:
    """An equilibrium on the way; the energies remember what happened until there."""

    nodes: Nodes
    contractions: Vector
    assembly: Assembly
    result: NewtonResult | None = None

    @property
    def arrived(self) -> bool:
        return self.result is not None and self.result.converged


class LoadingPath:
    """Incremental loading: follows contractions from pose to pose, as energies with a history ask for (E14).

    Contractions go straight from where they are to where they shall be, in even increments that take in or let out at
    most a small part of a cable. In each the energy is minimised while what depends on the path, such as the limits of
    friction, is held fixed; this is corrected until it is in balance with the shape that is found.
    """

    def __init__(self, robot: Robot, solver: StaticSolver, begin: Nodes) -> None:
        """Physics of a robot, and its unknowns at rest [m]."""
        self._rest = _PathState(begin, np.zeros(len(robot.winches)), solver.assembly)
        self._solver = solver
        wholes = [
            (cable.winch, cable.length / ratio) for cable, ratio in zip(robot.cables, robot.spool_ratios, strict=True)
        ]
        lengths = [
            min((whole for own, whole in wholes if own == winch.name), default=np.inf) for winch in robot.winches
        ]
        self._increment = _INCREMENT * np.array(lengths)

    def within(self, seconds: float | None) -> "LoadingPath":
        """The same that stops after so many seconds, counted from now; itself if that is None."""
        return self if seconds is None else self._by(self._solver.within(seconds))

    def until(self, deadline: float) -> "LoadingPath":
        """The same that stops at a time of `time.monotonic` [s]."""
        return self._by(self._solver.until(deadline))

    def _by(self, solver: StaticSolver) -> "LoadingPath":
        other = copy(self)
        other._solver = solver
        return other

    def solve(self, goal: Vector, start: SolvedPose | None) -> tuple[NewtonResult, Vector]:
        """Equilibrium at contractions `goal` [m], on the way from `start` or from rest; and what is remembered there.

        If the way cannot be followed to its end, the result is where it broke off, and has not converged.
        """
        state = self._rest
        if start is not None:
            state = _PathState(start.unknowns, start.contractions, self.resumed(start))
        begin = state.contractions
        steps = max(1, ceil(float((np.abs(goal - begin) / self._increment).max(initial=0.0)) - 1e-9))
        iterations = 0
        for step in range(1, steps + 1):
            state = self._advance(state, goal if step == steps else begin + (goal - begin) * (step / steps))
            assert state.result is not None
            iterations += state.result.iterations
            if not state.arrived:
                break
        assert state.result is not None
        return replace(state.result, iterations=iterations), state.assembly.history

    def at_once(self, goal: Vector, start: SolvedPose | None, near: NewtonResult) -> tuple[NewtonResult, Vector]:
        """The same way in a single increment, found from a state that is near its end.

        It ends where `solve` does as long as cable slips one way only; else it is close.

        Args:
            goal: contractions [m].
            start: where the way begins; at rest if left out.
            near: nodes near the end, and the Hessian there.
        """
        assembly = self._rest.assembly if start is None else self.resumed(start)
        assembly = assembly.near(near.nodes)
        for _ in range(_GUESSES):  # balance there: a better guess than none of what friction holds
            assembly = assembly.corrected(near.nodes, goal, None)
        state = self._solve(_PathState(near.nodes, goal, assembly, near), goal)
        assert state.result is not None
        return state.result, state.assembly.history

    def resumed(self, pose: SolvedPose) -> Assembly:
        """Physics that remember how a pose was reached."""
        return self._rest.assembly.near(pose.unknowns).resumed(pose.history, pose.unknowns, pose.contractions)

    def _advance(self, state: _PathState, goal: Vector, halvings: int = 4) -> _PathState:
        """The next equilibrium, by way of more if it is not found: so often is the increment halved."""
        found = self._solve(state, goal)
        late = found.result is not None and found.result.reason is Reason.TIME_LIMIT
        if found.arrived or late or not halvings or (goal == state.contractions).all():
            return found
        middle = self._advance(state, 0.5 * (state.contractions + goal), halvings - 1)
        if not middle.arrived:
            return found
        return self._advance(middle, goal, halvings - 1)

    def _solve(self, state: _PathState, goal: Vector) -> _PathState:
        """Equilibrium at `goal` after one increment, in balance with what depends on the path."""
        stiffness = None if state.result is None else state.result.stiffness

        def relax(assembly: Assembly, nodes: Nodes, known: Stiffness | None) -> NewtonResult:
            return replace(self._solver, assembly=assembly).relax(nodes, goal, known)

        start = state.nodes, stiffness
        assembly, result = balanced(state.assembly, start, goal, relax, self._solver.round_off.force)
        after = assembly.after(result.nodes, goal)
        return _PathState(result.nodes, goal, after, replace(result, energy=after.value(result.nodes, goal)))


_INCREMENT = 0.05
"""Largest increment of a contraction, as a share of that which would take in a whole cable of the winch."""

_GUESSES = 5
"""Corrections of a first guess, while nothing moves."""
