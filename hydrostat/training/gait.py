"""`Gait`: contractions that repeat; `GaitClock` plays one gait after another without a jump."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector

FASTEST, SLOWEST = 0.3, 2.0
"""Periods of gaits that an action can ask for [s]."""


@dataclass(frozen=True, kw_only=True)
class Gait:
    """Raised cosines, one winch after the other.

    Attributes:
        amplitude: the most that each winch takes in [m].
        lag: lag of each winch behind the one before, in cycles.
        period: period of a cycle [s].
    """

    amplitude: float
    lag: float
    period: float

    @classmethod
    def of_action(cls, action: np.ndarray, most: float) -> "Gait":
        """The gait of three numbers from -1 to 1: amplitude from 0 to `most` [m], lag of half a cycle, period."""
        size, lag, period = np.clip(np.asarray(action, dtype=float), -1.0, 1.0).tolist()
        return cls(amplitude=0.5 * (size + 1.0) * most, lag=0.5 * lag, period=_MIDDLE + _HALF * period)

    def action(self, most: float) -> Vector:
        """The action that asks for this gait (see `of_action`)."""
        return np.array([2.0 * self.amplitude / most - 1.0, 2.0 * self.lag, (self.period - _MIDDLE) / _HALF])


class GaitClock:
    """Phase of winches within a gait.

    Attributes:
        phase: cycles since the beginning.
        amplitude: present amplitude [m].
        lag: present lag, in cycles.
    """

    def __init__(self, winches: int, most: float) -> None:
        """Begin with nothing taken in; in a period amplitudes change by `most` [m] at most, lags by half a cycle."""
        self.phase = self.amplitude = self.lag = 0.0
        self._order, self._most = np.arange(winches), most

    def after(self, gait: Gait, dt: float) -> Vector:
        """Contractions [m] after a time [s] of a gait."""
        share = dt / gait.period
        self.phase += share
        if self.amplitude == 0.0:
            self.lag = gait.lag
        self.lag += float(np.clip(gait.lag - self.lag, -0.5 * share, 0.5 * share))
        change = self._most * share
        self.amplitude += float(np.clip(gait.amplitude - self.amplitude, -change, change))
        return self.amplitude * 0.5 * (1.0 - np.cos(2.0 * np.pi * (self.phase - self.lag * self._order)))


_MIDDLE, _HALF = 0.5 * (SLOWEST + FASTEST), 0.5 * (SLOWEST - FASTEST)
