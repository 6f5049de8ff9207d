"""`WinchUnit`: motor, spool and housing of one winch, as parts to print, an assembly, and what to mind."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.parts.housing import Housing, drive_of
from hydrostat.fabrication.parts.motor import Motor
from hydrostat.fabrication.parts.part_options import PartOptions
from hydrostat.fabrication.parts.spool import Groove, Spool, capacity, width_for, wraps
from hydrostat.fabrication.parts.winch_parts import WinchParts
from hydrostat.fabrication.solids.assembly import Assembly
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Mount, Robot, Winch

_LONGEST = 20.0
"""A spool is no longer than this where several layers can avoid it [mm]: its far end is held by a thin roof."""

_MOST_LAYERS = 6

_INSIDE = 1.2
"""The least of a shaft in a spool over its diameter: less, and a flat of plastic wears round."""

_SLOW = 10.0
"""A winch that takes longer for its full travel is called slow [s]."""


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


def winch_units(robot: Robot, demand: Demand, options: PartOptions, motor: Motor) -> tuple[WinchUnit, ...]:
    """A unit for each winch that has cables, in winch order; equal parts have the same name."""
    parts = WinchParts()
    units = []
    for winch, torque in zip(robot.winches, demand.torques, strict=True):
        cables = tuple(index for index, cable in enumerate(robot.cables) if cable.winch == winch.name)
        if cables:
            units.append(_unit(robot, winch, cables, 1e3 * float(torque), options, motor, parts))
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
    torque: float,
    options: PartOptions,
    motor: Motor,
    parts: WinchParts,
) -> WinchUnit:
    spool, problems, warnings = _spool(robot, winch, cables, options, motor)
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
        warnings=(*warnings, *_motor_warnings(winch, torque, motor)),
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


def _spool(
    robot: Robot, winch: Winch, cables: tuple[int, ...], options: PartOptions, motor: Motor
) -> tuple[Spool, tuple[str, ...], tuple[str, ...]]:
    problems, warnings = [], []
    drive = drive_of(motor, options)
    diameter = motor.shaft.diameter
    if drive.inside < _INSIDE * diameter:
        problems.append(
            f'winch "{winch.name}": only {max(drive.inside, 0):.1f} mm of the shaft of {motor.title} would be in the '
            f"spool, {_INSIDE * diameter:.1f} mm are needed: take thinner walls or another motor"
        )
    least = diameter / 2 + options.fit + options.wall + options.cable / 2
    radii = []
    for index in cables:
        radius = 1e3 * (robot.cables[index].spool_radius or winch.spool_radius)
        if radius < least - 1e-9:
            problems.append(
                f'winch "{winch.name}": spool radius {radius:.2f} mm of cable C{index + 1} is too small for the shaft '
                f"of {motor.title} in a wall of {options.wall:g} mm: at least {least:.2f} mm"
            )
        radii.append(max(radius, least))
    turns = wraps(1e3 * (winch.travel + winch.release), 1e3 * winch.spool_radius, options.spare_wraps)
    spool, fits = _wound(radii, turns, drive.inside, options, motor)
    if not fits:
        problems.append(
            f'winch "{winch.name}": {turns:.1f} turns of cable do not fit on a spool of {_LONGEST:g} mm in '
            f"{_MOST_LAYERS} layers: take a larger spool radius or less travel"
        )
    for index, groove in zip(cables, spool.grooves, strict=True):
        if groove.layers > 1:
            outer = groove.radius + (groove.layers - 1) * options.cable
            warnings.append(
                f'cable C{index + 1} of winch "{winch.name}" lies in {groove.layers} layers: its radius grows from '
                f"{groove.radius:.1f} to {outer:.1f} mm, so the last turns take in "
                f"{100 * (outer / groove.radius - 1):.0f} % more than was simulated (E13)"
            )
    return spool, tuple(problems), tuple(warnings)


def _wound(
    radii: Sequence[float], turns: float, inside: float, options: PartOptions, motor: Motor
) -> tuple[Spool, bool]:
    """The spool with the fewest layers that is short enough, and whether there is one."""
    journal = options.clearance + max(options.wall, 2.0) - 0.2
    spool = None
    for layers in range(1, _MOST_LAYERS + 1):
        grooves = tuple(_groove(radius, turns, layers, options.cable) for radius in radii)
        spool = Spool(
            grooves=grooves,
            cable=options.cable,
            shaft=motor.shaft,
            inside=max(inside, 0.5),
            play=options.fit,
            wall=options.wall,
            journal=journal,
        )
        if spool.body <= _LONGEST:
            return spool, True
    assert spool is not None
    return spool, False


def _groove(radius: float, turns: float, layers: int, cable: float) -> Groove:
    """The narrowest that takes so many turns of the first layer's length in these layers."""
    length = turns * 2 * math.pi * radius
    one_turn = capacity(cable * 2.25, radius, cable, layers)
    return Groove(radius=radius, width=width_for(length / one_turn, cable), layers=layers)


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


def _motor_warnings(winch: Winch, torque: float, motor: Motor) -> tuple[str, ...]:
    asks = f'winch "{winch.name}" asks for {torque:.0f} N mm'
    if torque >= motor.stall_torque:
        return (f"{asks}, {motor.title} stalls at {motor.stall_torque:.0f} N mm: it cannot reach the poses",)
    found = []
    if torque > motor.rated_torque:
        found.append(
            f"{asks}, {motor.title} should carry {motor.rated_torque:.0f} N mm at most: hold such poses briefly"
        )
    speed = motor.speed / 60 * 2 * math.pi * winch.spool_radius * (1 - torque / motor.stall_torque)
    if winch.travel / speed > _SLOW:
        found.append(
            f'winch "{winch.name}" takes {winch.travel / speed:.0f} s for its travel of {1e3 * winch.travel:.0f} mm '
            f"with {motor.title} under its largest load"
        )
    return tuple(found)
