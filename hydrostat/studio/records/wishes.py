"""`Wishes`: what a person asks of a design, and has painted on the body."""

from dataclasses import dataclass
from enum import StrEnum
from math import isfinite

from hydrostat.design import Zone
from hydrostat.errors import InputError


class Paint(StrEnum):
    """What a painted zone means; names of the fields of `hs.Constraints`."""

    WINCH_ZONES = "winch_zones"
    KEEP_OUT = "keep_out"
    STILL = "still"


@dataclass(frozen=True, kw_only=True)
class Wishes:
    """What a design shall be like.

    Attributes:
        winches: how many; 0: as few as will do.
        cables: how many in all.
        poses: names of the poses to reach; empty: all.
        zones: painted on the body, with what they mean.
        mirror: axis of symmetry, "x", "y" or "z"; None: no symmetry.
        tension: the most that a cable bears [N].
        clearance: least distance of a cable from the edge [m].
        tolerance: error that is good enough where winches are counted [m]; None: a hundredth of the body.
        cables_per_winch: most cables of one winch.
        slack: the most that a stopper may leave loose [m].
        stepped: whether cables may have spools up to twice as large or small as their winch's.
        torque: the most that the motor of a winch gives [N m]; None: as much as the tensions ask.
        improve: begin with the robot's own winches and cables.
        kept_winches: names of the robot's own winches that stay.
        kept_cables: numbers of the robot's own cables that stay, and their winches with them.

    Raises:
        InputError: a number out of its range.
    """

    winches: int = 2
    cables: int = 6
    poses: tuple[str, ...] = ()
    zones: tuple[tuple[Paint, Zone], ...] = ()
    mirror: str | None = None
    tension: float = 20.0
    clearance: float = 0.005
    tolerance: float | None = None
    cables_per_winch: int = 6
    slack: float = 0.0
    stepped: bool = False
    torque: float | None = None
    improve: bool = False
    kept_winches: tuple[str, ...] = ()
    kept_cables: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        for name, (least, most) in COUNTS.items():
            if not least <= getattr(self, name) <= most:
                raise InputError(f"{_said(name)} must be from {least} to {most}, not {getattr(self, name)}")
        for name, (most, scale, unit) in AMOUNTS.items():
            value: float | None = getattr(self, name)
            if value is None:
                continue
            least = "at least" if name == "slack" else "above"
            if not (isfinite(value) and 0 <= value <= most) or (value == 0 and name != "slack"):
                raise InputError(
                    f"{_said(name)} must be {least} 0 and at most {scale * most:g} {unit}, not {scale * value:g} {unit}"
                )


COUNTS = {"winches": (0, 20), "cables": (1, 60), "cables_per_winch": (1, 60)}
"""Least and most of each count."""

AMOUNTS = {
    "tension": (1000.0, 1.0, "N"),
    "clearance": (1.0, 1e3, "mm"),
    "tolerance": (1.0, 1e3, "mm"),
    "slack": (1.0, 1e3, "mm"),
    "torque": (100.0, 1.0, "N m"),
}
"""Most of each amount, and the unit in which it is told."""


def _said(name: str) -> str:
    return name.replace("_", " ")
