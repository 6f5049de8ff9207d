"""`CableMover`: inverse kinematics on the robot's own cables follows what is held."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from hydrostat.errors import HydrostatError, NotConvergedError
from hydrostat.ik import IKOptions, IKStatus, Limits, PointTarget, PoseRegularizer, Tracker
from hydrostat.robot import Point
from hydrostat.simulation import Equilibrium, Simulation, friction_hysteresis
from hydrostat.studio.posing.held import Anchored, HeldPoint
from hydrostat.studio.posing.mover import Mover
from hydrostat.studio.posing.predictor import Predictor
from hydrostat.studio.view.things import RobotShape
from hydrostat.studio.view.touching import with_touches

PATIENCE = 150  # so many updates are made towards targets that stay where they are
CALM, CALMEST = 4.0, 0.3
"""Weights that keep free parts at rest, or all fingers of a hand move for a hair that they gain for one: a meter of the
whole body away from rest counts by this factor, in sizes of the body, relative to a meter of error, at most
the second. So it hides no target: it fades as one is reached."""

GAIN = 0.5
"""Markers that nobody holds rather stay, as in `solve_ik`: the square of their distance from rest weighs this times the
error, in sizes of the body. An arm that is dragged out of reach yanks no other for the hair that it would gain."""

STILL = 1e-4  # an update that moves no node farther brings it hardly nearer, in sizes of the body
STILLS = 3  # after so many of them in a row nobody waits for more
MISSED = 0.01  # from this distance on a target counts as out of reach, in sizes of the body
ROUGH = 1e-3
"""Force that may be left over while something moves, as a share of the largest tension: nobody sees a micrometre, and
updates take little more than half the time. What comes to rest is followed to the end."""

STRIDE = 0.05
"""Most that a winch turns in one update, as a share of its range: longer strides take several times as long to solve,
so that the body would follow by jerks; with these it goes through all of its range in half a second."""

LAST = 10  # so many updates are made at most where that was done roughly before
TICK = 1 / 30  # seconds that an update stands for; nothing here limits the rate
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
        options = replace(simulation.options, tolerance=ROUGH)
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
        """Back to rest at once."""
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
        try:
            reached = self._tracker.update(targets, seconds=TICK, objectives=[*goals, *self._calm(held)])
        except HydrostatError as error:
            self._begin(self._pose)
            return self._shape(self._anchored.errors(held, self._pose.nodes), (str(error),)), False
        moved = float(np.abs(reached.pose.nodes - self._pose.nodes).max()) / self.robot.body.mesh.size
        self._pose = reached.pose
        self._still = self._still + 1 if moved < STILL else 0
        more = reached.status not in ENDS and self._still < STILLS and self._updates < PATIENCE
        if not more and not self._exact:
            self._near, self._still, self._updates, more = True, 0, PATIENCE - LAST, True
        notes = reached.active_limits
        if not more and max(reached.errors.values()) > MISSED * self.robot.body.mesh.size:
            stopped = reached.status is not IKStatus.ITERATION_LIMIT
            notes = (*notes, str(reached.status if stopped else IKStatus.LOCAL_OPTIMUM))
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
