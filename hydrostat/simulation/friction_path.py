"""`FrictionPath`: equilibria of a robot whose cables rub, one after the other along the way there."""

from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import NotConvergedError
from hydrostat.mechanics import Assembly, FrictionCableEnergy, NewtonOptions, NewtonResult, Reason, RoundOff, minimise
from hydrostat.mechanics.stiffness import Stiffness
from hydrostat.mechanics.warp import Warp
from hydrostat.robot import Robot
from hydrostat.simulation.solved_pose import SolvedPose

_INCREMENT = 0.05
"""Largest increment of a contraction, as a share of that which would take in a whole cable of the winch."""

_HALVINGS = 4
"""So often is an increment halved that finds no equilibrium."""

_TOLERANCE = 1e-8
"""Limits that obey the capstan law to this share of the largest tension are right."""

_CORRECTIONS = 40
_NEWTON = 12
"""Most corrections of the limits in one increment, and how many of these by Newton's method."""


@dataclass(frozen=True, eq=False)
class _State:
    """An equilibrium on the way; `cables` hold what has slipped until there."""

    nodes: Nodes
    contractions: Vector
    cables: FrictionCableEnergy
    result: NewtonResult | None = None

    @property
    def arrived(self) -> bool:
        return self.result is not None and self.result.converged


class FrictionPath:
    """Follows the contractions from pose to pose, for with friction the way decides where the robot ends (E14).

    Contractions go straight from where they are to where they shall be, in even increments that take in or let out at
    most a small part of a cable. In each the energy is minimised at given limits of friction, and these are corrected
    until they obey the capstan law in the shape that is found.
    """

    def __init__(
        self,
        robot: Robot,
        assembly: Assembly,
        cables: FrictionCableEnergy,
        *,
        options: NewtonOptions,
        round_off: RoundOff,
        warp: Warp | None,
    ) -> None:
        """The physics of a robot at rest; `cables` is one of the energies of `assembly`."""
        self._rest = _State(robot.body.mesh.nodes, np.zeros(len(robot.winches)), cables)
        self._assembly, self._options, self._round_off, self._warp = assembly, options, round_off, warp
        wholes = [
            (cable.winch, cable.length / ratio) for cable, ratio in zip(robot.cables, robot.spool_ratios, strict=True)
        ]
        lengths = [
            min((whole for own, whole in wholes if own == winch.name), default=np.inf) for winch in robot.winches
        ]
        self._increment = _INCREMENT * np.array(lengths)

    def solve(self, goal: Vector, start: SolvedPose | None) -> tuple[NewtonResult, Vector]:
        """Equilibrium at contractions `goal` [m], on the way from `start` or from rest; and what has slipped.

        If the way cannot be followed to its end, the result is where it broke off, and has not converged.
        """
        state = self._rest if start is None else self._resumed(start)
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
        return replace(state.result, iterations=iterations), state.cables.slips

    def moves(self, pose: SolvedPose) -> Float[np.ndarray, "dofs winches"]:
        """D nodes / d contractions if these go on so that cable slips where it is about to.

        Raises:
            NotConvergedError: the Hessian of the body is singular.
        """
        cables = self._resumed(pose).cables
        stiffness = self._with(cables).stiffness(pose.nodes, pose.contractions)
        if stiffness.singular:
            raise NotConvergedError("the pose has no derivative: its Hessian is singular", pose.result)
        return cables.moves(pose.nodes, pose.contractions, stiffness)

    def stiffness(self, pose: SolvedPose) -> Stiffness:
        """The Hessian at a pose while nothing slips, factorised."""
        return self._with(self._resumed(pose).cables).stiffness(pose.nodes, pose.contractions)

    def _resumed(self, pose: SolvedPose) -> _State:
        cables = self._rest.cables.resumed(pose.slips, pose.nodes, pose.contractions)
        return _State(pose.nodes, pose.contractions, cables)

    def _advance(self, state: _State, goal: Vector, halvings: int = _HALVINGS) -> _State:
        """The next equilibrium, by way of more if it is not found."""
        found = self._solve(state, goal)
        if found.arrived or not halvings:
            return found
        middle = self._advance(state, 0.5 * (state.contractions + goal), halvings - 1)
        if not middle.arrived:
            return found
        return self._advance(middle, goal, halvings - 1)

    def _solve(self, state: _State, goal: Vector) -> _State:
        """Equilibrium at `goal` after one increment, with the limits of friction that belong to it."""
        cables, nodes = state.cables, state.nodes
        stiffness = None if state.result is None else state.result.stiffness
        iterations = corrections = 0
        while True:
            result = self._minimise(cables, nodes, goal, stiffness)
            nodes, stiffness, iterations = result.nodes, result.stiffness, iterations + result.iterations
            wanted = cables.capstan_limits(nodes, goal)
            missing = np.abs(wanted - cables.law.limits).max(initial=0.0)
            largest = cables.span_tensions(nodes, goal).max(initial=0.0)
            if missing <= max(_TOLERANCE * largest, self._round_off.force) or not result.converged:
                break
            if corrections == _CORRECTIONS:
                result = replace(result, reason=Reason.NO_BALANCE)
                break
            if corrections < _NEWTON and stiffness is not None and not stiffness.singular:
                wanted = cables.corrected(nodes, goal, stiffness)
            cables, corrections = cables.with_limits(wanted), corrections + 1
        after = cables.after(nodes, goal)
        energy = self._with(after).value(nodes, goal)
        return _State(nodes, goal, after, replace(result, iterations=iterations, energy=energy))

    def _minimise(
        self, cables: FrictionCableEnergy, nodes: Nodes, goal: Vector, stiffness: Stiffness | None
    ) -> NewtonResult:
        return minimise(
            self._with(cables),
            nodes,
            goal,
            force_scale=lambda nodes: float(cables.span_tensions(nodes, goal).max(initial=0.0)),
            round_off=self._round_off,
            options=self._options,
            warp=self._warp,
            stiffness=stiffness,
        )

    def _with(self, cables: FrictionCableEnergy) -> Assembly:
        energies = self._assembly.energies
        return self._assembly.with_energies(
            [cables if isinstance(energy, FrictionCableEnergy) else energy for energy in energies]
        )
