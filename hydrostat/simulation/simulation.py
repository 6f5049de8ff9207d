"""`Simulation`: the physics of one robot."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property, partial
from math import ceil

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.geometry.anchors import Anchors, locate
from hydrostat.mechanics import Assembly, NewtonOptions, NewtonResult, Reason, Stiffness, WeightEnergy, minimise
from hydrostat.robot import Robot
from hydrostat.simulation.adjoint import Sensitivity, sensitivity
from hydrostat.simulation.build import body_energies, cable_energy, friction_energy, round_off, warp
from hydrostat.simulation.dynamics import Dynamics, PinShifts, StepOptions
from hydrostat.simulation.friction_path import FrictionPath
from hydrostat.simulation.motion import Motion
from hydrostat.simulation.profile import Profile
from hydrostat.simulation.route_points import RoutePoints, route_points
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
        self.cables = cable_energy(robot)
        self.friction = friction_energy(robot)
        body, pins, *rest = body_energies(robot)
        pulls = self.friction or self.cables
        self.assembly = Assembly([body, pins, *rest, pulls], rest=mesh.nodes, control_count=len(robot.winches))
        self.marker_anchors = _markers(robot)
        self._warp = warp(robot, body, pins)
        self._round_off = round_off(robot)
        self._path = None
        if self.friction is not None:
            self._path = FrictionPath(
                robot, self.assembly, self.friction, options=self.options, round_off=self._round_off, warp=self._warp
            )
        self._last: tuple[SolvedPose, Stiffness] | None = None
        self._resting: tuple[SolvedPose, Stiffness] | None = None

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

        With friction it depends on the way there. This is then followed from `start` in small increments, in which all
        contractions change in proportion (E14).

        Args:
            contractions: cable taken in [m].
            start: a pose to begin from; the rest pose if left out.
            strict: raise when the solver does not converge, rather than return the best pose found.

        Raises:
            InputError: contractions that do not fit the robot.
            NotConvergedError: the solver stopped early; its text says why.
        """
        goal = self.contractions(contractions)
        self.check_start(start)
        slips = np.zeros(0)
        if self._path is not None:
            result, slips = self._path.solve(goal, start)
        else:
            result = self._approach(goal, start)
        if strict and not result.converged:
            raise NotConvergedError(
                f"no equilibrium found after {result.iterations} iterations: {result.reason} "
                f"(force left over {result.residual:.2g} N, allowed {result.allowed:.2g} N)",
                result,
            )
        return self.posed(goal, result, slips)

    def check_start(self, start: SolvedPose | None) -> None:
        """Whether a pose can be begun from.

        Raises:
            InputError: it is no pose, one of another robot, not finite, or without slips where cables rub.
        """
        if start is None:
            return
        if not isinstance(start, SolvedPose):
            kind = type(start).__name__
            raise InputError(f"start must be a solved pose, from `simulation.solve` or a result's `.pose`, not {kind}")
        shape = self.robot.body.mesh.nodes.shape
        if not (start.nodes.shape == shape and np.isfinite(start.nodes).all()):
            raise InputError(f"start must be a pose of this robot with finite nodes, {shape}, not {start.nodes.shape}")
        if len(start.contractions) != len(self.robot.winches):
            raise InputError(
                f"start has {len(start.contractions)} contractions, the robot {len(self.robot.winches)} winches"
            )
        if self.friction is not None and not len(start.slips):
            raise InputError("start must be a pose of this robot with friction; it has no slips")

    def jacobian(self, pose: SolvedPose) -> Float[np.ndarray, "nodes dim winches"]:
        """D nodes / d contractions at an equilibrium, by the full Hessian: H dx/da = -d2E/dx da (R33, E16).

        Cables with friction go on slipping where they are at the limit of it, and stick elsewhere.

        Raises:
            NotConvergedError: the Hessian is singular there: the pose is about to snap.
        """
        if self._path is not None:
            return self._path.moves(pose).reshape(*pose.nodes.shape, -1)
        right = -self.assembly.control_derivative(pose.nodes, pose.contractions).toarray()
        return self.response(pose, right).reshape(*pose.nodes.shape, -1)

    def adjoint(self, pose: SolvedPose, nodes: Nodes, *, tensions: Vector | None = None) -> Sensitivity:
        """Slopes of a number L of an equilibrium by contractions, slack, routes and material, with one solve (E16).

        Args:
            pose: an equilibrium.
            nodes: dL / d nodes at fixed tensions.
            tensions: dL / d tensions; none if left out.

        Raises:
            InputError: a cable with friction, whose pose depends on the way there; cotangents of a wrong shape.
            NotConvergedError: as for `jacobian`.
        """
        return sensitivity(
            self.robot,
            self.assembly,
            self.cables,
            pose,
            nodes=nodes,
            tensions=tensions,
            points=self.route_points,
            response=partial(self.response, pose),
        )

    def response(
        self, pose: SolvedPose, forces: Float[np.ndarray, "dofs columns"]
    ) -> Float[np.ndarray, "dofs columns"]:
        """How the nodes move under small forces at an equilibrium [m]: H u = f, by the full Hessian.

        Args:
            pose: an equilibrium.
            forces: on every degree of freedom [N], a column for each case.

        Raises:
            InputError: a cable with friction, whose pose depends on the way there.
            NotConvergedError: the Hessian is singular there: the pose is about to snap.
        """
        if self.friction is not None:
            raise InputError("a pose with friction has no adjoint, as it depends on the way there; set friction = 0")
        stiffness = self.stiffness(pose)
        if stiffness.singular:
            raise NotConvergedError(
                "the pose has no derivative: its Hessian is singular, it is about to snap", pose.result
            )
        body = self.assembly.hessian(pose.nodes, pose.contractions)
        columns, weights = self.assembly.low_rank(pose.nodes, pose.contractions)
        allowed = 1e-11 * np.abs(forces).max(axis=0, initial=0.0)
        rounding = 1e-15 * np.abs(body.data).max(initial=0.0)
        moves = stiffness.solve(forces)
        for _ in range(_REFINEMENTS):  # the factors may be those of a state close by
            missing = forces - body @ moves - columns @ (weights @ (columns.T @ moves))
            hidden = rounding * np.abs(moves).max(axis=0, initial=0.0)
            if (np.abs(missing).max(axis=0, initial=0.0) <= allowed + hidden).all():
                return moves
            moves += stiffness.solve(missing)
        return self.assembly.stiffness(pose.nodes, pose.contractions).solve(forces)

    def still(self, pose: SolvedPose | None = None, *, velocities: Nodes | None = None) -> Motion:
        """A motion that begins in a pose, the rest pose if left out, with all viscous branches settled.

        Args:
            pose: where the nodes are, and the contractions there.
            velocities: of the nodes [m/s]; none if left out.
        """
        if pose is None:
            return self.dynamics.still(self.robot.body.mesh.nodes, self.contractions({}), velocities)
        return self.dynamics.still(pose.nodes, pose.contractions, velocities)

    def step(
        self,
        motion: Motion,
        contractions: Contractions,
        dt: float,
        *,
        options: StepOptions | None = None,
        pin_shifts: PinShifts | None = None,
    ) -> Motion:
        """The motion after `dt` [s], while contractions and pins go evenly to where they shall be.

        Args:
            motion: where it begins.
            contractions: at the end of the step [m].
            dt: length of the step [s].
            options: scheme, drag, and how often a step that fails is cut in two.
            pin_shifts: how far pins are from where they were at rest, at the end of the step [m].

        Raises:
            InputError: arguments that do not fit the robot.
            NotConvergedError: not even the smallest steps converged; its text says why.
        """
        goal = self.contractions(contractions)
        return self.dynamics.step(motion, goal, dt, options or StepOptions(), pin_shifts or {})

    def play(
        self,
        profile: Profile,
        seconds: float,
        dt: float,
        *,
        start: Motion | None = None,
        options: StepOptions | None = None,
    ) -> Iterator[Motion]:
        """The motion under contractions in time: its start, then each step as it is found.

        Args:
            profile: the contractions; its time is that of the motion.
            seconds: how long.
            dt: longest step [s]; the steps are even, and the last ends in time.
            start: where it begins; at rest if left out.
            options: as for `step`.

        Raises:
            InputError, NotConvergedError: as for `step`.
        """
        if not (seconds > 0 and dt > 0):
            raise InputError(f"duration and time step must be above 0 s, not {seconds:g} and {dt:g}")
        motion = start or self.still()
        begin, steps = motion.time, max(1, ceil(seconds / dt - 1e-9))
        yield motion
        for step in range(1, steps + 1):
            goal = profile.at(begin + seconds * step / steps)
            motion = self.step(motion, goal, begin + seconds * step / steps - motion.time, options=options)
            yield motion

    @cached_property
    def dynamics(self) -> Dynamics:
        """Steps in time; their sparse pattern is made here, once.

        Raises:
            InputError: a cable with friction, which has no steps in time yet.
        """
        if self.friction is not None:
            raise InputError("cables with friction cannot move in time yet; set friction = 0, or solve for poses")
        return Dynamics(self.robot, self.assembly, self.cables, self.marker_anchors, self.options)

    def tensions(self, nodes: Nodes, contractions: Vector, slips: Vector | None = None) -> Vector:
        """Tension of each cable [N]; at its winch if it has friction and has slipped by `slips` [m]."""
        if self.friction is not None and slips is not None:
            return self.friction.resumed(slips, nodes, contractions).tensions(nodes, contractions)
        return self.cables.tensions(nodes, contractions)

    def stiffness(self, pose: SolvedPose) -> Stiffness:
        """The Hessian at a pose, factorised; after a solve perhaps where its last step began, a hair from there."""
        if self._path is not None:
            return self._path.stiffness(pose)
        return self._known_stiffness(pose) or self.assembly.stiffness(pose.nodes, pose.contractions)

    @cached_property
    def rest(self) -> SolvedPose:
        """The pose without contractions: where gravity leaves the body.

        Raises:
            NotConvergedError: as for `solve`.
        """
        pose = self.solve(np.zeros(len(self.robot.winches)))
        self._resting = self._last
        return pose

    @cached_property
    def _rest_stiffness(self) -> Stiffness:
        """The Hessian at rest."""
        return self.assembly.stiffness(self.robot.body.mesh.nodes, np.zeros(len(self.robot.winches)))

    @cached_property
    def route_points(self) -> RoutePoints:
        """What holds the points of the cables."""
        return route_points(self.robot)

    def _known_stiffness(self, pose: SolvedPose) -> Stiffness | None:
        """The Hessian at a pose if it is at hand: that of the last one solved, or of the pose at rest."""
        return next((found[1] for found in (self._last, self._resting) if found and found[0] is pose), None)

    def _approach(self, goal: Vector, start: SolvedPose | None) -> NewtonResult:
        """At once; failing that in load steps from `start`, then from rest, and last by patience alone."""
        rest, idle = self.robot.body.mesh.nodes, np.zeros_like(goal)
        begin = start.nodes if start else rest
        known = self._known_stiffness(start) if start else self._rest_stiffness
        direct = result = self.relax(begin, goal, known, iterations=_DIRECT_ITERATIONS)
        spent = result.iterations
        if not result.converged and start and (start.contractions != goal).any():
            result = self._in_steps(begin, start.contractions, goal, known)
            spent += result.iterations
        if not result.converged:
            result = self._in_steps(rest, idle, goal, self._rest_stiffness, from_rest=True)
            spent += result.iterations
        if not result.converged:
            result = self.relax(rest, goal, self._rest_stiffness)
            spent += result.iterations
            result = min(result, direct, key=lambda found: found.residual)
        return replace(result, iterations=spent)

    def _in_steps(
        self, nodes: Nodes, begin: Vector, goal: Vector, stiffness: Stiffness | None, *, from_rest: bool = False
    ) -> NewtonResult:
        """By load steps that are halved where one fails and doubled where not; the last failure if they get too small.

        A step on the way need not end sharp. From rest the weight grows with the contractions.
        """
        done, step, spent = 0.0, _FIRST_STEP, 0
        result, last = None, False
        for _ in range(_MOST_STEPS):
            share = min(done + step, 1.0)
            last = share == 1.0
            iterations, tolerance = (None, None) if last else (_DIRECT_ITERATIONS, _LOOSE)
            controls = goal if last else begin + share * (goal - begin)
            assembly = self._lighter(share) if from_rest else self.assembly
            result = self.relax(
                nodes, controls, stiffness, iterations=iterations, tolerance=tolerance, assembly=assembly
            )
            spent += result.iterations
            if result.converged and not last:
                nodes, stiffness, done, step = result.nodes, result.stiffness, share, 2 * step
                continue
            step *= 0.5
            if result.converged or step < _SMALLEST_STEP:
                break
        assert result is not None
        return replace(result, iterations=spent, reason=result.reason if last else Reason.ITERATION_LIMIT)

    def _lighter(self, share: float) -> Assembly:
        """The physics with a share of the weight."""
        energies = [
            WeightEnergy(self.robot.body.mesh.nodes, share * energy.forces)
            if isinstance(energy, WeightEnergy)
            else energy
            for energy in self.assembly.energies
        ]
        return self.assembly.with_energies(energies)

    def relax(
        self,
        nodes: Nodes,
        contractions: Vector,
        stiffness: Stiffness | None = None,
        *,
        iterations: int | None = None,
        tolerance: float | None = None,
        assembly: Assembly | None = None,
        exact: bool = False,
    ) -> NewtonResult:
        """Newton from some nodes on, for those who follow a pose step by step; `solve` is what others want.

        Args:
            nodes: where to begin [m].
            contractions: cable taken in by each winch [m].
            stiffness: the Hessian near there, such as that of the last result; then the first step is the prediction
                dx/da and costs no factorisation.
            iterations: most steps, if fewer than the simulation's options allow.
            tolerance: if looser than theirs.
            assembly: other physics on the same nodes.
            exact: whether `stiffness` is that of `nodes` to rounding, and not of a place close by.
        """
        options = self.options
        if iterations is not None:
            options = replace(options, iterations=min(iterations, options.iterations))
        if tolerance is not None:
            options = replace(options, tolerance=max(tolerance, options.tolerance))
        return minimise(
            assembly or self.assembly,
            nodes,
            contractions,
            force_scale=lambda nodes: float(self.tensions(nodes, contractions).max(initial=0.0)),
            round_off=self._round_off,
            options=options,
            warp=self._warp,
            stiffness=stiffness,
            exact=exact,
        )

    def allowed(self, nodes: Nodes, contractions: Vector) -> float:
        """Nodal force left over [N] at which nodes count as at rest."""
        largest = float(self.tensions(nodes, contractions).max(initial=0.0))
        return max(self.options.tolerance * largest, self._round_off.force)

    def posed(self, contractions: Vector, result: NewtonResult, slips: Vector | None = None) -> SolvedPose:
        """What Newton found, as a pose."""
        positions = self.marker_anchors.positions(result.nodes)
        pose = SolvedPose(
            contractions=contractions,
            nodes=result.nodes,
            markers={marker.name: position for marker, position in zip(self.robot.markers, positions, strict=True)},
            tensions=self.tensions(result.nodes, contractions, slips),
            energy=result.energy,
            result=replace(result, stiffness=None),
            slips=np.zeros(0) if slips is None else slips,
        )
        self._last = None if result.stiffness is None else (pose, result.stiffness)
        return pose


_REFINEMENTS = 4

_DIRECT_ITERATIONS = 20
"""So many steps of Newton before a command is approached in load steps."""

_FIRST_STEP = 0.25
"""Share of a command that is tried first."""

_LOOSE = 1e-2
"""What may be left over on the way, as a share of the largest applied force."""

_MOST_STEPS = 100
"""Load steps of one solve."""

_SMALLEST_STEP = 2.0**-10
"""No load step is smaller than this share of a command."""


def _markers(robot: Robot) -> Anchors:
    mesh = robot.body.mesh
    points = np.array([marker.at for marker in robot.markers]).reshape(-1, mesh.dim)
    return locate(mesh, points)
