"""`Held`, `Wish`: what a person holds where, as one value that is replaced whole."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from hydrostat.robot import Point


class Mode(StrEnum):
    """What moves the body."""

    MUSCLES = "muscles"
    CABLES = "cables"


@dataclass(frozen=True, kw_only=True)
class Held:
    """A point of the body with the place where it should be.

    Attributes:
        at: where it is in the rest shape [m].
        target: where it should go [m].
        marker: whether it is a marker of the robot; else it is a plain point, though it may become one.
    """

    at: Point
    target: Point
    marker: bool = False


@dataclass(frozen=True, kw_only=True)
class Wish:
    """All that a person wants of the body just now.

    Attributes:
        mode: what moves it.
        held: points by name; those with the name of a marker are that marker.
        rests: counts how often it was sent back to rest.
    """

    mode: Mode
    held: Mapping[str, Held] = field(default_factory=dict)
    rests: int = 0
