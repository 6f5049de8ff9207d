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
    """Loop that drives motors by the commands of a person, step by step.

    Attributes:
        silent: True without input; motors hold.
        wish: latest command.
        pause: time to wait before the next step [s]: goals that need no answer must have left the serial line, or a
            stop command would queue behind them.
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
        """Read the input by its clock and command the motors by theirs [s]; return True to continue.

        Without a motor time, the motors use the time of the input; emulated motors have a slower clock on a busy
        computer. Input that arrives within one tick of the last motor reading is sent without another reading, which
        takes as long as the answers of all motors on the line.

        Raises:
            HydrostatError: an error of the input, the motors or the pose solver; the motors hold.
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
    """Drive motors from a source in real time until it ends; they hold at the end, on any error and on interruption.

    Args:
        motors: motors to drive; commands stay within their limits.
        way: mapping from commands to contractions.
        source: input device.
        seconds: maximum duration [s].
        tell: callback after each command.
        clock: monotonic clock of the source [s].

    Raises:
        HydrostatError: an error of the source, the motors or the pose solver.
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
