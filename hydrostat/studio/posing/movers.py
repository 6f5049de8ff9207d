"""`Movers`: the mover that fits the robot as it is, made when it is first needed."""

from contextlib import suppress

import numpy as np

from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.studio.document import Document
from hydrostat.studio.posing.cable_mover import CableMover
from hydrostat.studio.posing.held import Mode
from hydrostat.studio.posing.mover import Mover, MuscleMover
from hydrostat.studio.posing.predictor import Predictor


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
        """Tell whether there is a mover that fits, so that none has to be made."""
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
    """Tell whether two robots have the same nodes."""
    return first.body.mesh is second.body.mesh


def same_physics(first: Robot, second: Robot, mode: Mode) -> bool:
    """Tell whether what moves one moves the other in the same way; markers and poses do not matter."""
    if first is second:
        return True
    if not (same_body(first, second) and first.body == second.body):
        return False
    if (first.pins, first.gravity) != (second.pins, second.gravity):
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
