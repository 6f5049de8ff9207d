"""`SimulatedLink`: motors that turn no faster than they can."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.studio.driving.link import SILENCE, Link

FASTEST = 0.15
"""Largest speed of the cables [m/s] unless told otherwise: brisk for a small geared motor, and knobs feel direct."""


class SimulatedLink(Link):
    """Each motor goes straight to its newest command, at its largest speed; its watchdog is like that of a real one.

    Attributes:
        speed: largest speed of the cables [m/s].
    """

    def __init__(self, contractions: Vector, *, speed: float = FASTEST) -> None:
        """Motors that have taken in so much [m] and stand still."""
        self.speed = speed
        self._places = self._goal = contractions.copy()
        self._time = self._heard = -np.inf

    def send(self, contractions: Vector, now: float) -> None:
        """Go there."""
        self._move(now)
        self._goal, self._heard = contractions.copy(), now

    def read(self, now: float) -> Vector:
        """Where they are by now."""
        self._move(now)
        return self._places.copy()

    def stop(self) -> None:
        """Stay where they were read last."""
        self._goal = self._places

    def close(self) -> None:
        """As `stop`."""
        self.stop()

    def _move(self, now: float) -> None:
        """Let time pass; after the silence nothing moves."""
        seconds = min(now, self._heard + SILENCE) - self._time
        self._time = max(self._time, now)
        if np.isfinite(seconds) and seconds > 0:
            reach = self.speed * seconds
            self._places = self._places + np.clip(self._goal - self._places, -reach, reach)
