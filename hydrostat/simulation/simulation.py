"""`Simulation`: quasi-static equilibria, sensitivities and motions of one robot."""

# Of the thesis (docs/thesis.md): R17, R23 to R29, E14, R33, E16

from collections.abc import Iterable, Iterator, Sequence
from copy import copy
from functools import cached_property, partial

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.geometry import Anchors, locate
from hydrostat.given import check_kind
from hydrostat.mechanics import Assembly, Energy, FrictionCableEnergy, NewtonOptions, NewtonResult, Stiffness
from hydrostat.robot import Robot
from hydrostat.simulation.adjoint import Sensitivity, cotangents, sensitivity
from hydrostat.simulation.body_physics import BodyPhysics
from hydrostat.simulation.cable_energies import cable_energy, friction_energy
from hydrostat.simulation.dynamics import Dynamics, PinShifts, StepOptions
from hydrostat.simulation.loading_path import LoadingPath
from hydrostat.simulation.many_poses import LONG_ENOUGH, ManyPoses, PoseRow, in_threads, many_poses, pose_row
from hydrostat.simulation.motion import Motion
from hydrostat.simulation.obstacles import not_converged, obstacles
from hydrostat.simulation.profile import Profile, check_profile
from hydrostat.simulation.response import response
from hydrostat.simulation.route_points import RoutePoints, route_points
from hydrostat.simulation.rubbing_slopes import RubbingSlopes, rubbing_sensitivity, rubbing_slopes
from hydrostat.simulation.solved_pose import Contractions, SolvedPose, check_apart, check_pose, contraction_values
from hydrostat.simulation.static_solver import StaticSolver
from hydrostat.simulation.still import check_still


class Simulation:
    """Quasi-static equilibrium of a tendon-driven robot: where it rests when its winches take in cable.

    It is never changed by a solve: threads may share it, and it can be sent to other processes. What is known of a
    pose, its factorised Hessian included, travels with the pose.

    Attributes:
        robot: whose physics it is.
        options: how far Newton goes.
        body: what it shares with all other networks on this body.
        route_points: what holds the points of the cables.
        cables: energy of the cables, as if they had no friction.
        friction: energy of the cables as they rub, in its place; None if none does.
        assembly: the sum of all energies.
        solver: Newton's method on it; `solver.relax` is for those who follow a pose step by step.
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
            options: how far Newton goes.
            body: the physics of its body, if they are at hand; making them anew takes longer than all else here.
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
        more = [self.friction or self.cables, *energies]
        self.assembly: Assembly = self.body.assembly.extended(more, control_count=len(robot.winches))
        self._more = tuple(energies)
        springs = [*(cable.stiffness for cable in robot.cables), *(energy.stiffest for energy in energies)]
        hidden = self.body.round_off(max(springs, default=0.0))
        self.solver = StaticSolver(self.assembly, self.options, hidden, self.body.warp)

    def contractions(self, given: Contractions) -> Vector:
        """Contractions as an array in winch order [m] (InputError: not one number in metres for each winch)."""
        return contraction_values(self.robot, given)

    def solve(
        self,
        contractions: Contractions,
        *,
        start: SolvedPose | None = None,
        strict: bool = True,
        seconds: float | None = None,
        accuracy: float | None = None,
    ) -> SolvedPose:
        """Equilibrium at the given contractions.

        With friction it depends on the way there. This is then followed from `start` in small increments, in which all
        contractions change in proportion.

        Args:
            contractions: cable taken in [m].
            start: a pose to begin from; the rest pose if left out.
            strict: raise when the solver does not converge, rather than return the best pose found.
            seconds: after which it stops, with what it has; no limit if left out.
            accuracy: about how far a node may be from equilibrium [m], for poses that are streamed, 1e-5 for instance;
                what is left is told as `pose.result.error`. Solved to rounding if left out, and always with friction.

        Raises:
            InputError: contractions that do not fit the robot, or a limit or an accuracy that is not above 0.
            NotConvergedError: the solver stopped early; its text says why, and what stands in the way.
        """
        goal = self.contractions(contractions)
        self.check_start(start)
        self.body.check_held(None if start is None else start.unknowns, guided=bool(self._more))
        history, solver = np.zeros(0), self.solver.within(seconds).roughly(accuracy, self.robot.body.mesh.size)
        if self.assembly.has_history:
            result, history = self.path.within(seconds).solve(goal, start)
        else:
            begin = None if start is None else (start.unknowns, start.contractions, self.stiffness_of(start))
            result = solver.solve(goal, (self.body.begin, self.rest_stiffness), begin)
        pose = self.posed(goal, result, history)
        if strict and not result.converged:
            raise not_converged(result, self.in_the_way(pose))
        return pose

    def solve_many(
        self,
        contractions: Sequence[Contractions] | Float[np.ndarray, "poses winches"],
        *,
        jacobians: bool = True,
        nodes: bool = False,
        threads: int = 2,
        start: SolvedPose | None = None,
        seconds: float | None = None,
    ) -> ManyPoses:
        """Equilibria at many contractions, each found by itself: the same bytes for any number of threads.

        A pose that is not found leaves NaN and its reason in its row. Ctrl-C ends it after the poses under way.

        Args:
            contractions: cable taken in [m], (poses, winches), or each as in `solve`.
            jacobians: whether to find slopes of the markers too.
            nodes: whether to keep all nodes.
            threads: that solve at the same time, one for each core; for small bodies, where two are slower, one works.
            start: a pose to begin each from; the rest pose if left out.
            seconds: after which one pose is given up; no limit if left out.

        Raises:
            InputError: as for `solve`; or no number of threads.
        """
        check_kind(contractions, Iterable, "contractions must be a row for each pose")
        given = [self.contractions(each) for each in contractions]
        self.check_start(start)
        self.body.check_held(None if start is None else start.unknowns, guided=bool(self._more))
        goals = np.array(given).reshape(len(given), len(self.robot.winches))
        _ = self.solver.within(seconds), self.rest_stiffness  # checked and made before threads ask for them
        pays = self.assembly.pattern.analysis.tree.seconds >= LONG_ENOUGH
        slopes = self.marker_jacobian if jacobians else None

        def row(number: int) -> PoseRow:
            pose = self.solve(goals[number], start=start, strict=False, seconds=seconds)
            return pose_row(pose, self.marker_anchors, keep=nodes, slopes=slopes, in_the_way=self.in_the_way)

        rows = in_threads(row, len(goals), threads, pays=pays)
        return many_poses(self.robot, goals, rows, jacobians=jacobians, nodes=nodes)

    def in_the_way(self, pose: SolvedPose) -> tuple[str, ...]:
        """Tell what kept a solve from an equilibrium: the cable that pulls hardest, an element next to flat."""
        forces = self.forces(pose.unknowns, pose.contractions).reshape(self.assembly.shape)[: len(pose.nodes)]
        return obstacles(self.robot, self.cables, pose.nodes, pose.contractions, forces)

    def check_start(self, start: SolvedPose | None) -> None:
        """Check that a solve can begin there (InputError: another robot, not finite, no slips, or crossing itself)."""
        if start is not None:
            history = self.assembly.history if self.assembly.has_history else None
            check_pose(start, self.robot.body.mesh.nodes.shape, len(self.robot.winches), history)
            if self.robot.contact and self.stiffness_of(start) is None:
                check_apart(self.robot.body.mesh, start.nodes)

    def jacobian(self, pose: SolvedPose) -> Float[np.ndarray, "nodes dim winches"]:
        """Sensitivities dx/da of the nodes at an equilibrium, by the full Hessian: H dx/da = -d2E/dx da.

        Cables with friction go on slipping where they are at the limit of it, and stick elsewhere.

        Raises:
            InputError: other energies that remember the way, or others beside cables with friction.
            NotConvergedError: the Hessian is singular there: the pose is about to snap.
        """
        check_pose(pose, self.robot.body.mesh.nodes.shape, len(self.robot.winches), what="the pose")
        if not self.assembly.has_history:
            right = -self.assembly.near(pose.unknowns).control_derivative(pose.unknowns, pose.contractions).toarray()
            return self.response(pose, right).reshape(*self.assembly.shape, -1)[: len(pose.nodes)]
        cables, stiffness = self._rubbing(pose)
        compliance = stiffness.compliance_to(cables.span_columns(pose.nodes))
        return cables.moves(pose.nodes, pose.contractions, compliance).reshape(*pose.nodes.shape, -1)

    def marker_jacobian(self, pose: SolvedPose) -> Float[np.ndarray, "markers dim winches"]:
        """Sensitivities of the markers at an equilibrium, in marker order; errors as for `jacobian`."""
        anchors = self.marker_anchors
        return np.einsum("pc,pcdw->pdw", anchors.weights, self.jacobian(pose)[anchors.stencils])

    def adjoint(self, pose: SolvedPose, nodes: Nodes, *, tensions: Vector | None = None) -> Sensitivity:
        """Sensitivities of a number L of an equilibrium to contractions, slack, routes, material, by one solve.

        Cables with friction slip on or stick as for `jacobian`; what has slipped before the pose was begun from stays.

        Args:
            pose: an equilibrium.
            nodes: dL / d nodes at fixed tensions.
            tensions: dL / d tensions; none if left out.

        Raises:
            InputError: other energies that remember the way; cotangents of a wrong shape; obstacles that move.
            NotConvergedError: as for `jacobian`.
        """
        check_still(self.robot, "the adjoint")
        if self.assembly.has_history:
            right, pulls = cotangents(pose, self.assembly.shape, len(self.robot.cables), nodes, tensions)
            slopes = self.rubbing_slopes(pose, (right.reshape(1, -1), pulls[None]))
            return rubbing_sensitivity(self.body, self.route_points, pose, slopes)
        points, respond = self.route_points, partial(self.response, pose)
        given = {"nodes": nodes, "tensions": tensions, "points": points, "response": respond}
        return sensitivity(self.body, self.assembly, self.cables, pose, **given)

    def rubbing_slopes(self, pose: SolvedPose, rows: tuple[np.ndarray, np.ndarray]) -> RubbingSlopes:
        """Slopes of numbers of a pose whose cables rub: `rows` are by its nodes, then by tensions; as for `adjoint`."""
        return rubbing_slopes(self.robot, self.route_points, *self._rubbing(pose), pose, rows)

    def _rubbing(self, pose: SolvedPose) -> tuple[FrictionCableEnergy, Stiffness]:
        if self.friction is None or self._more or any(map(self.robot.friction_of, self.robot.obstacles)):
            raise InputError("physics that remember the way have a derivative only for cables with friction alone")
        return self.friction.resumed(pose.history, pose.nodes, pose.contractions), self._regular(pose)

    def response(
        self, pose: SolvedPose, forces: Float[np.ndarray, "dofs columns"]
    ) -> Float[np.ndarray, "dofs columns"]:
        """How the nodes move under small forces at an equilibrium [m]: H u = f, by the full Hessian.

        Args:
            pose: an equilibrium.
            forces: on every degree of freedom [N], a column for each case.

        Raises:
            InputError: physics that remember the way, such as cables with friction.
            NotConvergedError: the Hessian is singular there: the pose is about to snap.
        """
        if self.assembly.has_history:
            raise InputError("with friction a pose gives way to forces as it goes on or back; ask for its adjoint")
        stiffness = self._regular(pose)
        return response(self.assembly.near(pose.unknowns), stiffness, (pose.unknowns, pose.contractions), forces)

    def still(self, pose: SolvedPose | None = None, *, velocities: Nodes | None = None) -> Motion:
        """A motion that begins in a pose, the rest pose if left out, with all viscous branches settled.

        Args:
            pose: where the nodes are, and the contractions there.
            velocities: of the nodes [m/s]; none if left out.
        """
        self.check_start(pose)
        if pose is None:
            return self.dynamics.still(self.body.begin, self.contractions({}), velocities, None)
        return self.dynamics.still(pose.unknowns, pose.contractions, velocities, pose.history)

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
        check_profile(profile, self.robot)
        return self.dynamics.play(profile, seconds, dt, start or self.still(), options or StepOptions())

    def __repr__(self) -> str:
        return f"<Simulation of {self.robot!r}>"

    @cached_property
    def dynamics(self) -> Dynamics:
        """Steps in time."""
        if any(obstacle.path for obstacle in self.robot.obstacles) and not self.body.guides:
            body = BodyPhysics(self.robot, in_time=True)
            return Simulation(self.robot, options=self.options, body=body, energies=self._more).dynamics
        return Dynamics(self.robot, self.body, self.assembly, self.tensions, self.marker_anchors, self.options)

    @cached_property
    def marker_anchors(self) -> Anchors:
        """What holds the markers."""
        mesh = self.robot.body.mesh
        return locate(mesh, np.array([marker.at for marker in self.robot.markers]).reshape(-1, mesh.dim))

    def tensions(self, nodes: Nodes, contractions: Vector, history: Vector | None = None) -> Vector:
        """Tension of each cable [N]; at its winch if it has friction and remembers its slips in `history` [m]."""
        if self.friction is not None and history is not None:
            slips = self.assembly.part_of(history, self.friction)
            return self.friction.resumed(slips, nodes, contractions).tensions(nodes, contractions)
        return self.cables.tensions(nodes, contractions)

    def stiffness(self, pose: SolvedPose) -> Stiffness:
        """The Hessian at a pose, factorised; after a solve perhaps where its last step began, a hair from there."""
        if self.assembly.has_history:
            return self.path.resumed(pose).stiffness(pose.unknowns, pose.contractions)
        return self.stiffness_of(pose) or self.assembly.near(pose.unknowns).stiffness(pose.unknowns, pose.contractions)

    def _regular(self, pose: SolvedPose) -> Stiffness:
        if (stiffness := self.stiffness(pose)).singular:
            raise NotConvergedError("no derivative: the Hessian is singular, the pose is about to snap", pose.result)
        return stiffness

    def stiffness_of(self, pose: SolvedPose) -> Stiffness | None:
        """The Hessian that a pose of this simulation brings along; None if it brings none, or its nodes were moved."""
        known = pose.result.stiffness
        return known if known is not None and pose.moved_by_none and known.token is self.assembly.token else None

    @cached_property
    def rest(self) -> SolvedPose:
        """The pose without contractions: where gravity leaves the body (NotConvergedError: as for `solve`)."""
        return self.solve(np.zeros(len(self.robot.winches)))

    @cached_property
    def rest_stiffness(self) -> Stiffness:
        """The Hessian at the nodes' rest positions."""
        nodes, idle = self.body.begin, np.zeros(len(self.robot.winches))
        if self._more:
            return self.assembly.near(nodes).stiffness(nodes, idle)
        return Stiffness(self.body.rest_factors, self.assembly.coupling(nodes, idle), token=self.assembly.token)

    def until(self, deadline: float) -> "Simulation":
        """The same physics, all solves of which stop at a time of `time.monotonic` [s]; itself if that is infinite."""
        if np.isinf(deadline):
            return self
        other = copy(self)
        other.solver = self.solver.until(deadline)
        other.__dict__.pop("path", None)
        return other

    @cached_property
    def path(self) -> LoadingPath:
        """Incremental loading; only for energies with a history."""
        return LoadingPath(self.robot, self.solver, self.body.begin)

    def forces(self, nodes: Nodes, contractions: Vector) -> Vector:
        """Residual forces dE/dx [N], (nodes x dim,): what is left over on every degree of freedom, 0 at rest."""
        return self.assembly.near(nodes).gradient(nodes, contractions)

    def posed(self, contractions: Vector, result: NewtonResult, history: Vector | None = None) -> SolvedPose:
        """Pose that Newton found, with all that the robot shows there."""
        positions, count = self.marker_anchors.positions(result.nodes), self.body.count
        return SolvedPose(
            robot=self.robot,
            contractions=contractions,
            nodes=result.nodes if count is None else result.nodes[:count],
            carried=None if count is None else result.nodes[count:],
            markers={marker.name: position for marker, position in zip(self.robot.markers, positions, strict=True)},
            tensions=self.tensions(result.nodes, contractions, history),
            energy=result.energy,
            result=result,
            history=np.zeros(0) if history is None else history,
        )
