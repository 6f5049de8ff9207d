"""`Wishes`: a person's request for a design, with zones painted on the body."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

from hydrostat.closed_set import make_member
from hydrostat.design import (
    COUNTS,
    RANGES,
    ROUTE_RANGES,
    TREE_RANGES,
    Constraints,
    DesignMethod,
    DesignRequest,
    RouteOptions,
    TreeOptions,
    Zone,
)
from hydrostat.errors import InputError
from hydrostat.robot import Point
from hydrostat.units import quote


class Paint(StrEnum):
    """Meanings of painted zones: names of fields of `Constraints`."""

    WINCH_ZONES = "winch_zones"
    KEEP_OUT = "keep_out"
    STILL = "still"


@dataclass(frozen=True, kw_only=True)
class Wishes:
    """Request for a design.

    Raises:
        InputError: a number out of its range, a mirror that is no axis, or a method that there is not.
    """

    winches: int = int(DesignRequest.winches)  # how many; 0: as few as will do
    cables: int = DesignRequest.cables  # how many in all
    poses: tuple[str, ...] = ()  # names of the poses to reach; empty: all
    zones: tuple[tuple[Paint, Zone], ...] = ()  # painted on the body, with what they mean
    mirror: str | None = None  # axis of symmetry, "x", "y" or "z"; None: no symmetry
    tension: float = Constraints.tension  # the most that a cable bears [N]
    clearance: float = Constraints.clearance  # least distance of a cable from the edge [m]
    depth: float | None = None  # in space, of cables under the skin, 0 on it [m]; None: anywhere (R53)
    tolerance: float | None = None  # error good enough where winches are counted [m]; None: a hundredth of the body
    simplicity: float = RouteOptions.simplicity  # how much a simple network is worth; 0: whatever helps at all is kept
    cables_per_winch: int = Constraints.cables_per_winch  # most cables of one winch
    slack: float = Constraints.slack  # the most that a stopper may leave loose [m]
    stepped: bool = False  # whether cables may have spools up to twice as large or small as their winch's
    torque: float | None = None  # the most that the motor of a winch gives [N m]; None: as much as the tensions ask
    improve: bool = False  # begin with the robot's own winches and cables
    kept_winches: tuple[str, ...] = ()  # names of the robot's own winches that stay
    kept_cables: tuple[str, ...] = ()  # names of the robot's own cables that stay, and their winches with them

    method: DesignMethod = DesignRequest.method  # routes, ours, or the thesis's winch trees with the knobs that follow
    threshold: int = 60  # number of candidate fibres (R39)
    distance: float = 1.5  # largest gap between two fibres that are joined, in mean mesh edges (R40)
    steps: int = 12  # most fibres joined to one route (R40)
    phi: float = 0.5  # weight of the mean against the spread in the score (R43)

    @property
    def tree_options(self) -> TreeOptions:
        """The knobs of the thesis's search as wished (R46)."""
        return TreeOptions.single(threshold=self.threshold, distance=self.distance, steps=self.steps, phi=self.phi)

    def __post_init__(self) -> None:
        make_member(self, "method", DesignMethod)
        if self.mirror not in (None, "x", "y", "z"):
            raise InputError(f"mirror must be x, y, z or nothing, not {quote(self.mirror)}")
        if self.winches != 0 and not COUNTS["winches"].holds(self.winches):
            raise InputError(f"winches must be {COUNTS['winches']}, or 0 for as few as will do, not {self.winches}")
        for name, allowed in _COUNTED.items():
            if not allowed.holds(getattr(self, name)):
                raise InputError(f"{_said(name)} must be {allowed}, not {getattr(self, name)}")
        for name, (allowed, scale, unit) in _AMOUNTS.items():
            value = getattr(self, name)
            if not allowed.holds(value):
                words = allowed.words(scale, unit)
                raise InputError(f"{_said(name)} must be {words}, not {scale * value:g} {unit}")


def moved_zone(zone: Zone, move: Callable[[Point], Point]) -> Zone:
    """A zone whose places are moved."""
    at = None if zone.at is None else move(zone.at)
    box = None if zone.box is None else (move(zone.box[0]), move(zone.box[1]))
    return replace(zone, at=at, box=box, outline=tuple(map(move, zone.outline)))


_COUNTED = {
    "cables": COUNTS["cables"],
    "cables_per_winch": RANGES["cables_per_winch"],
    "simplicity": ROUTE_RANGES["simplicity"],
    "threshold": TREE_RANGES["thresholds"],
    "distance": TREE_RANGES["distances"],
    "steps": TREE_RANGES["growth_steps"],
    "phi": TREE_RANGES["phis"],
}

_AMOUNTS = {  # what each amount may be, and the unit in which it is told
    "tension": (RANGES["tension"], 1.0, "N"),
    "clearance": (RANGES["clearance"], 1e3, "mm"),
    "depth": (RANGES["depth"], 1e3, "mm"),
    "tolerance": (ROUTE_RANGES["tolerance"], 1e3, "mm"),
    "slack": (RANGES["slack"], 1e3, "mm"),
    "torque": (RANGES["torque"], 1.0, "N m"),
}


def _said(name: str) -> str:
    return name.replace("_", " ")
