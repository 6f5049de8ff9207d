"""`Link`: the contract of what lies between commands and motors; `SimulatedLink`: motors that are not there."""

from abc import ABC, abstractmethod

import numpy as np

from hydrostat.arrays import Vector

WATCHDOG_TIMEOUT = 0.5  # time without a command [s] after which motors stop where they are


class Link(ABC):
    """Contract of what lies between commands and motors.

    A new kind of motor is one class; whoever drives passes an instance of it.

    Contractions are what each winch takes in [m], beyond its length at rest, in the order of the robot's winches;
    speeds are those of the cables [m/s]; times are of one clock that only runs forward, such as `time.monotonic` [s].

    Only `Motors` uses a link, from one thread at a time. While anything shall move it calls `send` and `read` in turn,
    about 60 times a second, and less often where solving is slow; only the newest command counts, none is queued.
    Neither waits for a motor. A link that fails raises a `HydrostatError` that says what to do. On that, and on any
    other error, `stop` is called and nothing is sent before somebody asks again.

    Whoever puts real motors behind this keeps four promises: they stop `WATCHDOG_TIMEOUT` after the last `send`, even
    if this process has died, so the watch is on the side of the motors; they stop on any error of theirs, and on
    `stop`, and hold what they have; no command makes them move beyond the limits of their winch, or faster than it
    says, which `Motors` asks for too.

    Attributes:
        near: motors this close to a command are where they shall be [m].
    """

    near: float = 1e-7

    @property
    def currents(self) -> Vector | None:
        """Latest motor currents, positive when reeling in [A]; None where there are no currents."""
        return None

    @abstractmethod
    def send(self, contractions: Vector, now: float, *, speed: float) -> None:
        """Let the motors go to contractions [m] at so fast a cable [m/s], by a clock [s]; return immediately.

        Raises:
            HydrostatError: it cannot be sent.
        """

    @abstractmethod
    def read(self, now: float) -> Vector:
        """Contraction of each winch at the last reading [m] (HydrostatError: motors report an error, or nothing)."""

    @abstractmethod
    def stop(self) -> None:
        """Let the motors stay where they are. It may be called at any time and never raises."""

    @abstractmethod
    def close(self) -> None:
        """Stop the motors, and let them go for good. It may be called twice and never raises."""


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
        seconds = min(now, self._heard + WATCHDOG_TIMEOUT) - self._time
        self._time = max(self._time, now)
        if np.isfinite(seconds) and seconds > 0:
            reach = self._speed * seconds
            self._places = self._places + np.clip(self._goal - self._places, -reach, reach)
