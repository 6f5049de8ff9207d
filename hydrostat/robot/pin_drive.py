"""`PinDrive`: an actuator that turns or slides pins, such as a servo or a linear stage."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal

import numpy as np

from hydrostat import units
from hydrostat.arrays import Points, Vector
from hydrostat.errors import InputError
from hydrostat.given import Point, check_name, check_number, check_point, list_choices
from hydrostat.robot.cable import Cable
from hydrostat.robot.load import Load
from hydrostat.robot.load_drive import LoadDrive, check_load_drives
from hydrostat.robot.pin import Pin
from hydrostat.robot.winch import Winch


@dataclass(frozen=True, kw_only=True)
class PinDrive:
    """Actuator that rotates the pins that name it about an axis, or slides them along a direction.

    Attributes:
        name: name, unique among drives and winches.
        at: point on the axis of rotation [m]; None for a slide.
        axis: direction of the axis, in space only; angles count by the right-hand rule, in the plane from x to y.
        slide: direction of travel; None for a rotation.
        min: least angle [rad] or travel [m]; None for -180 degrees.
        max: largest angle [rad] or travel [m]; None for 180 degrees.

    Raises:
        InputError: both or neither of `at` and `slide`, a direction of length 0, or limits that do not include 0.
    """

    name: str
    at: Point | None = None
    axis: tuple[float, ...] | None = None
    slide: tuple[float, ...] | None = None
    min: float | None = None
    max: float | None = None

    def __post_init__(self) -> None:
        check_name(self.name)
        if (self.at is None) == (self.slide is None):
            raise InputError("give either at (a point of the axis that it turns about) or slide (a direction)")
        if self.axis is not None and self.at is None:
            raise InputError("axis goes with at; remove it from a slide")
        for key in ("at", "axis", "slide"):
            if (point := getattr(self, key)) is not None:
                check_point(key, point)
                if key != "at" and not any(point):
                    raise InputError(f"{key} has no length; give a direction, such as [0, 0, 1]")
        if self.at is not None and (len(self.at) == 3) != (self.axis is not None):
            raise InputError("in space a rotation needs axis, such as [0, 0, 1]; in the plane it has none")
        if self.axis is not None and len(self.axis) != 3:
            raise InputError(f"axis has {len(self.axis)} coordinates; a direction in space has three")
        self._set_limits()

    def _set_limits(self) -> None:
        for key, sign in (("min", -1), ("max", 1)):
            if (value := getattr(self, key)) is None:
                if not self.turns:
                    raise InputError('a slide needs its travel, such as min = "0 mm" and max = "20 mm"')
                object.__setattr__(self, key, sign * math.pi)
                continue
            check_number(key, value, self.unit)
            if not 0 <= sign * value < math.inf:
                raise InputError(f"{key} must not be {'above' if sign < 0 else 'below'} 0, where the robot rests")
            if self.turns and abs(value) > _MAX_TURN:
                raise InputError(f"{key} is {math.degrees(value):.4g} deg; the angle must be within one turn, 360 deg")

    @property
    def turns(self) -> bool:
        """True for a rotation, whose value is an angle [rad]; False for a slide [m]."""
        return self.slide is None

    @property
    def unit(self) -> str:
        """Unit of its value: rad or m."""
        return "rad" if self.turns else "m"

    @property
    def limits(self) -> tuple[float, float]:
        """Least and largest value [rad or m]."""
        assert self.min is not None
        assert self.max is not None
        return self.min, self.max

    def limit_texts(self) -> tuple[str, str]:
        """Limits as texts with units; they read back to exactly the same values."""
        low, high = self.limits
        if not self.turns:
            return units.format_quantity(low, units.LENGTH), units.format_quantity(high, units.LENGTH)
        return format_angle(low), format_angle(high)

    def format_value(self, value: float) -> str:
        """Return a value as text, in degrees or millimeters."""
        return f"{math.degrees(value):.4g} deg" if self.turns else f"{1e3 * value:.4g} mm"

    @property
    def column(self) -> tuple[str, float]:
        """Column header in tables, and the factor from SI to degrees or millimeters."""
        return (f"{self.name}_deg", math.degrees(1.0)) if self.turns else (f"{self.name}_mm", 1e3)

    def with_transform(self, move: Callable[[Point], Point], scale: Callable[[float], float]) -> "PinDrive":
        """Return the same drive with its axis moved, or its travel [m] scaled."""
        if self.at is not None:
            return replace(self, at=move(self.at))
        low, high = self.limits
        return replace(self, min=scale(low), max=scale(high))

    def directions(self, points: Points) -> tuple[Points, Points]:
        """Return D and E: points move by sin(a) D + (1 - cos a) E if turned by a, or by a D if they slide [m or 1]."""
        if self.slide is not None:
            way = np.array(self.slide, dtype=float)
            return np.tile(way / np.linalg.norm(way), (len(points), 1)), np.zeros_like(points)
        arms = points - np.array(self.at, dtype=float)
        if self.axis is None:
            return np.stack([-arms[:, 1], arms[:, 0]], axis=1), -arms
        axis = np.array(self.axis, dtype=float) / np.linalg.norm(self.axis)
        first = np.cross(axis, arms)
        return first, np.cross(axis, first)

    def move(self, points: Points, value: float) -> Points:
        """Return the positions of rest points [m] at a drive value [rad or m]."""
        first, second = self.directions(points)
        return points + (np.sin(value) * first + (1 - np.cos(value)) * second if self.turns else value * first)

    @staticmethod
    def require_none(drives: "Sequence[PinDrive | LoadDrive]", what: str) -> None:
        """Reject a robot with drives where only winches can be controls (InputError: it has a drive)."""
        if drives:
            raise InputError(f'drives, such as "{drives[0].name}", are not available in {what}. Remove them.')

    @staticmethod
    def check_values(drives: "Sequence[PinDrive | LoadDrive]", values: Iterable[float]) -> list[str]:
        """Return a text that names drives beyond their limits; empty if none is."""
        hair = 1e-9  # Tolerance for rounding errors [rad or m]
        told = []
        for drive, value in zip(drives, values, strict=True):
            low, high = drive.limits
            if not low - hair <= value <= high + hair:
                between = f"{drive.format_value(low)} to {drive.format_value(high)}"
                told.append(f"drive {drive.name}: {drive.format_value(value)} is outside its range ({between})")
        return told

    @staticmethod
    def check_radians(drives: "Sequence[PinDrive | LoadDrive]", values: Vector) -> None:
        """Reject angles that are degrees (InputError: more than a turn)."""
        for drive, value in zip(drives, values, strict=True):
            if drive.turns and abs(value) > _MAX_TURN:
                raise InputError(
                    f'the angle of drive "{drive.name}", {value:g} rad, is more than a turn; angles are in radians: '
                    "30 degrees are 0.5236"
                )

    def parse(self, text: str) -> float:
        """Return the value of a text [rad or m], as `parse_value`."""
        return self.parse_value(text, turns=self.turns)

    @staticmethod
    def parse_value(text: str, *, turns: bool) -> float:
        """Return the angle [rad] or travel [m] from a text such as "30 deg" or "-5 mm" (InputError: invalid)."""
        bare = text.strip()
        sign = -1.0 if bare.startswith("-") else 1.0
        value = units.parse_quantity(bare.removeprefix("-"), units.ANGLE if turns else units.LENGTH)
        return sign * (math.radians(value) if turns else value)


def check_drives(
    drives: Sequence[PinDrive | LoadDrive],
    driven: tuple[Sequence[Pin], Sequence[Load]],
    winches: Sequence[Winch],
    cables: Sequence[Cable],
    dim: int,
) -> None:
    """Reject drives that move no pin or load, unknown drives, names given twice and directions of another space."""
    pins, loads = driven
    check_load_drives([drive for drive in drives if isinstance(drive, LoadDrive)], loads)
    if drives and any(cable.friction for cable in cables):
        raise InputError("drive[0]: not available with cable friction. Remove friction from the cables.")
    names = [drive.name for drive in drives if isinstance(drive, PinDrive)]
    used, taken = {pin.drive for pin in pins}, {winch.name for winch in winches}
    for index, pin in enumerate(pins):
        if pin.drive is not None and pin.drive not in names:
            known = list_choices("drives of pins", names)
            raise InputError(f'pin[{index}].drive: unknown drive "{pin.drive}". {known}')
    for index, drive in enumerate(drives):
        if drive.name in taken:
            raise InputError(f'drive[{index}].name: "{drive.name}" is already the name of a drive or winch')
        taken.add(drive.name)
        if isinstance(drive, LoadDrive):
            continue
        key = "slide" if drive.at is None else "at"
        if (count := len(drive.slide or drive.at or ())) != dim:
            raise InputError(f"drive[{index}].{key} has {count} coordinates, but the body has {dim}")
        if drive.name not in used:
            raise InputError(f'drive[{index}]: moves no pin. Add drive = "{drive.name}" to a [[pin]].')


def format_angle(value: float) -> str:
    """Shortest text in degrees that reads back to an angle [rad]."""
    degrees = math.degrees(value)
    near = [degrees, math.nextafter(degrees, math.inf), math.nextafter(degrees, -math.inf)]
    tried = [f"{degrees:.{digits}g}" for digits in range(1, 18)] + [repr(each) for each in near]
    texts = [f"{units.plain(Decimal(each))} deg" for each in tried]
    return next((text for text in texts if PinDrive.parse_value(text, turns=True) == value), texts[-3])


_MAX_TURN = 2 * math.pi
