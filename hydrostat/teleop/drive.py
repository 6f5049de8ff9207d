"""`drive`: motors that follow what a person asks for, and hold when nobody is heard."""

import sys
import threading
import time
from collections.abc import Callable

import numpy as np

from hydrostat.control import Motors
from hydrostat.teleop.source import DriveSource, DriveWish
from hydrostat.teleop.ways import Way

TICK = 1 / 60
"""Motors are told and read at least once in this time [s]."""
SWITCHING = 5e-4
"""Threads of Python give way to one another after so long [s], in place of 5 ms: the one that solves poses is busy."""


class DriveLoop:
    """What drives motors, step by step.

    Attributes:
        silent: whether nobody is heard just now; motors hold.
        wish: the newest.
    """

    def __init__(self, motors: Motors, way: Way, source: DriveSource) -> None:
        """Begin where the motors are."""
        self.motors, self.way, self.source = motors, way, source
        self.silent, self.wish = False, DriveWish(stamp=-np.inf)
        self._values, self._held = way.held(motors.places), True
        self._numbers = {name: index for index, name in enumerate(way.channels.names)}

    def step(self, now: float) -> bool:
        """Hear, and tell the motors, by a clock [s]; tell whether the person goes on.

        Raises:
            HydrostatError: of the source, of the motors, or of what solves poses; the motors hold.
        """
        self.wish = wish = self.source.read()
        self.silent = now - wish.stamp > self.source.silence
        if self.silent or wish.hold or wish.over:
            if not self._held:
                self._values, self._held = self.way.held(self.motors.places), True
        else:
            self._follow(wish)
        self.motors.ask(self.way.contractions)
        self.motors.drive(now)
        self.way.see(self.motors.places)
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
    way: Way,
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
        source: what asks.
        seconds: it ends after so long [s].
        tell: called after each command.
        clock: that only runs forward [s].

    Raises:
        HydrostatError: of the source, of the motors, or of what solves poses.
    """
    news, switching = threading.Event(), sys.getswitchinterval()
    sys.setswitchinterval(SWITCHING)
    source.news = way.news = news
    try:
        driven, end = DriveLoop(motors, way, source), clock() + seconds
        while driven.step(clock()) and clock() < end:
            tell(driven)
            news.wait(TICK)
            news.clear()
    finally:
        motors.hold()
        way.close()
        sys.setswitchinterval(switching)
