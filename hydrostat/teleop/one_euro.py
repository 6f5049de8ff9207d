"""`OneEuro`: a filter that smooths a hand that rests, and hardly delays one that moves."""

from dataclasses import dataclass
from math import pi

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Smoothing:
    """Options of the one-euro filter for values from 0 to 1.

    Attributes:
        least: frequency above which a value that rests is smoothed [Hz].
        rise: by which that frequency rises with speed [Hz for the whole range in a second].
        speed: frequency above which the speed is smoothed [Hz].
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
