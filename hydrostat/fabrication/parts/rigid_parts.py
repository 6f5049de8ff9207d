"""`rigid_parts`: all that is printed and bought besides the body: winches, their base, stoppers, grommets."""

import math
from collections import Counter
from dataclasses import dataclass, replace

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_options import PartOptions, StopperKind
from hydrostat.fabrication.parts.base_plate import BasePlate, base_plate
from hydrostat.fabrication.parts.body_seat import BodySeat, body_seat
from hydrostat.fabrication.parts.cleat import cleat
from hydrostat.fabrication.parts.motor import Motor
from hydrostat.fabrication.parts.stopper import Stopper, screw_stopper
from hydrostat.fabrication.parts.winch_unit import WinchUnit, find_crowded_units, winch_units
from hydrostat.fabrication.solids.assembly import PartAssembly
from hydrostat.fabrication.solids.construct import Construction, Cylinder, Revolve
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Robot

_STOPPERS = {StopperKind.CLEAT: cleat, StopperKind.SCREW: screw_stopper}


@dataclass(frozen=True, eq=False, kw_only=True)
class RigidParts:
    """The rigid parts of one robot."""

    motor: Motor  # motor of all winches
    units: tuple[WinchUnit, ...]  # a winch each
    base: BasePlate | None  # for winches outside the body; None if all are in it
    seat: BodySeat  # for a body whose winches stand outside; empty if there is none
    stopper: Stopper | None  # one for each cable; None without cables
    grommet: Printed | None  # one for each pinhole, counted; None without pinholes
    cables: int  # number of cables
    between: tuple[str, ...] = ()  # warnings about winches side by side

    @property
    def printed(self) -> tuple[Printed, ...]:
        """All that is printed: equal parts once, with how many are needed and for which winches."""
        found: dict[str, Printed] = {}
        winches: dict[str, list[str]] = {}
        for unit in self.units:
            for part in unit.printed:
                found[part.name] = part
                winches.setdefault(part.name, []).append(unit.winch)
        parts = [_for_winches(found[name], tuple(own), len(self.units)) for name, own in sorted(winches.items())]
        if self.base is not None:
            parts += self.base.printed
        parts += self.seat.printed
        if self.stopper is not None:
            parts += [replace(part, count=self.cables * part.count) for part in self.stopper.printed]
        if self.grommet is not None:
            parts.append(self.grommet)
        return tuple(parts)

    @property
    def bought(self) -> tuple[tuple[str, int], ...]:
        """Motors and screws, and how many of each."""
        counts: Counter[str] = Counter()
        for unit in self.units:
            counts[unit.motor.title] += 1
        for one in (*self.units, self.seat, *((self.base,) if self.base else ())):
            counts.update(dict(one.bought))
        if self.stopper is not None and self.stopper.screw is not None:
            counts[self.stopper.screw] += self.cables
        return tuple(counts.items())

    @property
    def screws(self) -> dict[str, int]:
        """Number of screws and nuts by what they are called."""
        return {title: count for title, count in self.bought if title != self.motor.title}

    @property
    def leads(self) -> dict[int, float]:
        """Length of each cable from the exit of its winch to its spool [mm], by its index."""
        return {way.cable: way.lead for unit in self.units for way in unit.exits}

    @property
    def seats(self) -> dict[int, float]:
        """Depth of the seat of the tube of each cable at its winch [mm], by its index."""
        swapped = self.base is not None and self.base.bare > 0  # no tube goes into a housing then
        return {way.cable: 0.0 if swapped else way.seat for unit in self.units for way in unit.exits}

    @property
    def outside(self) -> dict[int, float]:
        """Length of the tube from the base with the motors to where a cable begins [mm], by its index."""
        return dict(self.base.tubes) if self.base else {}

    @property
    def tubes(self) -> dict[int, float]:
        """Length of that in a tube [mm], by the index of the cable."""
        return {cable: length - (self.base.bare if self.base else 0.0) for cable, length in self.outside.items()}

    @property
    def stopper_hold(self) -> float | None:
        """Tension at which a cable begins to slip in its stopper [N]; None without stoppers."""
        return self.stopper.hold if self.stopper else None

    @property
    def begin_stopper(self) -> str:
        """Command that puts a stopper on for the time being; empty without stoppers."""
        return self.stopper.begin if self.stopper else ""

    @property
    def winch_assembly(self) -> PartAssembly | None:
        """The winch with the most cables; None without winches."""
        largest = max(self.units, key=lambda unit: len(unit.cables), default=None)
        return largest.assembly if largest else None

    @property
    def base_assembly(self) -> PartAssembly | None:
        """The base with the winches that stand outside the body; None if all are in it."""
        return self.base.assembly if self.base else None

    @property
    def seat_assembly(self) -> PartAssembly | None:
        """The seat of the body; None where none is made."""
        return self.seat.assembly

    @property
    def stopper_assembly(self) -> PartAssembly | None:
        """The stopper of a cable; None without cables."""
        return self.stopper.assembly if self.stopper else None

    @property
    def assemblies(self) -> tuple[PartAssembly, ...]:
        """Each winch, the base with all on it, the seat, the stopper."""
        found = (
            *(unit.assembly for unit in self.units),
            self.base_assembly,
            self.seat_assembly,
            self.stopper_assembly,
        )
        return tuple(assembly for assembly in found if assembly is not None)

    @property
    def problems(self) -> tuple[str, ...]:
        """Reasons why they cannot be built well."""
        base = self.base.problems if self.base else ()
        return (*(text for unit in self.units for text in unit.problems), *base, *self.seat.problems)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings for the builder, one sentence each."""
        base = self.base.warnings if self.base else ()
        return (*(text for unit in self.units for text in unit.warnings), *self.between, *base, *self.seat.warnings)

    @property
    def notes(self) -> tuple[str, ...]:
        """Information for the builder, one sentence each."""
        return tuple(text for unit in self.units for text in unit.notes)


def rigid_parts(
    robot: Robot,
    *,
    motor: str,
    options: PartOptions,
    bed: tuple[float, float, float],
    holes: int = 0,
    hole: float = 2.0,
) -> RigidParts:
    """The rigid parts of a robot.

    The motor is a key of the table; the bed is the largest piece that the printer takes, along x, y and z
    [mm]; so many pinholes of the diameter `hole` [mm] get a grommet. Raises InputError: there is no such motor, or a
    pinhole is too small for a grommet.
    """
    chosen = Motor.choose(motor)
    units = winch_units(robot, options, chosen)
    seat = body_seat(robot, options, bed)
    base = base_plate(robot, units, options, bed, held=seat.held)
    if options.swap and base is None:
        raise InputError("--swap-core: the winches are in the body. Remove this option")
    return RigidParts(
        motor=chosen,
        units=units,
        base=base,
        seat=seat,
        stopper=_STOPPERS[options.stopper](options) if robot.cables else None,
        grommet=replace(grommet(options, hole), count=holes) if holes else None,
        cables=len(robot.cables),
        between=find_crowded_units(robot, units),
    )


def _for_winches(part: Printed, winches: tuple[str, ...], count: int) -> Printed:
    """Part for some of the winches, with their names in its title; `count` is that of all."""
    if len(winches) == count > 1:
        return replace(part, count=count, title=f"{part.title} of every winch", kind=part.title)
    words = f"winch{'es' if len(winches) > 1 else ''} {', '.join(winches)}"
    return replace(part, count=len(winches), title=f"{part.title} of {words}", kind=part.title, winches=winches)


_LINE = 0.4  # width of one line of a nozzle: the thinnest sleeve [mm]
_PLAY = 0.4  # minimum excess of the bore over the cable [mm]

_MOUTH = ((1.0, 0.0), (0.65, 0.3), (0.25, 0.75), (0.0, 1.3))
"""Excess of the mouth's radius over the bore's, and height above the bed [mm]: a rounding in steps of less than 50
degrees from upright, which prints without support."""

_FLANGE = 1.6
_SLEEVE = 1.4  # length of the sleeve in the felt [mm]: felt of 1.5 mm or more hides its end
_STITCH = 1.0  # diameter of a hole for needle and thread [mm]
_RIM = 1.0  # least material on each side of a hole for the needle [mm]


def grommet(options: PartOptions, hole: float) -> Printed:
    """An eyelet for a pinhole of a diameter [mm], sewn on the side where the cable bends away along the cloth.

    The sleeve goes into the hole, the flange lies on the felt and is sewn on through four holes, as a button is: felt
    is too soft for anything that is only pressed on. The cable runs over the rounded mouth of the flange. Raises
    InputError: the hole is too small for a sleeve of one line of plastic round the cable.
    """
    least = options.cable + _PLAY + 2 * _LINE + 2 * options.fit
    if not (math.isfinite(hole) and hole >= least - 1e-9):
        raise InputError(
            f"a grommet for a cable of {options.cable:g} mm needs a pinhole of {least:g} mm or more, not {hole:g} mm: "
            "its sleeve would be thinner than a line of plastic"
        )
    return Printed.of(
        _model(options, hole),
        name="grommet",
        title=f"Grommet for a pinhole of {hole:g} mm",
        note="Flange on the bed, no support, 0.12 mm layers; pull a thread through to take off burrs.",
    )


def _model(options: PartOptions, hole: float) -> Construction:
    sleeve = hole / 2 - options.fit
    bore = max((options.cable + _PLAY) / 2, sleeve - options.wall)
    stitches = max(bore + _MOUTH[0][0], sleeve) + _RIM + _STITCH / 2
    eyelet = Revolve(_profile(bore, sleeve, stitches + _STITCH / 2 + _RIM))
    needle = Cylinder(_FLANGE + 2, _STITCH / 2)
    model: Construction = eyelet
    for angle in (45, 135, 225, 315):
        x, y = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        model = model - needle.move(stitches * x, stitches * y, -1)
    return model


def _profile(bore: float, sleeve: float, flange: float) -> tuple[tuple[float, float], ...]:
    """(radius, height) corners of the eyelet, counter-clockwise, from the mouth on the bed outwards."""
    top = _FLANGE + _SLEEVE
    lead = min(0.3, (sleeve - bore) / 3)
    outside = ((flange - 0.4, 0.0), (flange, 0.4), (flange, _FLANGE), (sleeve, _FLANGE))
    end = ((sleeve, top - 2 * lead), (sleeve - lead, top), (bore, top))
    mouth = tuple((bore + wider, height) for wider, height in _MOUTH)
    return (mouth[0], *outside, *end, *reversed(mouth[1:]))
