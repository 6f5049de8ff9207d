"""`SimulatedLink`: motors that turn no faster than they are told."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.link import SILENCE, Link


class SimulatedLink(Link):
    """Motors that go straight to their newest command, at its speed; their watchdog is like that of real ones."""

    def __init__(self, contractions: Vector) -> None:
        """Motors that have taken in so much [m] and stand still."""
        self._places = self._goal = contractions.copy()
        self._speed = 0.0
        self._time = self._heard = -np.inf

    def send(self, contractions: Vector, now: float, *, speed: float) -> None:
        """Go there."""
        self._move(now)
        self._goal, self._heard, self._speed = contractions.copy(), now, speed

    def read(self, now: float) -> Vector:
        """Contractions by now [m]."""
        self._move(now)
        return self._places.copy()

    def stop(self) -> None:
        """Stay where they were read last."""
        self._goal = self._places

    def close(self) -> None:
        """Stop; there is nothing to let go."""
        self.stop()

    def _move(self, now: float) -> None:
        """Let time pass; after the silence nothing moves."""
        seconds = min(now, self._heard + SILENCE) - self._time
        self._time = max(self._time, now)
        if np.isfinite(seconds) and seconds > 0:
            reach = self._speed * seconds
            self._places = self._places + np.clip(self._goal - self._places, -reach, reach)
