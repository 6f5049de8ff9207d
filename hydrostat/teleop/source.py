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
    """Contract of a hand input: a glove, a camera, a gamepad. A new kind is one class.

    Attributes:
        names: sensor names.
    """

    names: tuple[str, ...]

    @abstractmethod
    def read(self) -> HandReading:
        """The newest values (HydrostatError: no reading, or a wrong one; values are never made up)."""

    @abstractmethod
    def close(self) -> None:
        """Let it go. It may be called twice and never raises."""


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
        stamp: when the person was last heard, by a clock that only runs forward [s].
        places: target positions of channels by name [m]; others stay.
        steps: increments of channels since the last request, by name [m].
        hold: True to hold the motors.
        over: True to end.
        words: to be shown beside the motors.
    """

    stamp: float
    places: Mapping[str, float] = field(default_factory=dict)
    steps: Mapping[str, float] = field(default_factory=dict)
    hold: bool = False
    over: bool = False
    words: str = ""


class DriveSource(ABC):
    """Contract of what a robot is driven by: keys, knobs, a glove. A new kind is one class and a line in `SOURCES`.

    Nothing that it asks for can leave the limits of the motors, nor move them faster than they may.

    Attributes:
        silence: a stamp that is older than this means that nobody drives, so motors hold [s]; infinite where a word
            holds until the next, as that of a knob.
        updated: event set on a newer request, if somebody waits for it and the source can tell.
    """

    silence: float = inf
    updated: Event | None = None

    @abstractmethod
    def read(self) -> DriveWish:
        """The newest request, immediately (HydrostatError: input lost)."""

    @abstractmethod
    def close(self) -> None:
        """Let it go. It may be called twice and never raises."""
