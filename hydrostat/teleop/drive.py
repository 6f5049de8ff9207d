"""`drive`: motors that follow a person's input, and hold when it is lost."""

import sys
import threading
import time
from collections.abc import Callable

import numpy as np

from hydrostat.control import Motors
from hydrostat.teleop.source import DriveSource, DriveWish
from hydrostat.teleop.ways import CommandMapper

TICK = 1 / 60
"""Motors are told at least once in this time, and read about as often [s]."""
SWITCHING = 5e-4
"""Threads of Python give way to one another after so long [s], in place of 5 ms: the one that solves poses is busy."""


class DriveLoop:
    """Loop that drives motors, step by step, as a person commands.

    Attributes:
        silent: True without input; motors hold.
        wish: the newest.
        pause: to be made before the next step [s]: goals that nobody waited for an answer to must have left the line,
            or a stop would come after all of them.
    """

    def __init__(
        self, motors: Motors, way: CommandMapper, source: DriveSource, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Begin where the motors are; the clock only runs forward [s]."""
        self.motors, self.way, self.source, self._clock = motors, way, source, clock
        self.silent, self.wish, self.pause = False, DriveWish(stamp=-np.inf), 0.0
        self._values, self._held = way.hold_at(motors.places), True
        self._looked, self._exchange = -np.inf, 0.0  # when motors were last read, and how long that took [s]
        self._numbers = {name: index for index, name in enumerate(way.channels.names)}

    def step(self, now: float, motor_time: float | None = None) -> bool:
        """Read the input by its clock and command the motors by theirs [s]; return True if the person goes on.

        The time of the motors is that of the input if left out; emulated motors have a slower clock on a busy computer.
        What is heard sooner than a tick after motors were read is told without reading them again, which takes as long
        as their answers do on the line.

        Raises:
            HydrostatError: of the source, of the motors, or of what solves poses; the motors hold.
        """
        told = now if motor_time is None else motor_time
        self.wish = wish = self.source.read()
        self.silent = now - wish.stamp > self.source.silence
        if self.silent or wish.hold or wish.over:
            if not self._held:
                self.motors.drive(told)  # where they are just now, not a tick ago
                self._values, self._held = self.way.hold_at(self.motors.places), True
        else:
            self._follow(wish)
        self.motors.ask(self.way.contractions)
        look, begin = not now - self._looked < TICK, self._clock()
        self.motors.drive(told, look=look)
        if look:
            self._looked, self._exchange = now, self._clock() - begin
        # Share of sending alone in the time that sending and reading take on a line, approximately
        share = 0.35
        self.pause = 0.0 if look else share * self._exchange
        self.way.observe(self.motors.places)
        return not wish.over

    def _follow(self, wish: DriveWish) -> None:
        """Ask the way for what is wished; what nobody moved since motors held stays where it is."""
        channels, values = self.way.channels, self._values.copy()
        for name, place in wish.places.items():
            values[self._numbers[name]] = place
        for name, step in wish.steps.items():
            values[self._numbers[name]] += step
        if self._held and np.array_equal(values, self._values):
            return
        self._held, self._values = False, np.clip(values, channels.low, channels.high)
        self.way.ask(self._values)


def drive(
    motors: Motors,
    way: CommandMapper,
    source: DriveSource,
    *,
    seconds: float = np.inf,
    tell: Callable[[DriveLoop], None] = lambda _: None,
    clock: Callable[[], float] = time.monotonic,
) -> None:
    """Let motors follow a source in real time until it ends; they hold at its end, on any error and when interrupted.

    Args:
        motors: within whose limits all stays.
        way: from what is asked for to contractions.
        source: input device.
        seconds: it ends after so long [s].
        tell: called after each command.
        clock: monotonic clock of the source [s].

    Raises:
        HydrostatError: of the source, of the motors, or of what solves poses.
    """
    news, switching = threading.Event(), sys.getswitchinterval()
    sys.setswitchinterval(SWITCHING)
    source.updated = way.updated = news
    try:
        driven, end = DriveLoop(motors, way, source, clock=clock), clock() + seconds
        while driven.step(clock(), motors.clock()) and clock() < end:
            tell(driven)
            time.sleep(driven.pause)
            news.wait(TICK)
            news.clear()
    finally:
        motors.hold()
        way.close()
        sys.setswitchinterval(switching)
