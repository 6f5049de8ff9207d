"""`Simulation`: the physics of one robot."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.geometry.anchors import Anchors, locate
from hydrostat.mechanics import Assembly, Factorisation, NewtonOptions, NewtonResult, minimise
from hydrostat.robot import Robot
from hydrostat.simulation.build import body_energies, cable_energies, round_off
from hydrostat.simulation.solved_pose import SolvedPose

Contractions = Mapping[str, float] | Vector
"""Cable taken in [m]: by the name of a winch (others 0), or an array in winch order."""


class Simulation:
    """Where a robot rests when its winches take in cable (R17, R23 to R29)."""

    def __init__(self, robot: Robot, *, options: NewtonOptions | None = None) -> None:
        """Physics of `robot`; the sparse pattern is made here, once."""
        mesh = robot.body.mesh
        self.robot = robot
        self.options = options or NewtonOptions()
        self.cables = cable_energies(robot)
        self.assembly = Assembly(
            [*body_energies(robot), *self.cables],
            node_count=len(mesh.nodes),
            dim=mesh.dim,
            control_count=len(robot.winches),
        )
        self.marker_anchors = _markers(robot)
        self._round_off = round_off(robot)

    def contractions(self, given: Contractions) -> Vector:
        """Contractions as an array in winch order [m].

        Raises:
            InputError: an unknown winch, a wrong number of values, or a value that is not finite.
        """
        winches = self.robot.winches
        if isinstance(given, Mapping):
            for name in given:
                self.robot.winch(name)
            wanted = [given.get(winch.name, 0.0) for winch in winches]
        else:
            wanted = given
        try:
            values = np.array(wanted, dtype=float)
        except (TypeError, ValueError):
            raise InputError(f"contractions must be numbers [m], not {given!r}") from None
        if values.shape != (len(winches),):
            raise InputError(f"{values.size} contractions given for {len(winches)} winches")
        if not np.isfinite(values).all():
            raise InputError("a contraction is not a finite number")
        return values

    def solve(self, contractions: Contractions, *, start: SolvedPose | None = None, strict: bool = True) -> SolvedPose:
        """Equilibrium at the given contractions.

        Args:
            contractions: cable taken in [m].
            start: a pose to begin from; the rest pose if left out.
            strict: raise when the solver does not converge, rather than return the best pose found.

        Raises:
            InputError: contractions that do not fit the robot.
            NotConvergedError: the solver stopped early; its text says why.
        """
        goal = self.contractions(contractions)
        nodes = self.robot.body.mesh.nodes if start is None else self._predict(start, goal)
        result = self._minimise(nodes, goal)
        if not result.converged:
            result = self._in_steps(goal, result)
        if strict and not result.converged:
            raise NotConvergedError(
                f"no equilibrium found after {result.iterations} iterations: {result.reason} "
                f"(force left over {result.residual:.2g} N, allowed {result.allowed:.2g} N)",
                result,
            )
        return self._solved(goal, result)

    def jacobian(self, pose: SolvedPose) -> Float[np.ndarray, "nodes dim winches"]:
        """D nodes / d contractions at an equilibrium, by the full Hessian: H dx/da = -d2E/dx da (R33, E16).

        Raises:
            NotConvergedError: the Hessian is singular there: the pose is about to snap.
        """
        factor = Factorisation(self.assembly.hessian(pose.nodes, pose.contractions))
        if factor.singular:
            raise NotConvergedError(
                "the pose has no derivative: its Hessian is singular, it is about to snap", pose.result
            )
        right = self.assembly.control_derivative(pose.nodes, pose.contractions).toarray()
        return -factor.solve(right).reshape(*pose.nodes.shape, -1)

    def tensions(self, nodes: Nodes, contractions: Vector) -> Vector:
        """Tension of each cable [N]."""
        return np.array([cable.tension(nodes, contractions) for cable in self.cables])

    def _predict(self, start: SolvedPose, goal: Vector) -> Nodes:
        """First-order guess from a solved pose, where it inverts nothing and lowers the energy."""
        step = goal - start.contractions
        if not step.any():
            return start.nodes
        try:
            guess = start.nodes + self.jacobian(start) @ step
        except NotConvergedError:
            return start.nodes
        better = self.assembly.value(guess, goal) < self.assembly.value(start.nodes, goal)
        return guess if better else start.nodes

    def _in_steps(self, goal: Vector, failed: NewtonResult) -> NewtonResult:
        """From rest by smaller and smaller steps; the first failure if even those do not arrive."""
        iterations = failed.iterations
        for steps in (4, 16):
            nodes, result = self.robot.body.mesh.nodes, failed
            for step in range(1, steps + 1):
                result = self._minimise(nodes, goal * (step / steps))
                nodes = result.nodes
                iterations += result.iterations
            if result.converged:
                return replace(result, iterations=iterations)
        return failed

    def _minimise(self, nodes: Nodes, contractions: Vector) -> NewtonResult:
        return minimise(
            self.assembly,
            nodes,
            contractions,
            force_scale=lambda nodes: float(self.tensions(nodes, contractions).max(initial=0.0)),
            round_off=self._round_off,
            options=self.options,
        )

    def _solved(self, contractions: Vector, result: NewtonResult) -> SolvedPose:
        positions = self.marker_anchors.positions(result.nodes)
        return SolvedPose(
            contractions=contractions,
            nodes=result.nodes,
            markers={marker.name: position for marker, position in zip(self.robot.markers, positions, strict=True)},
            tensions=self.tensions(result.nodes, contractions),
            energy=result.energy,
            result=result,
        )


def _markers(robot: Robot) -> Anchors:
    mesh = robot.body.mesh
    points = np.array([marker.at for marker in robot.markers]).reshape(-1, mesh.dim)
    return locate(mesh, points)
