"""`Simulation`: quasi-static equilibria, sensitivities and motions of one robot."""
# Of the thesis (docs/thesis.md): R17, R23 to R29, E14, R33, E16

from collections.abc import Iterator, Sequence
from copy import copy
from functools import cached_property, partial

import numpy as np

from hydrostat.arrays import Float, Nodes, Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.geometry import Anchors
from hydrostat.mechanics import Assembly, Energy, FactorizedHessian, FrictionCableEnergy, NewtonOptions, NewtonResult
from hydrostat.robot import Robot
from hydrostat.simulation.body_physics import BodyPhysics
from hydrostat.simulation.cable_energies import cable_energy, friction_energy
from hydrostat.simulation.contraction_profile import ContractionProfile, check_profile
from hydrostat.simulation.controls import Contractions, contraction_rows, contraction_values, split_controls
from hydrostat.simulation.drive_energies import drive_energies
from hydrostat.simulation.equilibrium import Equilibrium, check_apart, check_pose, warn_beyond_travel
from hydrostat.simulation.route_points import RoutePoints, hold_markers, route_points
from hydrostat.simulation.sensitivities.adjoint import Sensitivity, cotangents, response, sensitivities
from hydrostat.simulation.sensitivities.friction import FrictionSensitivities, friction_adjoints, friction_sensitivities
from hydrostat.simulation.static_obstacles import require_static_obstacles
from hydrostat.simulation.statics.batch_result import BatchResult, PoseRow, pose_row, solve_rows
from hydrostat.simulation.statics.loading_path import LoadingPath
from hydrostat.simulation.statics.static_solver import StaticSolver, diagnose_failure, not_converged
from hydrostat.simulation.time.dynamics import Dynamics, PinShifts, StepOptions
from hydrostat.simulation.time.motion import Motion


class Simulation:
    """Quasi-static equilibrium of a tendon-driven robot at given contractions of its winches.

    Immutable, thread-safe and picklable: a pose keeps its factorized Hessian.

    Attributes:
        robot: simulated robot.
        options: tolerance and limits of Newton's method.
        body: physics of the body, shared by all cable networks on it.
        route_points: anchors of the cable points.
        cables: energy of the cables without friction.
        friction: energy of the cables with friction, used in place of `cables`; None without friction.
        assembly: sum of all energies.
        solver: Newton's method on `assembly`; `solver.relax` follows a pose step by step.
    """

    def __init__(
        self,
        robot: Robot,
        *,
        options: NewtonOptions | None = None,
        body: BodyPhysics | None = None,
        energies: Sequence[Energy] = (),
    ) -> None:
        """Physics of `robot`.

        Args:
            robot: body and network.
            options: convergence options of Newton's method.
            body: the physics of its body, if they are at hand; making them again takes longer than all else here.
            energies: more physics, such as a magnet or a floor; controls of theirs are the winches' contractions.

        Raises:
            InputError: physics of another body, or a part of the mesh that no pin holds.
        """
        if body is not None:
            body.check(robot)
        self.robot, self.options, self.body = robot, options or NewtonOptions(), body or BodyPhysics(robot)
        self.route_points: RoutePoints = route_points(robot)
        self.cables = cable_energy(robot, self.route_points)
        self.friction = friction_energy(robot, self.route_points)
        more = [self.friction or self.cables, *drive_energies(robot, self.body), *energies]
        self.assembly: Assembly = self.body.assembly.with_added_energies(more, control_count=robot.num_controls)
        self._more = tuple(energies)
        springs = (*(cable.stiffness for cable in robot.cables), *(energy.stiffest for energy in energies), 0.0)
        self.solver = StaticSolver(self.assembly, self.options, self.body.round_off(max(springs)), self.body.warp)

    def as_contractions(self, given: Contractions) -> Vector:
        """Return contractions [m], then drive values [rad or m], as an array (InputError: wrong number of values)."""
        return contraction_values(self.robot, given)

    def solve(
        self,
        contractions: Contractions,
        *,
        start: Equilibrium | None = None,
        strict: bool = True,
        seconds: float | None = None,
        accuracy: float | None = None,
    ) -> Equilibrium:
        """Solve for the equilibrium at given contractions.

        With friction the result depends on the loading path, a straight line from `start`, followed in small steps.

        Args:
            contractions: cable taken in [m], and value of each drive [rad or m]; 0 for those left out.
            start: start pose; the rest pose if left out.
            strict: True to raise an error without convergence, and to warn (`HydrostatWarning`) of contractions beyond
                travel.
            seconds: time limit, after which the solver returns its current state [s]; no limit if left out.
            accuracy: approximate distance of a node from equilibrium [m] for streamed poses, for instance 1e-5; the
                remaining error is `pose.result.error`. None to solve to rounding precision, as always with friction.

        Raises:
            InputError: contractions that do not fit the robot, or a time limit or an accuracy that is not above 0.
            NotConvergedError: the solver stopped early; the message gives the reason and the obstacle.
        """
        goal = self.as_contractions(contractions)
        self.check_start(start)
        self.body.check_held(None if start is None else start.unknowns, guided=bool(self._more))
        solver = self.solver.with_timeout(seconds).with_accuracy(accuracy, self.robot.body.mesh.size)
        known = self.rest_stiffness if start is None else self.stiffness_of(start)
        if self.assembly.has_history:
            result, history = self.path.with_timeout(seconds).solve(goal, start, known)
        else:
            begin = None if start is None else (start.unknowns, start.controls, known)
            result, history = solver.solve(goal, (self.body.rest_unknowns, self.rest_stiffness), begin), np.zeros(0)
        pose = self.make_pose(goal, result, history)
        if strict and not result.converged:
            raise not_converged(result, self.diagnose(pose))
        return warn_beyond_travel(pose) if strict else pose

    def solve_batch(
        self,
        contractions: Sequence[Contractions] | Float[np.ndarray, "poses winches"],
        *,
        jacobians: bool = True,
        nodes: bool = False,
        threads: int = 2,
        start: Equilibrium | None = None,
        seconds: float | None = None,
    ) -> BatchResult:
        """Solve at many contractions, each independently; the bytes are the same for any number of threads.

        A failed pose leaves NaN and the reason in its row. Ctrl-C ends the batch after the poses in progress.

        Args:
            contractions: control values, (poses, controls), or each as in `solve`.
            jacobians: True to compute Jacobians of the markers.
            nodes: True to keep the positions of all nodes.
            threads: maximum number of threads; small bodies use one, because two are slower.
            start: start pose of each solve; the rest pose if left out.
            seconds: time limit for each pose [s]; no limit if left out.

        Raises:
            InputError: as for `solve`, or an invalid number of threads.
        """
        goals = contraction_rows(self.robot, contractions)
        self.check_start(start)
        self.body.check_held(None if start is None else start.unknowns, guided=bool(self._more))
        _ = self.solver.with_timeout(seconds), self.rest_stiffness  # checked and made before threads ask for them
        sensitivities = self.marker_jacobian if jacobians else None

        def row(number: int) -> PoseRow:
            pose = self.solve(goals[number], start=start, strict=False, seconds=seconds)
            return pose_row(pose, self.marker_anchors, keep=nodes, jacobian_of=sensitivities, diagnose=self.diagnose)

        cost = self.assembly.pattern.analysis.tree.seconds
        return solve_rows(self.robot, goals, row, jacobians=jacobians, nodes=nodes, threads=threads, cost=cost)

    def diagnose(self, pose: Equilibrium) -> tuple[str, ...]:
        """Return causes of a failed solve, such as the cable with the highest tension or an almost flat element."""
        forces = self.forces(pose.unknowns, pose.controls).reshape(self.assembly.shape)[: len(pose.nodes)]
        return diagnose_failure(self.robot, self.cables, pose.nodes, pose.contractions, forces)

    def check_start(self, start: Equilibrium | None) -> None:
        """Check that a solve can start from a pose (InputError: another robot, not finite, no slips, or crossing)."""
        if start is not None:
            history = self.assembly.history if self.assembly.has_history else None
            check_pose(start, self.robot.body.mesh.nodes.shape, self.robot.num_controls, history)
            if self.robot.contact and self.stiffness_of(start) is None:
                check_apart(self.robot.body.mesh, start.nodes)

    def jacobian(self, pose: Equilibrium) -> Float[np.ndarray, "nodes dim winches"]:
        """Return sensitivities dx/da of the nodes at an equilibrium, from the full Hessian: H dx/da = -d2E/dx da.

        Cables at the friction limit continue to slip; other cables with friction stick.

        Raises:
            InputError: other path-dependent energies, or other energies together with cable friction.
            NotConvergedError: the Hessian is singular: the pose is at a snap-through.
        """
        check_pose(pose, self.robot.body.mesh.nodes.shape, self.robot.num_controls, what="the pose")
        if self.assembly.follows_tangent:
            right = -self.assembly_at(pose).control_derivative(pose.unknowns, pose.controls).toarray()
            return self.response(pose, right).reshape(*self.assembly.shape, -1)[: len(pose.nodes)]
        cables, stiffness = self._rubbing(pose)
        compliance = stiffness.compliance_to(cables.span_columns(pose.nodes))
        return cables.moves(pose.nodes, pose.controls, compliance).reshape(*pose.nodes.shape, -1)

    def marker_jacobian(self, pose: Equilibrium) -> Float[np.ndarray, "markers dim winches"]:
        """Return sensitivities of the markers at an equilibrium, in marker order; errors as for `jacobian`."""
        anchors = self.marker_anchors
        return np.einsum("pc,pcdw->pdw", anchors.weights, self.jacobian(pose)[anchors.stencils])

    def adjoint(self, pose: Equilibrium, nodes: Nodes, *, tensions: Vector | None = None) -> Sensitivity:
        """Return the gradient of a scalar L to contractions, slack, routes and material, by one adjoint solve.

        Cables with friction slip or stick as for `jacobian`; slip before the start pose stays constant.

        Args:
            pose: equilibrium.
            nodes: dL / d nodes at fixed tensions.
            tensions: dL / d tensions; none if left out.

        Raises:
            InputError: other path-dependent energies, cotangents of a wrong shape, or moving obstacles.
            NotConvergedError: as for `jacobian`.
        """
        require_static_obstacles(self.robot, "the adjoint")
        one, other = cotangents(pose, self.assembly.shape, len(self.robot.cables), nodes, tensions)
        return self.adjoints(pose, (one[None], other[None]))[0]

    def adjoints(self, pose: Equilibrium, rows: tuple[np.ndarray, np.ndarray]) -> list[Sensitivity]:
        """Return the gradient of each row, as by `adjoint`, with one Hessian: `rows` are by nodes, then by tensions."""
        if not self.assembly.follows_tangent:
            found = self.friction_sensitivities(pose, (rows[0].reshape(len(rows[0]), -1), rows[1]))
            return friction_adjoints(self.body, self.route_points, pose, found)
        given = {"points": self.route_points, "response": partial(self.response, pose)}
        return sensitivities(self.body, self.assembly, self.cables, pose, rows=rows, **given)

    def friction_sensitivities(self, pose: Equilibrium, rows: tuple[np.ndarray, np.ndarray]) -> FrictionSensitivities:
        """Return sensitivities of a pose with friction: `rows` are by nodes, then by tensions; as for `adjoint`."""
        return friction_sensitivities(self.robot, self.route_points, *self._rubbing(pose), pose, rows)

    def _rubbing(self, pose: Equilibrium) -> tuple[FrictionCableEnergy, FactorizedHessian]:
        if self.friction is None or self._more or sum(each.has_history for each in self.assembly.energies) > 1:
            raise InputError("derivatives follow the history of cables with friction, and of nothing else beside it")
        return self.friction.with_history(pose.history, pose.nodes, pose.controls), self._regular(pose)

    def response(
        self, pose: Equilibrium, forces: Float[np.ndarray, "dofs columns"]
    ) -> Float[np.ndarray, "dofs columns"]:
        """Return node displacements under small forces at an equilibrium [m]: H u = f, with the full Hessian.

        Args:
            pose: equilibrium.
            forces: force on every degree of freedom [N], one column for each load case.

        Raises:
            InputError: path-dependent physics, such as cables with friction.
            NotConvergedError: the Hessian is singular: the pose is at a snap-through.
        """
        if not self.assembly.follows_tangent:
            raise InputError("with friction a pose gives way to forces as it goes on or back; ask for its adjoint")
        return response(self.assembly_at(pose), self._regular(pose), (pose.unknowns, pose.controls), forces)

    def motion_at_rest(self, pose: Equilibrium | None = None, *, velocities: Nodes | None = None) -> Motion:
        """Return a motion that starts in a pose, by default the rest pose, with relaxed viscous branches.

        Args:
            pose: initial nodes and contractions.
            velocities: node velocities [m/s]; zero by default.
        """
        self.check_start(pose)
        if pose is None:
            return self.dynamics.motion_at_rest(self.body.rest_unknowns, self.as_contractions({}), velocities, None)
        return self.dynamics.motion_at_rest(pose.unknowns, pose.controls, velocities, pose.history)

    def step(
        self,
        motion: Motion,
        contractions: Contractions,
        dt: float,
        *,
        options: StepOptions | None = None,
        pin_shifts: PinShifts | None = None,
    ) -> Motion:
        """Return the motion after `dt` [s], while contractions and pins move evenly to their final values.

        Args:
            motion: state at the start of the step.
            contractions: contractions at the end of the step [m].
            dt: time step [s].
            options: scheme, drag, and number of halvings of a failed step.
            pin_shifts: displacement of pins from their rest positions at the end of the step [m].

        Raises:
            InputError: arguments that do not fit the robot.
            NotConvergedError: even the smallest steps did not converge; the message gives the reason.
        """
        goal = self.as_contractions(contractions)
        return self.dynamics.step(motion, goal, dt, options or StepOptions(), pin_shifts or {})

    def play(
        self,
        profile: ContractionProfile,
        seconds: float,
        dt: float,
        *,
        start: Motion | None = None,
        options: StepOptions | None = None,
    ) -> Iterator[Motion]:
        """Yield the motion under a contraction profile: its start, then each step.

        Args:
            profile: contractions in time; its time is that of the motion.
            seconds: duration [s].
            dt: maximum time step [s]; steps are equal, and the last one ends at the duration.
            start: initial state; at rest by default.
            options: options as for `step`.

        Raises:
            InputError, NotConvergedError: as for `step`.
        """
        check_profile(profile, self.robot)
        return self.dynamics.play(profile, seconds, dt, start or self.motion_at_rest(), options or StepOptions())

    def __repr__(self) -> str:
        return f"<Simulation of {self.robot!r}>"

    @cached_property
    def dynamics(self) -> Dynamics:
        """Time integrator of this simulation."""
        if any(obstacle.path for obstacle in self.robot.obstacles) and not self.body.guides:
            body = BodyPhysics(self.robot, in_time=True)
            return Simulation(self.robot, options=self.options, body=body, energies=self._more).dynamics
        return Dynamics(self.robot, self.body, self.assembly, self.tensions, self.marker_anchors, self.options)

    @cached_property
    def marker_anchors(self) -> Anchors:
        """Nodes and weights that anchor the markers."""
        return hold_markers(self.robot.body.mesh, (marker.at for marker in self.robot.markers))

    def tensions(self, nodes: Nodes, contractions: Vector, history: Vector | None = None) -> Vector:
        """Return the tension of each cable [N]; with friction, at its winch, given its slips in `history` [m]."""
        if self.friction is not None and history is not None:
            slips = self.assembly.part_of(history, self.friction)
            return self.friction.with_history(slips, nodes, contractions).tensions(nodes, contractions)
        return self.cables.tensions(nodes, contractions)

    def stiffness(self, pose: Equilibrium) -> FactorizedHessian:
        """Return the factorized Hessian at a pose; after a solve it may be that of the start of its last step."""
        known = None if self.assembly.has_history else self.stiffness_of(pose)
        return known or self.assembly_at(pose).stiffness(pose.unknowns, pose.controls)

    def _regular(self, pose: Equilibrium) -> FactorizedHessian:
        if (stiffness := self.stiffness(pose)).singular:
            raise NotConvergedError("no derivative: the Hessian is singular, the pose is about to snap", pose.result)
        return stiffness

    def assembly_at(self, pose: Equilibrium) -> Assembly:
        """Return the sum of energies active at a pose; contact is searched for only if the pose keeps no Hessian."""
        if self.assembly.has_history:
            return self.path.with_history(pose)
        known = self.stiffness_of(pose)
        return self.assembly.continuing(None if known is None else known.source).with_active_terms(pose.unknowns)

    def stiffness_of(self, pose: Equilibrium) -> FactorizedHessian | None:
        """Return the Hessian kept with a pose of this simulation; None if it has none, or its nodes were moved."""
        known = pose.result.stiffness
        return known if known is not None and pose.is_unmodified and known.token is self.assembly.token else None

    @cached_property
    def rest(self) -> Equilibrium:
        """Pose without contractions, under gravity (NotConvergedError: as for `solve`)."""
        return self.solve(np.zeros(self.robot.num_controls))

    @cached_property
    def rest_stiffness(self) -> FactorizedHessian:
        """Hessian at the nodes' rest positions."""
        nodes, idle = self.body.rest_unknowns, np.zeros(self.robot.num_controls)
        now = self.assembly.with_active_terms(nodes)
        if self._more:
            return now.stiffness(nodes, idle)
        return FactorizedHessian(self.body.rest_factors, now.low_rank_hessian(nodes, idle), token=now.token, source=now)

    def with_deadline(self, deadline: float) -> "Simulation":
        """Return the same physics with a deadline for solves, on the clock `time.monotonic` [s]; itself if infinite."""
        if np.isinf(deadline):
            return self
        other = copy(self)
        other.solver = self.solver.with_deadline(deadline)
        other.__dict__.pop("path", None)
        return other

    @cached_property
    def path(self) -> LoadingPath:
        """Incremental loading; only for energies with a history."""
        return LoadingPath(self.robot, self.solver, self.body.rest_unknowns)

    def forces(self, nodes: Nodes, contractions: Vector) -> Vector:
        """Return residual forces dE/dx [N], (nodes x dim,), on every degree of freedom; 0 at rest."""
        return self.assembly.with_active_terms(nodes).gradient(nodes, contractions)

    def make_pose(self, contractions: Vector, result: NewtonResult, history: Vector | None = None) -> Equilibrium:
        """Return the pose of a Newton result, with all observable quantities of the robot."""
        positions, count = self.marker_anchors.positions(result.nodes), self.body.node_count
        return Equilibrium(
            robot=self.robot,
            **split_controls(self.robot, contractions),
            nodes=result.nodes if count is None else result.nodes[:count],
            carried=None if count is None else result.nodes[count:],
            markers={marker.name: position for marker, position in zip(self.robot.markers, positions, strict=True)},
            tensions=self.tensions(result.nodes, contractions, history),
            energy=result.energy,
            result=result,
            history=np.zeros(0) if history is None else history,
        )
