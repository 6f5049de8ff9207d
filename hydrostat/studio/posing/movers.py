"""`Mover`: contract for moving a body to held points, by muscles or by cables; `Movers` keeps the movers in use."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.design import FreePosing
from hydrostat.errors import HydrostatError, InputError, NotConvergedError
from hydrostat.geometry import locate
from hydrostat.given import Point
from hydrostat.ik import IKOptions, IKStatus, Limits, PointTarget, PoseRegularizer, Targets, Tracker, named_targets
from hydrostat.learning import LearnedModel
from hydrostat.robot import Marker, Robot
from hydrostat.simulation import Equilibrium, Simulation, friction_hysteresis
from hydrostat.studio.document import Document
from hydrostat.studio.posing.pose_state import Anchored, HeldPoint, Mode
from hydrostat.studio.view.contact_items import with_touches
from hydrostat.studio.view.scene_items import Prediction, RobotShape


@dataclass(frozen=True, kw_only=True)
class HeldAnswer:
    """Contractions that networks know, and what they say of the markers that are held."""

    contractions: Vector  # of each winch [m]
    error: float  # mean distance of held markers from their targets that is expected [m]
    uncertainty: float  # mean spread of the networks there [m]
    markers: Mapping[str, Point]  # where they expect each held marker [m]

    def as_prediction(self, *, exact: bool) -> Prediction:
        """Return the prediction to show, next to an answer that is exact or still being solved."""
        return Prediction(markers=self.markers, error=self.error, uncertainty=self.uncertainty, exact=exact)


class Predictor:
    """Answers for held markers, while the others shall stay where they are; it fits `hs.Tracker` as a model."""

    def __init__(self, model: LearnedModel, robot: Robot) -> None:
        """The model of a robot (InputError: it is another's)."""
        model.check(robot)
        self._model = model
        self._places = {marker.name: marker.at for marker in robot.markers}
        self._stay: Mapping[str, Point] = {}
        self._last: tuple[Mapping[str, Point], HeldAnswer] | None = None

    def check(self, robot: Robot) -> None:
        """Check that it is a model of this robot (InputError: it is another's)."""
        self._model.check(robot)

    def knows(self, held: Mapping[str, HeldPoint]) -> bool:
        """True if markers are held, and all of them are markers of the model."""
        return bool(held) and all(self._places.get(name) == point.at for name, point in held.items())

    def stay(self, pose: Equilibrium) -> None:
        """Let markers that are not held stay where they are in a pose."""
        self._stay = {name: tuple(np.asarray(place).tolist()) for name, place in pose.markers.items()}

    def solve(self, targets: Targets) -> HeldAnswer:
        """The answer for targets of held markers [m]; the same targets are asked once."""
        asked = dict(named_targets(targets))
        if self._last is None or self._last[0] != asked:
            found = self._model.solve({**self._stay, **asked})
            answer = HeldAnswer(
                contractions=found.contractions,
                error=float(np.mean([found.errors[name] for name in asked])),
                uncertainty=float(np.mean([found.spread[name] for name in asked])),
                markers={name: tuple(found.markers[name].tolist()) for name in asked},
            )
            self._last = asked, answer
        return self._last[1]


class Mover(ABC):
    """Moves one robot, a step at a time. It works in one thread."""

    robot: Robot  # whose body it moves

    @abstractmethod
    def rest(self) -> RobotShape:
        """Back to rest immediately: nothing pulls."""

    @abstractmethod
    def update(self, held: Mapping[str, HeldPoint]) -> tuple[RobotShape, bool]:
        """One step towards the targets; the shape, and whether there is more to gain."""


FAR_DISTANCE = 0.01  # from this distance on a target counts as out of reach, in sizes of the body
NEAREST = "target not reached: the winches get no closer from here"


class MuscleMover(Mover):
    """Free posing on muscle fibres: no cable pulls (R36 to R38); markers that nobody holds rather stay."""

    def __init__(self, robot: Robot) -> None:
        """Begin at rest; the sparse pattern is made here."""
        self.robot = robot
        self._posing, self._anchored = FreePosing(robot), Anchored(robot.body.mesh)
        self.mark(robot.markers)
        self._held: Mapping[str, HeldPoint] = {}
        self._updates = 0

    def mark(self, markers: Sequence[Marker]) -> None:
        """Take these as the markers that should rather stay while they are not held."""
        mesh = self.robot.body.mesh
        self._markers = markers
        self._calm = locate(mesh, np.array([marker.at for marker in markers], dtype=float).reshape(-1, mesh.dim))

    @property
    def pulls(self) -> tuple[Nodes, Vector]:
        """Positions of the nodes [m], and the tension of the muscle on each edge of the mesh [N]."""
        return self._posing.nodes, self._posing.tensions

    def rest(self) -> RobotShape:
        """Back to rest immediately."""
        self._posing.rest()
        return self._shape({}, False)

    def update(self, held: Mapping[str, HeldPoint]) -> tuple[RobotShape, bool]:
        """One step of the muscles; without targets they let go, a step at a time."""
        if held is not self._held:
            self._held, self._updates = held, 0
        self._updates += 1
        taken = {point.at for point in held.values()}
        calm = self._calm.select_points([index for index, marker in enumerate(self._markers) if marker.at not in taken])
        more = self._posing.update(self._anchored.anchors(held), self._anchored.goals(held), calm)
        max_muscle_updates = 120  # so many updates are made towards targets that stay where they are
        more = more and self._updates < max_muscle_updates
        return self._shape(held, more), more

    def _shape(self, held: Mapping[str, HeldPoint], more: bool) -> RobotShape:
        nodes, robot, tensions = self._posing.nodes, self.robot, self._posing.tensions
        pulls = self._posing.fibres.around_nodes(tensions, len(nodes))
        # a share of their strength with which muscles count as at rest: they are not shown as the strongest
        faint = 1e-3
        most = max(float(pulls.max()), faint * self._posing.strength)
        errors = self._anchored.errors(held, nodes)
        far = not more and max(errors.values(), default=0.0) > FAR_DISTANCE * robot.body.mesh.size
        return RobotShape(
            nodes=nodes,
            tensions=np.zeros(len(robot.cables)),
            contractions=np.zeros(len(robot.winches)),
            errors=errors,
            muscles=pulls / most,
            notes=("muscle limit: target not reached",) if far else (),
        )


CALM, CALMEST = 4.0, 0.3
"""Weights that keep free parts at rest, or all fingers of a hand move for a hair that they gain for one: a meter of the
whole body away from rest counts by this factor, in sizes of the body, relative to a meter of error, at most
the second. So it hides no target: it fades as one is reached."""

GAIN = 0.5
"""Markers that nobody holds rather stay, as in `solve_ik`: the square of their distance from rest weighs this times the
error, in sizes of the body. An arm that is dragged out of reach yanks no other for the hair that it would gain."""

FORCE_TOLERANCE = 1e-3
"""Force that may be left over while something moves, as a share of the largest tension: nobody sees a micrometer, and
updates take little more than half the time. What comes to rest is followed to the end."""

STRIDE = 0.05
"""Most that a winch turns in one update, as a share of its range: longer strides take several times as long to solve,
so that the body would follow by jerks; with these it goes through all of its range in half a second."""

ENDS = {IKStatus.REACHED, IKStatus.LOCAL_OPTIMUM}


def _goal(held: Mapping[str, HeldPoint]) -> PointTarget:
    """Return the objective that draws held points to their targets."""
    return PointTarget(
        points={name: point.at for name, point in held.items()},
        targets={name: point.target for name, point in held.items()},
    )


class CableMover(Mover):
    """Live inverse kinematics by `hs.Tracker`: each shape is an equilibrium within the limits.

    Where cables rub, the way of the pointer is the way of the winches. Once the body stays, a note tells how far apart
    loading and unloading leave the markers.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        tension: float,
        start: Equilibrium | None = None,
        predictor: Predictor | None = None,
    ) -> None:
        """Begin in a pose, or at rest, with a tension limit [N]. With a predictor its answer comes first."""
        self.predictor, self._told = predictor, False
        self.robot, self.tension = simulation.robot, tension
        self._simulation, self._anchored = simulation, Anchored(simulation.robot.body.mesh)
        options = replace(simulation.options, tolerance=FORCE_TOLERANCE)
        self._rough = Simulation(simulation.robot, options=options, body=simulation.body)
        self._begin(start or simulation.rest)

    @property
    def pose(self) -> Equilibrium:
        """Pose that the robot is in."""
        return self._pose

    def with_tension_limit(self, tension: float) -> "CableMover":
        """Return a mover in the same pose with another limit on the tension [N]."""
        return CableMover(self._simulation, tension=tension, start=self._pose, predictor=self.predictor)

    def rest(self) -> RobotShape:
        """Back to rest immediately."""
        self._begin(self._simulation.rest)
        return self._shape({}, ())

    def update(self, held: Mapping[str, HeldPoint]) -> tuple[RobotShape, bool]:
        """One step of the tracker; without targets the winches stay as they are."""
        if not held:
            return self._shape({}, ()), False
        if held is not self._held:
            self._held, self._updates, self._still = held, 0, 0
            if self._exact:
                self._follow(self._rough)
            self._near = False
        targets = self._model_targets(held)
        if targets and self._updates == 0 and not self._told and self.predictor is not None:
            self._told = True  # the exact answer is next, even if the pointer has gone on
            self.predictor.stay(self._pose)
            shape = self._shape(self._anchored.errors(held, self._pose.nodes), (), settled=False)
            return replace(shape, prediction=self.predictor.solve(targets).as_prediction(exact=False)), True
        self._told = False
        if self._near and not self._exact:
            self._follow(self._simulation)
        self._updates += 1
        goals = [] if targets else [_goal(held)]
        tick = 1 / 30  # seconds that an update stands for; nothing here limits the rate
        try:
            reached = self._tracker.update(targets, seconds=tick, objectives=[*goals, *self._calm(held)])
        except HydrostatError as error:
            self._begin(self._pose)
            return self._shape(self._anchored.errors(held, self._pose.nodes), (str(error),)), False
        moved = float(np.abs(reached.pose.nodes - self._pose.nodes).max()) / self.robot.body.mesh.size
        self._pose = reached.pose
        still = 1e-4  # an update that moves no node farther brings it hardly nearer, in sizes of the body
        self._still = self._still + 1 if moved < still else 0
        max_cable_updates = 150  # so many updates are made towards targets that stay where they are
        stills = 3  # after so many of them in a row nobody waits for more
        more = reached.status not in ENDS and self._still < stills and self._updates < max_cable_updates
        last = 10  # so many updates are made at most where that was done roughly before
        if not more and not self._exact:
            self._near, self._still, self._updates, more = True, 0, max_cable_updates - last, True
        notes = reached.active_limits
        if not more and max(reached.errors.values()) > FAR_DISTANCE * self.robot.body.mesh.size:
            nearest = reached.status in (IKStatus.ITERATION_LIMIT, IKStatus.LOCAL_OPTIMUM, IKStatus.STALLED)
            notes = (*notes, NEAREST if nearest else str(reached.status))
        if not more:
            notes = (*notes, *self._band())
        shape = self._shape(dict(reached.errors), notes, settled=not more)
        if targets and self.predictor is not None:
            shape = replace(shape, prediction=self.predictor.solve(targets).as_prediction(exact=not more))
        return shape, more

    def _model_targets(self, held: Mapping[str, HeldPoint]) -> dict[str, Point] | None:
        """Targets of what is held, if there are networks that know all of it."""
        if self.predictor is None or not self.predictor.knows(held):
            return None
        return {name: point.target for name, point in held.items()}

    def _calm(self, held: Mapping[str, HeldPoint]) -> list[PoseRegularizer]:
        """Wishes that the body, and markers that nobody holds, stay: the more the farther the targets are."""
        errors = np.array(list(self._anchored.errors(held, self._pose.nodes).values())) / self.robot.body.mesh.size
        rest, others = self._simulation.rest, tuple(m.name for m in self.robot.markers if m.name not in held)
        calm = [PoseRegularizer(pose=rest, of="nodes", weight=min(CALM * float(errors.max()), CALMEST))]
        if others:
            weight = float(np.sqrt(GAIN * np.linalg.norm(errors)))
            calm.append(PoseRegularizer(pose=rest, of="markers", markers=others, weight=weight))
        return calm

    def _band(self) -> tuple[str, ...]:
        """Width of the friction hysteresis at the markers [mm], in words; empty without friction."""
        try:
            band = friction_hysteresis(self._simulation, self._pose)
        except NotConvergedError:
            return ()
        if not band:
            return ()
        name = max(band, key=lambda own: band[own])
        return (f"friction hysteresis: after overshoot, {name} rests up to {1e3 * band[name]:.1f} mm away",)

    def _begin(self, pose: Equilibrium) -> None:
        self._pose, self._held, self._updates, self._still, self._near = pose, {}, 0, 0, False
        self._follow(self._rough)

    def _follow(self, simulation: Simulation) -> None:
        """Track from the pose on with these physics: rough ones, or the robot's own."""
        self._exact = simulation is self._simulation
        self._tracker = Tracker(
            simulation,
            limits=Limits(tension=self.tension),
            start=self._pose,
            options=IKOptions(largest_step=STRIDE),
            model=self.predictor,
        )

    def _shape(self, errors: dict[str, float], notes: tuple[str, ...], *, settled: bool = True) -> RobotShape:
        pose = self._pose
        shape = RobotShape(
            nodes=pose.nodes,
            tensions=pose.tensions,
            contractions=pose.contractions,
            errors=errors,
            notes=notes,
        )
        return with_touches(self._simulation, pose, shape, settled=settled)


class Movers:
    """Keeps movers for as long as the physics of the robot stay the same. It works in one thread."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._muscles: MuscleMover | None = None
        self._cables: CableMover | None = None

    @property
    def muscles(self) -> MuscleMover | None:
        """The one that moves by muscles; None if it is not made yet."""
        return self._muscles

    def ready(self, robot: Robot, mode: Mode) -> bool:
        """Return True if there is a mover that fits, so that none has to be made."""
        found = self._muscles if mode is Mode.MUSCLES else self._cables
        return found is not None and same_physics(found.robot, robot, mode)

    def mover(self, robot: Robot, mode: Mode, tension: float) -> Mover:
        """The mover of a robot in a mode; made if need be, which can take a while. Cables bear at most a tension [N].

        Raises:
            NotConvergedError: the robot has no rest.
        """
        if mode is Mode.MUSCLES:
            if self._muscles is None or not self.ready(robot, mode):
                self._muscles = MuscleMover(robot)
            self._muscles.mark(robot.markers)
            return self._muscles
        before = self._cables
        if before is None or not self.ready(robot, mode):
            simulation = self._document.simulation_of(robot)
            start, predictor = _resume_pose(simulation, before), self._predictor(simulation.robot)
            self._cables = CableMover(simulation, tension=tension, start=start, predictor=predictor)
        elif before.tension != tension:
            self._cables = before.with_tension_limit(tension)
        assert self._cables is not None
        return self._cables

    def _predictor(self, robot: Robot) -> Predictor | None:
        """Networks of a robot; None where there are none, or it was changed since they learned."""
        if self._document.model is None:
            return None
        with suppress(InputError):
            return Predictor(self._document.model, robot)
        return None


def same_body(first: Robot, second: Robot) -> bool:
    """Return True if two robots have the same nodes."""
    return first.body.mesh is second.body.mesh


def same_physics(first: Robot, second: Robot, mode: Mode) -> bool:
    """Return True if what moves one moves the other in the same way; markers and poses do not matter."""
    if first is second:
        return True
    if not (same_body(first, second) and first.body == second.body):
        return False
    if any(getattr(first, name) != getattr(second, name) for name in ("pins", "gravity", "loads", "rods", "sheets")):
        return False
    if mode is Mode.MUSCLES:
        return True
    return (first.winches, first.cables, first.contact, first.obstacles) == (
        second.winches, second.cables, second.contact, second.obstacles
    )  # fmt: skip


def _resume_pose(simulation: Simulation, before: CableMover | None) -> Equilibrium | None:
    """The pose that a robot was in before it was changed, if it still is one."""
    robot = simulation.robot
    if before is None or not same_body(before.robot, robot):
        return None
    taken = dict(zip((winch.name for winch in before.robot.winches), before.pose.contractions, strict=True))
    wanted = np.array([np.clip(taken.get(winch.name, 0.0), -winch.release, winch.travel) for winch in robot.winches])
    pose = simulation.solve(wanted, strict=False)
    return pose if pose.result.converged and pose.result.stable else None
