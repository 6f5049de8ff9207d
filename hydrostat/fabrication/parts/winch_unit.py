"""`WinchUnit`: motor, spool and housing of one winch, as parts to print, an assembly, and what to mind."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from hydrostat.fabrication.parts.housing import Housing
from hydrostat.fabrication.parts.motor import Motor
from hydrostat.fabrication.parts.part_options import PartOptions
from hydrostat.fabrication.parts.spool import Spool
from hydrostat.fabrication.parts.spool_for import spool_for
from hydrostat.fabrication.parts.winch_parts import WinchParts
from hydrostat.fabrication.solids.assembly import Assembly
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Mount, Robot, Winch


@dataclass(frozen=True, kw_only=True)
class Exit:
    """Where a cable leaves a unit, in the unit's coordinates: the shaft is z, the face of the motor z = 0.

    Attributes:
        cable: index of the cable in the robot.
        point: in the outer face of the housing, in the middle of the seat of the tube [mm].
        direction: in which the cable leaves, of length 1.
        lead: cable from the spool to this point [mm].
        seat: how deep the tube goes in from this point [mm].
    """

    cable: int
    point: tuple[float, float, float]
    direction: tuple[float, float, float]
    lead: float
    seat: float


@dataclass(frozen=True, eq=False, kw_only=True)
class WinchUnit:
    """Motor, spool and housing of one winch; lengths in millimetres.

    Attributes:
        winch: its name.
        cables: index of each of its cables in the robot, in the order of the grooves.
        mount: where it is.
        motor: that turns it.
        housing: its sizes, with those of its spool.
        printed: what is printed for it, one of each.
        assembly: all of it, in its own coordinates, in the order in which it is put together.
        exits: of its cables.
        bought: what is bought for it besides the motor, and how many of each.
        across: whether its shaft stands across a flat body, with the roof to the front; else it lies in it.
        problems: why it cannot be built well.
        warnings: what to mind.
    """

    winch: str
    cables: tuple[int, ...]
    mount: Mount
    motor: Motor
    housing: Housing
    printed: tuple[Printed, ...]
    assembly: Assembly
    exits: tuple[Exit, ...]
    bought: tuple[tuple[str, int], ...]
    across: bool
    problems: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def spool(self) -> Spool:
        """Its sizes."""
        return self.housing.spool

    @property
    def low(self) -> tuple[float, float, float]:
        """Least corner of the box round the unit [mm]."""
        xs, ys = zip(*self.motor.outline, *self.housing.tongue, strict=True)
        return min(-self.housing.half, *xs), min(ys), -self.motor.depth

    @property
    def high(self) -> tuple[float, float, float]:
        """Largest corner of that box [mm]."""
        xs, ys = zip(*self.motor.outline, *self.housing.tongue, strict=True)
        return max(self.housing.half, *xs), max(ys), self.housing.top

    @property
    def size(self) -> tuple[float, float, float]:
        """Sides of that box [mm]: what a pocket for it must take."""
        (a, b, c), (x, y, z) = self.low, self.high
        return x - a, y - b, z - c


def winch_units(robot: Robot, options: PartOptions, motor: Motor) -> tuple[WinchUnit, ...]:
    """A unit for each winch that has cables, in winch order; equal parts have the same name."""
    parts = WinchParts()
    units = []
    for winch in robot.winches:
        cables = tuple(index for index, cable in enumerate(robot.cables) if cable.winch == winch.name)
        if cables:
            units.append(_unit(robot, winch, cables, options, motor, parts))
    return tuple(units)


def crowded(robot: Robot, units: Iterable[WinchUnit]) -> tuple[str, ...]:
    """Sentences for units in the body that stand closer than they are wide."""
    inside = [unit for unit in units if unit.mount is Mount.BODY]
    found = []
    for one, other in combinations(inside, 2):
        apart = 1e3 * math.dist(robot.winch(one.winch).at, robot.winch(other.winch).at)
        needed = one.housing.half + other.housing.half
        if apart < needed:
            found.append(
                f'winches "{one.winch}" and "{other.winch}" are {apart:.1f} mm apart, their housings need '
                f"{needed:.1f} mm: move one, or lay one above the other"
            )
    return tuple(found)


def _unit(
    robot: Robot,
    winch: Winch,
    cables: tuple[int, ...],
    options: PartOptions,
    motor: Motor,
    parts: WinchParts,
) -> WinchUnit:
    spool, problems, warnings = spool_for(robot, winch, cables, options, motor)
    outside = winch.mount is Mount.WORLD
    thickness = 1e3 * robot.body.thickness if robot.body.thickness is not None else None
    housing = Housing(motor=motor, spool=spool, azimuths=(90,) * len(cables), outside=outside, options=options)
    across = thickness is None or motor.depth + housing.top <= thickness
    azimuths = _azimuths(robot, cables, across=across, outside=outside)
    housing = Housing(motor=motor, spool=spool, azimuths=azimuths, outside=outside, options=options)
    printed, assembly = parts.of(housing, winch.name)
    unit = WinchUnit(
        winch=winch.name,
        cables=cables,
        mount=winch.mount,
        motor=motor,
        housing=housing,
        printed=printed,
        assembly=assembly,
        exits=tuple(_exit(housing, place, cable) for place, cable in enumerate(cables)),
        bought=_bought(housing),
        across=across,
        problems=problems,
        warnings=warnings,
    )
    return unit if thickness is None or outside else _checked_thickness(unit, thickness)


def _checked_thickness(unit: WinchUnit, thickness: float) -> WinchUnit:
    thinnest = min(unit.size)
    if thinnest <= thickness:
        return unit
    sides = " x ".join(f"{side:.0f}" for side in unit.size)
    text = (
        f'the unit of winch "{unit.winch}" is {sides} mm, thicker than the body of {thickness:.0f} mm: it will bulge; '
        "take a smaller motor or spool, or a thicker body"
    )
    return replace(unit, warnings=(*unit.warnings, text))


def _azimuths(robot: Robot, cables: tuple[int, ...], *, across: bool, outside: bool) -> tuple[int, ...]:
    """In which way each cable leaves [degrees]; the first along +y.

    Outside all leave towards the tubes. Across a flat body they leave as they go on, to the nearest quarter turn; where
    the unit lies, to one side or the other; in a body of space they are spread.
    """
    if outside:
        return (90,) * len(cables)
    if robot.body.mesh.dim == 3:
        return tuple((90 + 90 * round(4 * place / len(cables))) % 360 for place in range(len(cables)))
    steps = [np.subtract(robot.cables[index].points[1], robot.cables[index].points[0]) for index in cables]
    angles = [math.degrees(math.atan2(step[1], step[0])) for step in steps]
    quarter = 90 if across else 180
    return tuple((90 + quarter * round(_turned(angle - angles[0]) / quarter)) % 360 for angle in angles)


def _turned(angle: float) -> float:
    """The same between -180 and 180 degrees, a little towards 180, so that rounding noise changes nothing."""
    return (angle + 180 - 1e-6) % 360 - 180 + 1e-6


def _exit(housing: Housing, place: int, cable: int) -> Exit:
    angle = math.radians(housing.azimuths[place])
    cos, sin = round(math.cos(angle)), round(math.sin(angle))
    radius, half = housing.spool.grooves[place].radius, housing.half
    return Exit(
        cable=cable,
        point=(half * cos + radius * sin, half * sin - radius * cos, housing.height(place)),
        direction=(float(cos), float(sin), 0.0),
        lead=housing.lead,
        seat=housing.seat(place),
    )


def _bought(housing: Housing) -> tuple[tuple[str, int], ...]:
    motor, wall = housing.motor, housing.options.wall
    found = [(motor.screw.title(wall), len(motor.holes))]
    if motor.horn is not None:
        found.append((motor.horn.screw.title(wall), motor.horn.count))
    found.append((housing.screw.title, 4))
    if housing.outside:
        found.append(("M2 nut", 4))
    return tuple(found)
