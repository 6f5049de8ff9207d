"""`MappedHand`: a robot driven by a hand that a glove or a camera measures."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf, pi

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import HydrostatError, InputError
from hydrostat.teleop.hand_map import HandMap
from hydrostat.teleop.source import DriveChannels, DriveSource, DriveWish, HandReading, HandSource


@dataclass(frozen=True, kw_only=True)
class Smoothing:
    """Options of the one-euro filter for values from 0 to 1.

    Attributes:
        least: cutoff frequency for a value at rest [Hz].
        rise: increase of the cutoff frequency with speed [Hz for the full range in a second].
        speed: cutoff frequency for the speed [Hz].
    """

    least: float = 1.5
    rise: float = 60.0
    speed: float = 1.0

    def __post_init__(self) -> None:
        for name, value, low in (("least", self.least, 0.01), ("rise", self.rise, 0.0), ("speed", self.speed, 0.01)):
            if not low <= value <= 1e3:
                raise InputError(f"smoothing: {name} must be from {low:g} to 1000 Hz, not {value:g}")


class OneEuro:
    """The One-Euro filter of Casiez, Roussel and Vogel (2012), of each value on its own.

    x rises by a (value - x), a = 1 / (1 + 1 / (2 pi f dt)), f = least + rise |speed|; the speed is that of the values,
    smoothed in the same way at a frequency of its own. Where they rest, noise of readings that know nothing of one
    another becomes smaller by sqrt(a / (2 - a)); values that rise evenly are followed 1 / (2 pi f) late.
    """

    def __init__(self, smoothing: Smoothing | None = None) -> None:
        """Nothing was heard yet."""
        self._how = smoothing or Smoothing()
        self._stamp: float | None = None
        self._values = self._before = self._speed = np.zeros(0)

    def __call__(self, values: Vector, stamp: float) -> Vector:
        """Smoothed values, of those heard at a time [s]; the first ones and those of no later time are as they are."""
        since = 0.0 if self._stamp is None else stamp - self._stamp
        if since <= 0 or values.shape != self._values.shape:
            self._speed, self._values = np.zeros(len(values)), values.copy()
        else:
            speed = (values - self._before) / since
            self._speed = self._speed + _share(self._how.speed, since) * (speed - self._speed)
            share = _share(self._how.least + self._how.rise * np.abs(self._speed), since)
            self._values = self._values + share * (values - self._values)
        self._before, self._stamp = values.copy(), stamp
        return self._values.copy()


def _share(frequency: Vector | float, seconds: float) -> Vector | float:
    """Share of what is new, of a low pass of first order."""
    return 1.0 / (1.0 + 1.0 / (2 * pi * frequency * seconds))


HAND_TIMEOUT = 0.25
"""A hand that is not heard for so long is not there [s]."""
USUAL_SMOOTHING = Smoothing()
"""Smoothing of hand readings: each is one byte, and trembles."""
STARTUP_TIMEOUT = 5.0
"""Errors of the source in a row end the drive after so long [s]."""


class MappedHand(DriveSource):
    """Hand input that a separate thread reads continuously and maps to the channels of a robot."""

    silence = HAND_TIMEOUT

    def __init__(
        self,
        channels: DriveChannels,
        hand: HandSource,
        known: HandMap,
        *,
        smoothing: Smoothing | None = USUAL_SMOOTHING,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Read a hand from now on, smoothed if that is not None (InputError: the map is of another hand or robot)."""
        known.check(hand.names, channels.names)
        self._hand, self._map, self._clock = hand, known, clock
        self._reading: HandReading | None = None
        self._smooth = None if smoothing is None else OneEuro(smoothing)
        self._error, self._well = "", clock()
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="hand", daemon=True)
        self._thread.start()

    def read(self) -> DriveWish:
        """Return the command of the latest reading."""
        reading, error = self._reading, self._error
        if error and self._clock() - self._well > STARTUP_TIMEOUT:
            raise HydrostatError(error)
        if reading is None:
            return DriveWish(stamp=-inf, words=error or "the hand was not heard yet")
        return DriveWish(stamp=reading.stamp, places=self._map(reading.values), words=error or "Ctrl-C: end")

    def close(self) -> None:
        """End the thread and close the hand input."""
        self._over.set()
        self._thread.join(1.0)
        self._hand.close()

    def _run(self) -> None:
        while not self._over.is_set():
            try:
                reading = self._hand.read()
                if not np.isfinite(reading.values).all():
                    raise HydrostatError("what the hand tells is no number")
                if self._smooth is not None:
                    reading = replace(reading, values=self._smooth(reading.values, reading.stamp))
                self._reading = reading
                self._error, self._well = "", self._clock()
            except Exception as error:  # noqa: BLE001 - of whatever kind: nobody is heard, and why is told
                self._error = str(error) or type(error).__name__
                self._over.wait(0.05)
            if self.updated is not None:
                self.updated.set()
            self._over.wait(1e-3)
