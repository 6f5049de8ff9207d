"""`Machine`: the motors, the body that follows them, and the playhead that commands them."""

from dataclasses import replace
from threading import RLock

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.studio.document import Document
from hydrostat.studio.driving.follower import Follower
from hydrostat.studio.driving.keyframes import Keyframes
from hydrostat.studio.driving.motors import Motors
from hydrostat.studio.driving.player import Player
from hydrostat.studio.records.timeline import Timeline
from hydrostat.studio.view.shape import Shape, rest_shape


class Machine:
    """The open robot at work. All but `shape` and `run` are called with its lock held.

    Attributes:
        player: the playhead.
        motors: of the winches.
        notice: why it does not do what was asked; "" if it does.
        lock: for what must not change meanwhile; never held for long.
    """

    def __init__(self, document: Document, keyframes: Keyframes) -> None:
        self.player, self.motors = Player(), Motors()
        self.notice = ""
        self.lock = RLock()
        self._document, self._keyframes = document, keyframes
        self._follower = Follower()
        self._posed: tuple[Robot, Shape] | None = None
        self._timeline: Timeline | None = None
        self._rough = False

    def shape(self) -> Shape:
        """The body as the motors pull it."""
        robot, posed = self._document.robot, self._posed
        if posed is None or posed[0] is not robot:
            return rest_shape(robot)
        notes = ((self.notice,) if self.notice else ()) + _strained(robot, posed[1].tensions, self.strongest)
        return replace(posed[1], notes=notes)

    @property
    def strongest(self) -> float:
        """The most that a cable should bear [N]."""
        return self._document.work.wishes.tension

    def meet(self, robot: Robot | None = None) -> None:
        """The robot, the one that is open if left out, may be another one than before."""
        if self.motors.meet(robot or self._document.robot):
            self.halt()

    def halt(self, why: str = "") -> None:
        """Play no further."""
        self.player.stop()
        self.notice = why

    def seek(self, time: float) -> None:
        """Put the playhead to a time [s] of the timeline; where there are keys, the motors go along."""
        self.mind_keys()
        self.player.time = min(max(time, 0.0), self._keyframes.timeline.seconds)
        if self._keyframes.timeline.keys:
            self._ask(self.player.time)

    def mind_keys(self) -> None:
        """The motors know the keys as they are now."""
        self._timeline = self._keyframes.timeline

    def run(self, now: float) -> bool:
        """Command the motors, see where they are, and let the body follow; whether anything has changed.

        Raises:
            HydrostatError: of the link; nothing plays any more then.
        """
        simulation = self._document.simulation
        with self.lock:
            self.meet(simulation.robot)
            playing, time = self.player.playing, self.player.time
            self._play(now)
            moved = self._drive(now)
            fresh = self._posed is None or self._posed[0] is not simulation.robot
            places, rough = self.motors.places, self.busy
        new = moved or fresh or (self._rough and not rough)
        if new:
            self._rough = rough
            self._follow(simulation, places, rough)
        return new or playing != self.player.playing or time != self.player.time

    @property
    def busy(self) -> bool:
        """Whether there is more to do."""
        return self.player.playing or self.motors.moving

    def _play(self, now: float) -> None:
        """Let the playhead run, and the commands with it; at a limit it stops."""
        timeline = self._keyframes.timeline
        if timeline is not self._timeline:  # undone, done again: a selected key shows what it is now
            self._timeline = timeline
            if (index := self._keyframes.chosen) is not None:
                self._ask(timeline.keys[index].time)
        if self.player.playing:
            self.player.advance(now, timeline.seconds)
            if beyond := self._ask(self.player.time):
                self.halt(f"stopped: {beyond}")

    def _ask(self, time: float) -> str:
        """Command what the keys say; what of it cannot be done, "" if all can."""
        return self.motors.ask(self._keyframes.timeline.profile(self.motors.names).at(time))

    def _drive(self, now: float) -> bool:
        """Tell the motors, and hear whether they have moved."""
        try:
            return self.motors.drive(now)
        except Exception as error:
            self.halt(f"motors stopped: {error}")
            raise

    def _follow(self, simulation: Simulation, places: Vector, rough: bool) -> None:
        """Solve for where the motors are; what cannot be solved ends the playing."""
        shape = self._follower.follow(simulation, places, rough=rough)
        with self.lock:
            if self._follower.failure:
                self.halt(self._follower.failure)
            self._posed = (simulation.robot, shape)


def _strained(robot: Robot, tensions: Vector, most: float) -> tuple[str, ...]:
    """What cables bear that they should not."""
    return tuple(
        f"a cable of {robot.cables[index].winch} pulls {tensions[index]:.1f} N, more than {most:g} N"
        for index in np.flatnonzero(tensions > most)[:3]
    )
