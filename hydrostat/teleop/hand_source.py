"""`HandSource`: the contract of what tells where a hand is."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

from hydrostat.arrays import Vector


@dataclass(frozen=True, eq=False)
class HandReading:
    """Sensor reading of a hand.

    Attributes:
        values: of its sensors, each from 0 to 1.
        stamp: when they were heard, by a clock that only runs forward [s].
    """

    values: Vector
    stamp: float


class HandSource(ABC):
    """Contract of what tells where a hand is: a glove, a camera, a gamepad. A new kind is one class.

    Attributes:
        names: of its sensors.
    """

    names: tuple[str, ...]

    @abstractmethod
    def read(self) -> HandReading:
        """The newest values (HydrostatError: nothing is heard, or what is heard is wrong; nothing is made up)."""

    @abstractmethod
    def close(self) -> None:
        """Let it go. It may be called twice and never raises."""
