"""`Wishes`: what a person asks of a design, and has painted on the body."""

from dataclasses import dataclass
from enum import StrEnum

from hydrostat.design import Zone


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
    """

    winches: int = 2
    cables: int = 6
    poses: tuple[str, ...] = ()
    zones: tuple[tuple[Paint, Zone], ...] = ()
    mirror: str | None = None
    tension: float = 20.0
    clearance: float = 0.005
    tolerance: float | None = None
