"""`Link`: the contract of what turns winches: motors that are simulated, or real ones."""

from abc import ABC, abstractmethod

from hydrostat.arrays import Vector

SILENCE = 0.5
"""Motors that are told nothing for so long [s] stop where they are (watchdog)."""


class Link(ABC):
    """What lies between commands and motors.

    The stage that drives is the only one to use a link, from one thread at a time. While anything shall move it calls
    `send` and `read` in turn, about 60 times a second, and less often where solving is slow; only the newest command
    counts, none is queued. A link that fails raises a `HydrostatError` that says what to do. On that, on any other
    error, and where the body would have no shape, the stage calls `stop` and plays no further.

    Whoever puts real motors behind this keeps three promises: they stop `SILENCE` seconds after the last `send`, even
    if this process has died, so the watch is on the side of the motors; they stop on any error of theirs, and on
    `stop`, and hold what they have; and no command makes them move beyond the limits of their winch, which the stage
    keeps too.
    """

    @abstractmethod
    def send(self, contractions: Vector, now: float) -> None:
        """Go there; it returns at once.

        Args:
            contractions: of each winch [m].
            now: time of a clock that only runs forward [s].

        Raises:
            HydrostatError: it cannot be sent.
        """

    @abstractmethod
    def read(self, now: float) -> Vector:
        """What each winch has taken in at this time [m], as last heard of.

        Raises:
            HydrostatError: the motors report an error, or nothing.
        """

    @abstractmethod
    def stop(self) -> None:
        """Stay where it is. It may be called at any time and never raises."""

    @abstractmethod
    def close(self) -> None:
        """Stop, and let the motors go for good. It may be called twice and never raises."""
