"""`WinchUnit`: motor, the spool that a winch needs on it, and housing: parts to print, assembly, warnings."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, combinations

from manifold3d import Manifold

from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.arrangement import LaidUnit, arrange_units
from hydrostat.fabrication.parts.housing import Housing, coupling_wall, drive_of, roof_of
from hydrostat.fabrication.parts.motor import Motor
from hydrostat.fabrication.parts.places import UnitBox, UnitPlace, seam_of
from hydrostat.fabrication.parts.spool import FINE_STEP, SHARED_STEP, Groove, Spool, capacity, spool_turns, width_for
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed
from hydrostat.fabrication.solids.construct import Construction, Cuboid, solid_of
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Mount, Robot, Winch

_MAX_SPOOL_LENGTH = 30.0
"""A spool is no longer than this where several layers can avoid it [mm]: its far end is held by a thin roof."""

_MAX_LAYERS = 6

_INSIDE = 1.2  # the least of a shaft in a spool over its diameter: less, and a flat of plastic wears round


Wound = tuple[tuple[int, ...], ...]  # indices of the cables of each groove, the first next to the motor


def wound_cables(robot: Robot, winch: Winch) -> Wound:
    """Cables of a winch, groove by groove: the two of a pair, which run alike, share one.

    Outside the body each has its own: there the tubes of all stand apart.
    """
    found: dict[object, list[int]] = {}
    for index, cable in enumerate(robot.cables):
        if cable.winch == winch.name:
            alike = (
                (cable.points, cable.slack, cable.spool_radius, cable.reverse) if winch.mount is Mount.BODY else index
            )
            found.setdefault(alike, []).append(index)
    return tuple(map(tuple, found.values()))


def spool_for(
    robot: Robot, winch: Winch, wound: Wound, options: PartOptions, motor: Motor
) -> tuple[Spool, tuple[str, ...], tuple[str, ...]]:
    """Return the spool of a winch, its problems and its warnings.

    Each cable lies in one layer if the spool then is short enough, else all in as few layers as make it so, in grooves
    of finer widths where that saves a layer. A radius too small for the shaft is made as small as possible: a problem.
    """
    drive = drive_of(motor, options)
    problems = []
    least_inside = _INSIDE * motor.shaft.diameter
    if drive.inside < least_inside:
        problems.append(
            f'winch "{winch.name}": only {max(drive.inside, 0):.1f} mm of the shaft of {motor.title} would be in the '
            f"spool (minimum {least_inside:.1f} mm). Choose thinner walls or another motor"
        )
    radii, small = _radii(robot, winch, wound, options, motor)
    kinds = [(len(cables), robot.cables[cables[0]].reverse) for cables in wound]
    turns = spool_turns(1e3 * (winch.travel + winch.release), 1e3 * winch.spool_radius, options.spare_wraps)
    grooves = [
        [_groove(radius, turns, layers, options.cable, *kind, step) for radius, kind in zip(radii, kinds, strict=True)]
        for layers in range(1, _MAX_LAYERS + 1)
        for step in (SHARED_STEP, FINE_STEP)
    ]
    sizes = [_spool(each, drive.inside, options, motor) for each in grooves]
    spool = next((each for each in sizes if each.body <= _MAX_SPOOL_LENGTH), sizes[-1])
    if spool.body > _MAX_SPOOL_LENGTH:
        problems.append(
            f'winch "{winch.name}": {turns:.1f} turns of cable do not fit on a spool of {_MAX_SPOOL_LENGTH:g} mm in '
            f"{_MAX_LAYERS} layers. Choose a larger spool radius or less travel"
        )
    return spool, (*small, *problems), _layers(spool, winch, wound)


def _radii(
    robot: Robot, winch: Winch, wound: Wound, options: PartOptions, motor: Motor
) -> tuple[list[float], list[str]]:
    """Radius at which cables are wound on each groove [mm], and a sentence for each that is too small for the shaft."""
    least = motor.shaft.diameter / 2 + options.fit + options.wall + options.cable / 2
    radii, small = [], []
    for index, *_ in wound:
        radius = 1e3 * (robot.cables[index].spool_radius or winch.spool_radius)
        if radius < least - 1e-9:
            small.append(
                f'winch "{winch.name}": spool radius {radius:.2f} mm of cable C{index + 1} is too small for the shaft '
                f"of {motor.title} in a wall of {options.wall:g} mm. The printed spool has {least:.2f} mm, the minimum"
            )
        radii.append(max(radius, least))
    return radii, small


def _layers(spool: Spool, winch: Winch, wound: Wound) -> tuple[str, ...]:
    """A sentence for each cable that lies in more than one layer, or for all of one winch that do so alike."""
    alike: dict[Groove, list[int]] = {}
    for cables, groove in zip(wound, spool.grooves, strict=True):
        if groove.layers > 1:
            alike.setdefault(groove, []).extend(cables)
    found = []
    for groove, indices in alike.items():
        names = [f"C{index + 1}" for index in sorted(indices)]
        outer = groove.radius + (groove.layers - 1) * spool.cable
        who = f"cable {names[0]}" if len(names) == 1 else f"cables {', '.join(names)}"
        lies, radius = ("lies", "its radius") if len(names) == 1 else ("lie", "their radius")
        found.append(
            f'{who} of winch "{winch.name}" {lies} in {groove.layers} layers: {radius} grows from '
            f"{groove.radius:.1f} to {outer:.1f} mm, so the last turns wind "
            f"{100 * (outer / groove.radius - 1):.0f} % more than simulated"
        )
    return tuple(found)


def _spool(grooves: Sequence[Groove], inside: float, options: PartOptions, motor: Motor) -> Spool:
    return Spool(
        grooves=tuple(grooves),
        cable=options.cable,
        shaft=motor.shaft,
        inside=max(inside, 0.5),
        play=options.fit,
        wall=options.wall,
        journal=options.clearance + roof_of(options) - 0.2,
    )


def _groove(radius: float, turns: float, layers: int, cable: float, lines: int, reverse: bool, step: float) -> Groove:
    """The narrowest that takes so many turns of the first layer's length of each line in these layers."""
    length = lines * turns * 2 * math.pi * radius
    one_turn = capacity(cable * 2.25, radius, cable, layers)
    width = width_for(length / one_turn, cable, step)
    return Groove(radius=radius, width=width, layers=layers, lines=lines, reverse=reverse)


_SPOOL = "Stands on its wide face with the bore, no support; 0.12 mm layers, 4 walls or more."
_BOX = "Roof on the bed, open side up, no support. Open the channels with a needle; push a tube in to try its seats."
_PLATE = "Motor's side on the bed, no support."
_COUPLING = "Disc on the bed, shaft up, no support; 0.12 mm layers, all walls (100 % infill)."


class WinchParts:
    """Makes what is printed for winches and remembers it, so that winches that are alike share their files."""

    def __init__(self) -> None:
        self._made: dict[str, dict[Construction, Printed]] = {}
        self._motors: dict[str, Manifold] = {}

    def of(self, housing: Housing, winch: str) -> tuple[tuple[Printed, ...], PartAssembly]:
        """Make what is printed for a winch (spool, box, plate, the coupling of a servo) and put it together."""
        box = housing.box().rotate(x=180).move(0, 0, housing.top)
        printed = [
            self._make_piece("spool", "Spool", housing.spool.construction(), _SPOOL),
            self._make_piece("housing", "Housing", box, _BOX),
            self._make_piece("motor_plate", "Motor plate", housing.plate(), _PLATE),
        ]
        coupling = housing.coupling()
        if coupling is not None:
            printed.append(self._make_piece("coupling", "Coupling", coupling, _COUPLING))
        return tuple(printed), self._assembly(housing, tuple(printed), winch)

    def _make_piece(self, kind: str, title: str, model: Construction, note: str) -> Printed:
        made = self._made.setdefault(kind, {})
        if model not in made:
            made[model] = Printed.of(model, name=f"{kind}_{letter_label(len(made))}", title=title, note=note)
        return made[model]

    def _assembly(self, housing: Housing, printed: tuple[Printed, ...], winch: str) -> PartAssembly:
        motor, drive = housing.motor, housing.drive
        if motor.key not in self._motors:
            self._motors[motor.key] = solid_of(motor.envelope)
        spool, box, plate, *coupling = printed
        step = 0.6 * housing.top
        pieces = [
            Placed(name=f"motor_{motor.key}", title=motor.title, solid=self._motors[motor.key], printed=False),
            Placed(name=plate.name, title=plate.title, solid=plate.solid, pulled=(0, 0, step)),
        ]
        if motor.horn is not None:
            (disc,) = coupling
            solid = disc.solid.translate((0, 0, motor.horn.height))
            pieces.append(Placed(name=disc.name, title=disc.title, solid=solid, pulled=(0, 0, 2 * step)))
        far = step * len(pieces)
        standing = spool.solid.translate((0, 0, drive.start))
        closed = box.solid.rotate((180, 0, 0)).translate((0, 0, housing.top))
        pieces += [
            Placed(name=spool.name, title=spool.title, solid=standing, pulled=(0, 0, far + step)),
            Placed(name=box.name, title=box.title, solid=closed, pulled=(0, 0, far + 3 * step)),
        ]
        return PartAssembly(name=f'winch "{winch}"', pieces=tuple(pieces))


def letter_label(number: int) -> str:
    """a, b, ... z, aa, ab, ... for 0, 1, ..."""
    text = chr(ord("a") + number % 26)
    return text if number < 26 else letter_label(number // 26 - 1) + text


@dataclass(frozen=True, kw_only=True)
class Exit:
    """Exit of a cable from a unit, in the unit's coordinates: the shaft is z, the face of the motor z = 0."""

    cable: int  # index of the cable in the robot
    point: tuple[float, float, float]  # in the outer face of the housing, in the middle of the seat of the tube [mm]
    direction: tuple[float, float, float]  # in which the cable leaves, of length 1
    lead: float  # cable from the spool to this point [mm]
    seat: float  # depth of the tube from this point [mm]


@dataclass(frozen=True, eq=False, kw_only=True)
class WinchUnit:
    """Motor, spool and housing of one winch; lengths in millimeters."""

    winch: str  # its name
    cables: tuple[int, ...]  # index of each of its cables in the robot, in the order of the grooves
    wound: Wound  # the same, groove by groove
    mount: Mount  # mount of the winch
    motor: Motor  # motor that turns it
    housing: Housing  # its sizes, with those of its spool
    printed: tuple[Printed, ...]  # parts to print for it, one of each
    assembly: PartAssembly  # all of it, in its own coordinates, in the order in which it is put together
    exits: tuple[Exit, ...]  # exits of its cables
    bought: tuple[tuple[str, int], ...]  # parts to buy for it besides the motor, with the count of each
    across: bool  # True if its shaft stands across a flat body, with the roof to the front; else it lies in it
    place: UnitPlace | None = None  # place in a flat body; None in space and outside
    problems: tuple[str, ...] = ()  # why it cannot be built well
    warnings: tuple[str, ...] = ()  # warnings for the builder
    notes: tuple[str, ...] = ()  # information for the builder

    @property
    def spool(self) -> Spool:
        """Sizes of its spool."""
        return self.housing.spool

    @property
    def room(self) -> Cuboid:
        """Box round the unit [mm]: what a pocket for it must take."""
        return self.housing.room


def winch_units(robot: Robot, options: PartOptions, motor: Motor) -> tuple[WinchUnit, ...]:
    """A unit for each winch that has cables, in winch order; equal parts have the same name."""
    parts = WinchParts()
    return tuple(draft.unit(robot, parts, laid) for draft, laid in _drafts(robot, options, motor))


def unit_problems(robot: Robot, options: PartOptions, motor: Motor) -> tuple[tuple[str, ...], bool]:
    """Return the problems of the winch units, as in `winch_units`, without making them; and True if units are piled."""
    drafts = _drafts(robot, options, motor)
    found = (problem for draft, laid in drafts for problem in (*draft.problems, *(laid.problems if laid else ())))
    return tuple(found), any(laid is not None and laid.is_piled for _, laid in drafts)


def _drafts(robot: Robot, options: PartOptions, motor: Motor) -> list[tuple["_UnitDraft", LaidUnit | None]]:
    """Each winch that has cables as it is sized, and as it is laid in a flat body."""
    drafts = [
        _UnitDraft.of(robot, winch, wound, options, motor)
        for winch in robot.winches
        if (wound := wound_cables(robot, winch))
    ]
    laid = _lay_units(robot, [draft for draft in drafts if draft.winch.mount is Mount.BODY])
    return [(draft, laid.get(draft.winch.name)) for draft in drafts]


def unit_room(robot: Robot, winch: Winch, options: PartOptions, motor: Motor) -> Cuboid:
    """Box round the unit of a winch before it is laid, shaft along z, face of the motor at z = 0 [mm]."""
    return _UnitDraft.of(robot, winch, wound_cables(robot, winch), options, motor).housing.room


def unit_rooms(robot: Robot, options: PartOptions, motor: Motor) -> dict[str, Cuboid]:
    """Box round the unit of each winch in the body that has cables, by name, as `unit_room`."""
    return {
        winch.name: _UnitDraft.of(robot, winch, wound, options, motor).housing.room
        for winch in robot.winches
        if winch.mount is Mount.BODY and (wound := wound_cables(robot, winch))
    }


def find_crowded_units(robot: Robot, units: Iterable[WinchUnit]) -> tuple[str, ...]:
    """Return a sentence for each two units in a body in space that are closer than they are wide."""
    inside = [unit for unit in units if unit.mount is Mount.BODY and unit.place is None]
    found = []
    for one, other in combinations(inside, 2):
        apart = 1e3 * math.dist(robot.winch(one.winch).at, robot.winch(other.winch).at)
        needed = one.housing.half + other.housing.half
        if apart < needed:
            found.append(
                f'winches "{one.winch}" and "{other.winch}" are {apart:.1f} mm apart, their housings need '
                f"{needed:.1f} mm. Move one, or lay one above the other"
            )
    return tuple(found)


@dataclass(frozen=True, eq=False, kw_only=True)
class _UnitDraft:
    """A unit whose sizes are known, but not yet on which sides its cables leave."""

    winch: Winch
    wound: Wound
    housing: Housing
    problems: tuple[str, ...]
    warnings: tuple[str, ...]

    @staticmethod
    def of(robot: Robot, winch: Winch, wound: Wound, options: PartOptions, motor: Motor) -> "_UnitDraft":
        """Size the unit of a winch and its cables."""
        spool, problems, warnings = spool_for(robot, winch, wound, options, motor)
        outside = winch.mount is Mount.WORLD
        housing = Housing(motor=motor, spool=spool, azimuths=(90,) * len(wound), outside=outside, options=options)
        return _UnitDraft(winch=winch, wound=wound, housing=housing, problems=problems, warnings=warnings)

    def unit(self, robot: Robot, parts: WinchParts, laid: LaidUnit | None) -> WinchUnit:
        """Make the unit as it is laid in a flat body, or where there is no question of that."""
        housing = replace(self.housing, azimuths=_azimuths(robot, self.wound, self.winch.mount, laid))
        printed, assembly = parts.of(housing, self.winch.name)
        return WinchUnit(
            winch=self.winch.name,
            cables=tuple(chain.from_iterable(self.wound)),
            wound=self.wound,
            mount=self.winch.mount,
            motor=housing.motor,
            housing=housing,
            printed=printed,
            assembly=assembly,
            exits=tuple(way for place, cables in enumerate(self.wound) for way in _exits(housing, place, cables)),
            bought=_bought_pieces(housing),
            across=laid is None or laid.place.across,
            place=laid.place if laid else None,
            problems=(*self.problems, *(laid.problems if laid else ())),
            warnings=self.warnings,
            notes=laid.notes if laid else (),
        )


def _lay_units(robot: Robot, drafts: Sequence[_UnitDraft]) -> dict[str, LaidUnit]:
    """Lay units in a flat body: each by the name of its winch; none in space."""
    if robot.body.thickness is None:
        return {}
    boxes = [
        UnitBox(
            winch=draft.winch.name,
            at=(1e3 * draft.winch.at[0], 1e3 * draft.winch.at[1]),
            low=draft.housing.room.low,
            high=draft.housing.room.high,
            along=_heading(robot, draft.wound[0][0]),
        )
        for draft in drafts
    ]
    laid = arrange_units(boxes, seam_of(robot.body), 1e3 * robot.body.thickness)
    return {each.place.box.winch: each for each in laid}


def _heading(robot: Robot, cable: int) -> float:
    """Way in which a cable of a flat robot goes on from its winch, counted from +x [degrees]."""
    first, second = robot.cables[cable].points[:2]
    return math.degrees(math.atan2(second[1] - first[1], second[0] - first[0]))


def _azimuths(robot: Robot, wound: Wound, mount: Mount, laid: LaidUnit | None) -> tuple[int, ...]:
    """Ways in which the cables of each groove leave [degrees]; the first along +y, or as a unit is turned.

    Outside all leave towards the tubes. In a flat body each leaves on the side that is nearest to the way in which it
    goes on; in a body of space they are spread.
    """
    if mount is Mount.WORLD:
        return (90,) * len(wound)
    if laid is None:
        return tuple((90 + 90 * round(4 * place / len(wound))) % 360 for place in range(len(wound)))
    return tuple(laid.place.azimuth(_heading(robot, cables[0])) for cables in wound)


def _exits(housing: Housing, place: int, cables: tuple[int, ...]) -> Iterator[Exit]:
    angle = math.radians(housing.azimuths[place])
    cos, sin = round(math.cos(angle)), round(math.sin(angle))
    aside, half = housing.aside(place), housing.half
    for cable, height in zip(cables, housing.heights(place), strict=True):
        yield Exit(
            cable=cable,
            point=(half * cos - aside * sin, half * sin + aside * cos, height),
            direction=(float(cos), float(sin), 0.0),
            lead=housing.lead,
            seat=housing.seat(place),
        )


def _bought_pieces(housing: Housing) -> tuple[tuple[str, int], ...]:
    motor, wall = housing.motor, housing.options.wall
    found = [(f"{motor.screw.title(wall)} (plate)", len(motor.holes))]
    if motor.horn is not None:
        screw = motor.horn.screw.title(coupling_wall(motor.horn, housing.options))
        found.append((f"{screw} (horn)", motor.horn.count))
    found.append((housing.screw.title, 4))
    if housing.outside:
        found.append(("M2 nut", 4))
    return tuple(found)
