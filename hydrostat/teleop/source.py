"""`DriveSource`: the contract of what drives a robot, by `DriveWish`es for `DriveChannels`."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf
from threading import Event

from hydrostat.arrays import Vector


@dataclass(frozen=True, eq=False)
class HandReading:
    """Sensor reading of a hand.

    Attributes:
        values: sensor values, each from 0 to 1.
        stamp: when they were heard, by a clock that only runs forward [s].
    """

    values: Vector
    stamp: float


class HandSource(ABC):
    """Interface for hand inputs: a glove, a camera, a gamepad. A new kind is one class.

    Attributes:
        names: sensor names.
    """

    names: tuple[str, ...]

    @abstractmethod
    def read(self) -> HandReading:
        """Return the latest values (HydrostatError: no reading, or an invalid one; values are never invented)."""

    @abstractmethod
    def close(self) -> None:
        """Close the input. You can call this twice, and it never raises."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DriveChannels:
    """Channels that a person may command: winches, or coordinates of fingertips.

    Attributes:
        names: channel names.
        low: least value of each [m].
        high: largest [m].
        rest: value where the body is at rest [m].
        groups: numbers of those that belong together: a winch alone, the coordinates of a marker.
    """

    names: tuple[str, ...]
    low: Vector
    high: Vector
    rest: Vector
    groups: tuple[tuple[int, ...], ...]

    def title(self, group: int) -> str:
        """Name of a group: of its winch, or of its marker."""
        first = self.names[self.groups[group][0]]
        return first if len(self.groups[group]) == 1 else first.rpartition(" ")[0]


@dataclass(frozen=True, kw_only=True, eq=False)
class DriveWish:
    """Command of a person at one instant.

    Attributes:
        stamp: time of the last input, by a monotonic clock [s].
        places: target values of channels by name [m]; other channels stay.
        steps: increments of channels since the last request, by name [m].
        hold: True to hold the motors.
        over: True to end.
        words: message to show next to the motors.
    """

    stamp: float
    places: Mapping[str, float] = field(default_factory=dict)
    steps: Mapping[str, float] = field(default_factory=dict)
    hold: bool = False
    over: bool = False
    words: str = ""


class DriveSource(ABC):
    """Interface for inputs: keys, knobs, a glove. A new kind is one class and a line in `SOURCES`.

    Its commands cannot leave the limits of the motors or exceed their speed.

    Attributes:
        silence: age of the last input after which motors hold [s]; infinite if a command stays valid until the next,
            as for a knob.
        updated: event that is set on a new command; None if the source cannot set one.
    """

    silence: float = inf
    updated: Event | None = None

    @abstractmethod
    def read(self) -> DriveWish:
        """Return the latest command immediately (HydrostatError: input lost)."""

    @abstractmethod
    def close(self) -> None:
        """Close the input. You can call this twice, and it never raises."""
