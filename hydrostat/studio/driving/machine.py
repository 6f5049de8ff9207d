"""`Machine`: the motors, the body that follows them, and the playhead that commands them."""

import math
from collections.abc import Callable
from dataclasses import replace
from math import inf
from threading import RLock

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control import DEFAULT_MAX_SPEED, Link, Motors, Player, Timeline
from hydrostat.errors import HydrostatError
from hydrostat.fabrication import KitOptions, find_motor
from hydrostat.plot import upright
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.studio.document import Document
from hydrostat.studio.driving.keyframes import Keyframes
from hydrostat.studio.view.contact_items import with_touches
from hydrostat.studio.view.scene_items import RobotShape, rest_shape


def kit_speed(robot: Robot, tension: float) -> tuple[float, str]:
    """The speed of the slowest winch where its cables pull all that they may [m/s], and the motor's name.

    Args:
        robot: with winches; without, the speed is that of motors in general.
        tension: the most that a cable bears [N].
    """
    counts = [sum(cable.winch == winch.name for cable in robot.cables) for winch in robot.winches]
    loads = [many * tension * winch.spool_radius for many, winch in zip(counts, robot.winches, strict=True)]
    if not any(counts):
        return DEFAULT_MAX_SPEED, ""
    motor = find_motor(robot, loads, KitOptions())
    share = 1e3 * max(loads) / motor.stall_torque
    turns = motor.speed / 60 * max(1 - share, _MIN_SPEED_SHARE)
    least = min(winch.spool_radius for winch, many in zip(robot.winches, counts, strict=True) if many)
    return 2 * math.pi * least * turns, motor.title


_MIN_SPEED_SHARE = 0.1
"""Motors that would stall are shown at this share of their free speed: the kit says that they are too weak."""


EQUILIBRIUM_TOLERANCE = 3e-4
"""Largest distance of a node from equilibrium while it moves, in sizes of the body: less than a pixel."""


class Follower:
    """Solves for the newest contractions, from the last good pose; where there is none, the last good one stays."""

    def __init__(self) -> None:
        self.failure = ""  # why the last contractions have no shape; "" if they have
        self._simulation: Simulation | None = None
        self._last: Equilibrium | None = None

    def follow(self, simulation: Simulation, contractions: Vector, *, rough: bool = False) -> RobotShape:
        """The body at these contractions [m], or as it was last; `failure` tells which. Rough: it moves on at once."""
        if simulation is not self._simulation:
            self._simulation, self._last = simulation, None
        accuracy = EQUILIBRIUM_TOLERANCE * simulation.robot.body.mesh.size if rough else None
        pose = simulation.solve(contractions, start=self._last, strict=False, accuracy=accuracy)
        if pose.result.converged and upright(simulation.robot, pose):
            self._last, self.failure = pose, ""
        else:
            why = pose.result.status if not pose.result.converged else "elements inverted"
            self.failure = f"no equilibrium found ({why}). The last one is shown; go back a little"
        if self._last is None:
            return rest_shape(simulation.robot)
        last = self._last
        shape = RobotShape(nodes=last.nodes, tensions=last.tensions, contractions=last.contractions)
        return with_touches(simulation, last, shape, settled=not rough)


class Machine:
    """The open robot at work. All but `shape`, `due`, `run` and `fail` are called with its lock held."""

    def __init__(self, document: Document, keyframes: Keyframes, connect: Callable[[Vector], Link]) -> None:
        self._connect = connect
        self.player, self.motors = Player(), Motors((), connect(np.zeros(0)), command_timeout=inf)
        self.notice = ""  # why it does not do what was asked; "" if it does
        self.kit = ""  # name of the kit's motor, whose speed the motors have at first
        self.lock = RLock()  # for what must not change meanwhile; never held for long
        self._document, self._keyframes = document, keyframes
        self._follower = Follower()
        self._robot: Robot | None = None
        self._posed: tuple[Robot, RobotShape] | None = None
        self._timeline: Timeline | None = None
        self._rough = False
        self._ran = -inf
        self._good = self.motors.places

    def shape(self) -> RobotShape:
        """The body as the motors pull it."""
        robot, posed = self._document.robot, self._posed
        if posed is None or posed[0] is not robot:
            return rest_shape(robot)
        notes = ((self.notice,) if self.notice else ()) + _tension_warnings(robot, posed[1].tensions, self.strongest)
        notes += posed[1].notes
        return replace(posed[1], notes=notes)

    @property
    def strongest(self) -> float:
        """Maximum cable tension [N]."""
        return self._document.work.wishes.constraints.tension

    def meet(self, robot: Robot | None = None) -> None:
        """The robot, the one that is open if left out, may be another one than before."""
        robot = robot or self._document.robot
        if robot is self._robot:
            return
        self._robot = robot
        self.motors = self._motors_of(robot, self.motors)
        self.halt()
        self._good = np.zeros(len(self.motors.names))

    def halt(self, why: str = "") -> None:
        """Play no further."""
        self.player.stop()
        self.notice = why

    def seek(self, time: float) -> None:
        """Put the playhead to a time [s] of the timeline; where there are keys, the motors go along."""
        self.update_keys()
        self.player.time = min(max(time, 0.0), self._keyframes.timeline.seconds)
        if self._keyframes.timeline.keys:
            self._ask(self.player.time)

    def update_keys(self) -> None:
        """Update the motors to the present keys."""
        self._timeline = self._keyframes.timeline

    def run(self, now: float) -> bool:
        """Command the motors, see where they are, and let the body follow; whether anything has changed.

        Whoever calls it tells `fail` of all that it raises, such as a HydrostatError of the link.
        """
        self._ran = now
        simulation = self._document.simulation
        with self.lock:
            self.meet(simulation.robot)
            playing, time = self.player.playing, self.player.time
            self._play(now)
            self._stay_where_shapes_are()
            moved = self.motors.drive(now)
            fresh = self._posed is None or self._posed[0] is not simulation.robot
            places, rough = self.motors.places, self.busy
        new = moved or fresh or (self._rough and not rough)
        if new:
            self._rough = rough
            self._follow(simulation, places, rough)
        return new or playing != self.player.playing or time != self.player.time

    def due(self, now: float) -> bool:
        """Return True if it is time for the next `run`."""
        # motors are told and read once in this time [s], however often there is a step: about 60 times a second
        tick = 1 / 70
        return not 0 <= now - self._ran < tick

    def fail(self, error: Exception) -> bool:
        """Something went wrong, whatever it was: motors hold, and nothing plays. Whether that is news."""
        words = str(error) if isinstance(error, HydrostatError) else f"{type(error).__name__}: {error}"
        with self.lock:
            before = self.busy, self.notice
            self.motors.hold()
            self.halt(f"motors stopped: {words}")
            return before != (False, self.notice)

    @property
    def busy(self) -> bool:
        """Return True if there is more to do."""
        return self.player.playing or self.motors.is_moving

    def _motors_of(self, robot: Robot, before: Motors) -> Motors:
        """Motors of a robot; winches of the same name keep what they have taken in, and what they shall take in."""
        names = [winch.name for winch in robot.winches]

        def carry_over(values: Vector) -> Vector:
            known = dict(zip(before.names, values.tolist(), strict=True))
            return np.array([known.get(name, 0.0) for name in names], dtype=float)

        places, link = carry_over(before.places), before.link
        if names != list(before.names):
            places = np.clip(
                places, [-winch.release for winch in robot.winches], [winch.travel for winch in robot.winches]
            )
            link.close()
            link = self._connect(places)
        fastest, self.kit = kit_speed(robot, self.strongest)
        if names == list(before.names):
            fastest = before.fastest
        motors = Motors(robot.winches, link, places=places, fastest=fastest, command_timeout=inf)
        motors.ask(carry_over(before.command))
        return motors

    def _play(self, now: float) -> None:
        """Let the playhead run, and the commands with it; at a limit it stops."""
        timeline = self._keyframes.timeline
        if timeline is not self._timeline:  # undone, done again: a selected key shows what it is now
            self._timeline = timeline
            if (index := self._keyframes.chosen_index) is not None:
                self._ask(timeline.keys[index].time)
        if self.player.playing:
            self.player.advance(now, timeline.seconds)
            if beyond := self._ask(self.player.time):
                self.halt(f"stopped: {beyond}")

    def _ask(self, time: float) -> str:
        """Command what the keys say; what of it cannot be done, "" if all can."""
        return self.motors.ask(self._keyframes.timeline.profile(self.motors.names).at(time))

    def _follow(self, simulation: Simulation, places: Vector, rough: bool) -> None:
        """Solve for where the motors are; what cannot be solved ends the playing, and motors go no further."""
        shape = self._follower.follow(simulation, places, rough=rough)
        with self.lock:
            self._posed = (simulation.robot, shape)
            if not self._follower.failure:
                self._good = places
                return
            self.halt(self._follower.failure)
            self._stay_where_shapes_are()

    def _stay_where_shapes_are(self) -> None:
        """Once the body has no shape, motors only go back to where it had one, or let out: none is driven blind."""
        motors = self.motors
        if not self._follower.failure or len(self._good) != len(motors.places):
            return
        further = (motors.command - motors.places) * (motors.places - self._good)
        pulling = np.abs(motors.command) > np.abs(motors.places)
        if self.player.playing or (pulling & (further > 0)).any():
            self.halt(self._follower.failure)
            motors.hold()


def _tension_warnings(robot: Robot, tensions: Vector, most: float) -> tuple[str, ...]:
    """Sentences on cables that bear what they should not."""
    return tuple(
        f"{robot.cables[index].winch}: cable tension {tensions[index]:.1f} N, maximum {most:g} N"
        for index in np.flatnonzero(tensions > most)[:3]
    )
