"""The form of a file of constraints: its keys and units, as pydantic models."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field, Strict

from hydrostat.robot import Mount
from hydrostat.robot.schema import Angle, Coordinates, Force, Length, Name, Number, Table, Torque

Count = Annotated[int, Strict()]
Choice = Annotated[bool, Strict()]


class Axis(StrEnum):
    """Across a mirror."""

    X = "x"
    Y = "y"
    Z = "z"


class ZoneTable(Table):
    """[[winch_zone]], [[keep_out]], [[still]]."""

    at: Coordinates | None = None
    radius: Number | None = None
    box: Annotated[list[Coordinates], Field(min_length=2, max_length=2)] | None = None
    outline: Annotated[list[Coordinates], Field(min_length=3, max_length=1000)] | None = None


class ConstraintsTable(Table):
    """The whole file: the fields of `Constraints`, zones as tables of one zone each."""

    winch_zone: list[ZoneTable] = Field(default_factory=list)
    keep_out: list[ZoneTable] = Field(default_factory=list)
    still: list[ZoneTable] = Field(default_factory=list)
    mount: Mount | None = None
    cables_per_winch: Count | None = None
    clearance: Length | None = None
    winch_clearance: Length | None = None
    winch_gap: Length | None = None
    hole_gap: Length | None = None
    turn: Angle | None = None
    bend_radius: Length | None = None
    longest: Length | None = None
    tension: Force | None = None
    torque: Torque | None = None
    travel: Length | None = None
    release: Length | None = None
    spool_radius: Length | None = None
    slack: Length | None = None
    spool_ratio: Number | None = None
    leads: Choice | None = None
    mirror: Axis | None = None
    locked_winches: list[Name] | None = None
    locked_cables: list[Count] | None = None
