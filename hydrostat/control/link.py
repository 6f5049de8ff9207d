"""`Link`: the contract of what lies between commands and motors; `SimulatedLink`: motors that are not there."""

from abc import ABC, abstractmethod

import numpy as np

from hydrostat.arrays import Vector

WATCHDOG_TIMEOUT = 0.5  # time without a command [s] after which motors stop where they are


class Link(ABC):
    """Interface between commands and motors; a new kind of motor is one class.

    Contractions are the cable lengths that winches take in beyond rest [m], in the order of the robot's winches; speeds
    are cable speeds [m/s]; times are of one monotonic clock, such as `time.monotonic` [s].

    Only `Motors` uses a link, from one thread at a time. While motors may move, it calls `send` and `read` in turn,
    about 60 times a second, and less often if solving is slow. Only the newest command counts; commands are not queued.
    Neither call waits for a motor. A link that fails raises a `HydrostatError` with the fix. After this or any other
    error, `stop` is called and nothing is sent until the next request.

    A link to real motors must guarantee that

    - motors stop `WATCHDOG_TIMEOUT` after the last `send`, even if this process has died (by a watchdog in them),
    - motors stop on any error of theirs and on `stop`, and hold their position,
    - no command moves them beyond the limits of their winch, or faster than it says (`Motors` checks this, too).

    Attributes:
        near: distance to a command within which it counts as reached [m].
    """

    near: float = 1e-7

    @property
    def currents(self) -> Vector | None:
        """Latest motor currents, positive when reeling in [A]; None where there are no currents."""
        return None

    @abstractmethod
    def send(self, contractions: Vector, now: float, *, speed: float) -> None:
        """Command contractions [m] at a maximum cable speed [m/s], by a clock [s]; return immediately.

        Raises:
            HydrostatError: the command cannot be sent.
        """

    @abstractmethod
    def read(self, now: float) -> Vector:
        """Return the latest contractions [m] (HydrostatError: the motors report an error, or do not answer)."""

    @abstractmethod
    def stop(self) -> None:
        """Stop the motors at their positions. You can call this at any time, and it never raises."""

    @abstractmethod
    def close(self) -> None:
        """Stop the motors and close the link. You can call this twice, and it never raises."""


class SimulatedLink(Link):
    """Simulated motors that move straight to the newest command, at its speed, with a watchdog like real ones."""

    def __init__(self, contractions: Vector) -> None:
        """Motors that have taken in so much [m] and stand still."""
        self._places = self._goal = contractions.copy()
        self._speed = 0.0
        self._time = self._heard = -np.inf

    def send(self, contractions: Vector, now: float, *, speed: float) -> None:
        """Command contractions."""
        self._move(now)
        self._goal, self._heard, self._speed = contractions.copy(), now, speed

    def read(self, now: float) -> Vector:
        """Return the present contractions [m]."""
        self._move(now)
        return self._places.copy()

    def stop(self) -> None:
        """Stop at the last read positions."""
        self._goal = self._places

    def close(self) -> None:
        """Stop the motors."""
        self.stop()

    def _move(self, now: float) -> None:
        """Let time pass; after the silence nothing moves."""
        seconds = min(now, self._heard + WATCHDOG_TIMEOUT) - self._time
        self._time = max(self._time, now)
        if np.isfinite(seconds) and seconds > 0:
            reach = self._speed * seconds
            self._places = self._places + np.clip(self._goal - self._places, -reach, reach)
