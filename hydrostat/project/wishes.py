"""`Wishes`: a person's request for a design, with zones painted on the body."""

from dataclasses import asdict, dataclass, field, fields, replace
from enum import StrEnum
from numbers import Real
from typing import Any

from hydrostat.closed_set import make_member
from hydrostat.design import (
    Constraints,
    DesignMethod,
    DesignRequest,
    RouteOptions,
    TreeOptions,
    TreeSettings,
    Zone,
)
from hydrostat.errors import InputError
from hydrostat.robot import PoseTarget, Robot
from hydrostat.units import quote


class Paint(StrEnum):
    """Meanings of painted zones, as studio.json names them."""

    WINCH_ZONES = "winch_zones"
    KEEP_OUT = "keep_out"
    STILL = "still"

    @property
    def constraint(self) -> str:
        """Name of the field of `Constraints` that holds these zones."""
        return "passive_zones" if self is Paint.STILL else self.value


@dataclass(frozen=True, kw_only=True)
class Wishes:
    """Request for a design: the records that a design takes, and names and zones that outlive changes of the robot.

    `of`, `with_values` and `value` reach fields of the records by their names, in ranges of a person's units; "stepped"
    is whether cables may have spools up to twice as large or small as their winch's.

    Raises:
        InputError: a number out of its range, or an unknown method.
    """

    winches: int = int(DesignRequest.winches)  # number of winches; 0: as few as will do
    cables: int = DesignRequest.cables  # number of cables in total
    poses: tuple[str, ...] = ()  # names of the poses to reach; empty: all
    zones: tuple[tuple[Paint, Zone], ...] = ()  # painted on the body, with their meanings
    constraints: Constraints = field(default_factory=Constraints)  # without zones and parts to keep, which stand here
    improve: bool = False  # begin with the robot's own winches and cables
    kept_winches: tuple[str, ...] = ()  # names of the robot's own winches that stay
    kept_cables: tuple[str, ...] = ()  # names of the robot's own cables that stay, and their winches with them
    method: DesignMethod = DesignRequest.method  # routes, ours, or the thesis's winch trees
    options: RouteOptions = field(default_factory=RouteOptions)  # of the search for routes
    knobs: TreeSettings = field(default_factory=TreeSettings)  # of the search for winch trees

    def __post_init__(self) -> None:
        make_member(self, "method", DesignMethod)
        if self.winches != 0 and not DesignRequest.ranges()["winches"].holds(self.winches):
            raise InputError(
                f"winches must be {DesignRequest.ranges()['winches']}, or 0 for as few as will do, not {self.winches}"
            )
        if not DesignRequest.ranges()["cables"].holds(self.cables):
            raise InputError(f"cables must be {DesignRequest.ranges()['cables']}, not {self.cables}")

    @classmethod
    def of(cls, **values: Any) -> "Wishes":
        """Wishes with these values, else the usual ones (InputError: a value out of its range)."""
        return cls().with_values(**values)

    def with_values(self, **values: Any) -> "Wishes":
        """Copy with other values (InputError: one is out of its range)."""
        changes: dict[str, dict[str, Any]] = {"": {}}
        for name, value in values.items():
            _check(name, value)
            key, told = ("spool_ratio", Constraints.STEPPED if value else 1.0) if name == "stepped" else (name, value)
            changes.setdefault(_record(key), {})[key] = told
        own = changes.pop("")
        return replace(self, **own, **{part: replace(getattr(self, part), **new) for part, new in changes.items()})

    def value(self, name: str) -> Any:
        """Value of a field, of its own or of one of its records."""
        if name == "stepped":
            return self.constraints.spool_ratio > 1.0
        part = _record(name)
        return getattr(getattr(self, part) if part else self, name)

    @property
    def tree_options(self) -> TreeOptions:
        """Options of the thesis's search with these knobs (R46)."""
        return TreeOptions.single(**asdict(self.knobs))

    def to_constraints(self, robot: Robot) -> Constraints:
        """Constraints of the design settings, without parts to keep that are gone (InputError: impossible limits)."""
        zones: dict[str, Any] = {
            paint.constraint: tuple(zone for other, zone in self.zones if other is paint) for paint in Paint
        }
        names = {winch.name for winch in robot.winches}
        return replace(
            self.constraints,
            **zones,
            depth=self.constraints.depth if robot.body.mesh.dim == 3 else None,
            locked_winches=tuple(name for name in self.kept_winches if name in names),
            locked_cables=tuple(cable.name for cable in robot.cables if cable.name in self.kept_cables),
        )

    def to_poses(self, robot: Robot) -> tuple[PoseTarget, ...]:
        """The poses to reach: those that are named and still there.

        All if none is (InputError: the robot has no pose).
        """
        if not robot.poses:
            raise InputError("no poses to design for. Drag the body in Pose and store a pose")
        named = [pose for name, pose in robot.poses.items() if name in self.poses]
        return tuple(named or robot.poses.values())


OWN = tuple(one.name for one in fields(Wishes))
"""Fields that stand in `Wishes` itself, and the records that it has."""

OPTIONS = ("tolerance", "simplicity")
"""Fields of `RouteOptions` that can be wished."""

ELSEWHERE = (*(paint.constraint for paint in Paint), "locked_winches", "locked_cables", "spool_ratio")
"""Fields of `Constraints` that are wished by other names: as `zones`, `kept_winches`, `kept_cables` and "stepped"."""


WISH_RANGES = {
    **Constraints.ranges(),
    **{name: RouteOptions.ranges()[name] for name in OPTIONS},
    **TreeSettings.ranges(),
}
"""Allowed values of the numbers in the records of `Wishes`."""


def _record(name: str) -> str:
    """Field of `Wishes` that holds the record with a value; "" for its own values."""
    if name in OWN:
        return ""
    return "knobs" if name in TreeSettings.ranges() else "options" if name in OPTIONS else "constraints"


def _check(name: str, value: Any) -> None:
    """Refuse a value that its record would refuse, in a person's units."""
    if name == "mirror":
        _check_mirror(value)
    allowed = WISH_RANGES.get(name)
    if allowed is None or allowed.holds(value):
        return
    words = name.replace("_", " ")
    if not allowed.unit:
        raise InputError(f"{words} must be {allowed}, not {value}")
    scale, unit = allowed.display_unit
    is_number = isinstance(value, Real) and not isinstance(value, bool)
    told = f"{scale * float(value):g} {unit}" if is_number else "nothing" if value is None else quote(value)
    raise InputError(f"{words} must be {allowed.words(scale, unit)}, not {told}")


def _check_mirror(value: object) -> None:
    if value not in (None, "x", "y", "z"):
        raise InputError(f"mirror must be x, y, z or nothing, not {quote(value)}")
