"""`BasePlate`: a table on legs for winches outside the body (thesis, Fig 4.2): motors hang through it, tubes leave it.

It lies in the plane with its upper side at z = 0. Units stand in two rows, back to back; row by row their cables leave
along +y and along -y. It is printed, in tiles if it is larger than the bed, or cut from acrylic by the same outline.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from manifold3d import Manifold
from shapely.geometry import Polygon

from hydrostat.fabrication.parts import tube_holder
from hydrostat.fabrication.parts.housing import SHEET
from hydrostat.fabrication.parts.part_options import PartOptions
from hydrostat.fabrication.parts.winch_parts import letters
from hydrostat.fabrication.parts.winch_unit import WinchUnit
from hydrostat.fabrication.solids.assembly import Assembly, Placed
from hydrostat.fabrication.solids.construct import Box, Construction, Corner, Cylinder, Prism, segments, solid_of
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Mount, Robot

Ring = tuple[Corner, ...]
"""A closed line, its first corner not repeated [mm]."""

_GAP = 3.0
_STRIP = 12.0
_FREE = 15.0
_LEG = 10.0
_BELOW = 10.0
_LEG_SCREW = 3.4
"""Between units; margin for the screws of the legs; from a unit to its tube holder; width of a leg; room below the
motors for their wires; hole for the screw of a leg, M3 [mm]."""


@dataclass(frozen=True, kw_only=True)
class Seat:
    """Where a unit stands on the base.

    Attributes:
        unit: index among the units outside.
        x: of its shaft [mm].
        y: of its shaft [mm].
        turned: whether it is turned by half a turn, so that its cables leave along -y.
    """

    unit: int
    x: float
    y: float
    turned: bool

    def put(self, point: Corner) -> Corner:
        """A point of the unit on the base [mm]."""
        sign = -1.0 if self.turned else 1.0
        return self.x + sign * point[0], self.y + sign * point[1]

    def placed(self, solid: Manifold) -> Manifold:
        """A solid of the unit on the base."""
        return solid.rotate((0, 0, 180 if self.turned else 0)).translate((self.x, self.y, 0))


@dataclass(frozen=True, eq=False, kw_only=True)
class BasePlate:
    """A base for the winches outside the body.

    Attributes:
        printed: tiles of the plate, tube holders, legs.
        assembly: all of it with the units.
        sheet: outline of the whole plate, then its holes, to be cut from acrylic in place of the tiles [mm].
        thickness: of the plate [mm].
        seats: where the units stand.
        tubes: from the outer face of its housing to the far side of its holder, by cable index [mm].
        bought: what is bought for it, and how many of each.
        problems: why it cannot be built well.
    """

    printed: tuple[Printed, ...]
    assembly: Assembly
    sheet: tuple[Ring, ...]
    thickness: float
    seats: tuple[Seat, ...]
    tubes: tuple[tuple[int, float], ...]
    bought: tuple[tuple[str, int], ...]
    problems: tuple[str, ...] = ()


def base_plate(
    robot: Robot, units: Sequence[WinchUnit], options: PartOptions, bed: tuple[float, float, float]
) -> BasePlate | None:
    """The base of all winches outside the body; None if there are none.

    Args:
        robot: for its name.
        units: of all winches.
        options: sizes of the parts.
        bed: largest piece that the printer takes, along x, y and z [mm].
    """
    outside = [unit for unit in units if unit.mount is Mount.WORLD]
    if not outside:
        return None
    plan = _Plan.of(outside, options, bed)
    tiles = [
        Printed(
            name=f"base_{letters(place)}" if len(plan.tiles) > 1 else "base",
            title="Base",
            solid=solid_of(model),
            note="Flat on the bed, no support. Or cut the whole base from acrylic, 4 mm.",
            model=model,
        )
        for place, model in enumerate(map(_raised, plan.tiles))
    ]
    holders = _holders(outside, options)
    height = max(unit.motor.depth for unit in outside) + _BELOW - SHEET
    leg = _leg(height)
    legs = Printed(
        name="base_leg",
        title="Leg of the base",
        solid=solid_of(leg),
        count=len(plan.bolts),
        note="Standing, no support; holes for screws M3 at both ends.",
        model=leg,
    )
    used = {holder.name: sum(mine is holder for mine in holders) for holder in holders}
    own = {holder.name: replace(holder, count=used[holder.name]) for holder in holders}
    printed = (*tiles, *own.values(), legs)
    return BasePlate(
        printed=printed,
        assembly=_assembly(robot, outside, plan, tiles, holders, legs),
        sheet=plan.sheet,
        thickness=SHEET,
        seats=plan.seats,
        tubes=tuple((cable, _FREE + tube_holder.DEEP) for unit in outside for cable in unit.cables),
        bought=(
            ("M3 x 10 mm screw (legs and tube holders)", len(plan.bolts) + len(holders)),
            ("M2 x 8 mm screw (tube holders)", len(holders)),
        ),
        problems=_too_large([*tiles, legs], bed),
    )


@dataclass(frozen=True, kw_only=True)
class _Plan:
    """The plate seen from above."""

    seats: tuple[Seat, ...]
    tiles: tuple[tuple[Ring, ...], ...]
    corners: tuple[Corner, ...]
    bolts: tuple[Corner, ...]
    sheet: tuple[Ring, ...]

    @staticmethod
    def of(units: Sequence[WinchUnit], options: PartOptions, bed: tuple[float, float, float]) -> "_Plan":
        """Two rows back to back, in tiles of as many columns as the bed takes; a row of its own where it must be."""
        pitch = max(unit.size[0] for unit in units) + _GAP
        back = max(-unit.low[1] for unit in units) + _GAP / 2
        front = max(unit.high[1] for unit in units) + _FREE + tube_holder.DEEP + 2.0
        rows = 2 if len(units) > 1 and 2 * (back + front) <= bed[1] else 1
        most = max(1, math.floor((bed[0] - 2 * _STRIP) / pitch))
        columns = math.ceil(len(units) / rows)
        count = math.ceil(columns / most)
        shares = [columns // count + (place < columns % count) for place in range(count)]
        low, high = (-back - front if rows == 2 else -back), front
        seats, tiles, corners, bolts, left = [], [], [], [], 0.0
        for share in shares:
            right = left + share * pitch + 2 * _STRIP
            mine = []
            for column in range(share * rows):
                x = left + _STRIP + (column // rows + 0.5) * pitch
                turned = rows == 2 and column % 2 == 1
                if len(seats) + len(mine) < len(units):
                    y = -2 * back if turned else 0.0
                    mine.append(Seat(unit=len(seats) + len(mine), x=x, y=y, turned=turned))
            if rows == 2:
                low = -2 * back - front
            ends = [
                (x, y) for x in (left + _STRIP / 2, right - _STRIP / 2) for y in (low + _STRIP / 2, high - _STRIP / 2)
            ]
            outline = ((left, low), (right, low), (right, high), (left, high))
            holes = [hole for seat in mine for hole in _holes(seat, units[seat.unit], options)]
            tiles.append((outline, *holes, *(_circle(end, _LEG_SCREW / 2) for end in ends)))
            corners.append((left, low))
            seats += mine
            bolts += ends
            left = right
        whole = ((0.0, low), (left, low), (left, high), (0.0, high))
        return _Plan(
            seats=tuple(seats),
            tiles=tuple(tiles),
            corners=tuple(corners),
            bolts=tuple(bolts),
            sheet=(whole, *(hole for tile in tiles for hole in tile[1:])),
        )


def _holes(seat: Seat, unit: WinchUnit, options: PartOptions) -> list[Ring]:
    """For the motor, the screws of its housing, and the screw of its tube holder."""
    cut = Polygon(unit.motor.outline).buffer(options.clearance, join_style="mitre").exterior.coords[:-1]
    post, screw = unit.housing.post, unit.housing.screw
    posts = [(x, y) for x in (-post, post) for y in (-post, post)]
    motor = tuple(seat.put((float(x), float(y))) for x, y in cut)
    holder = seat.put(_holder_at(unit))
    return [
        motor if Polygon(motor).exterior.is_ccw else motor[::-1],
        *(_circle(seat.put(point), screw.passage / 2) for point in posts),
        _circle(holder, tube_holder.PASSAGE / 2),
    ]


def _holder_at(unit: WinchUnit) -> Corner:
    """The middle of its tube holder, in the unit's coordinates [mm]."""
    x, y, _ = unit.exits[0].point
    return x, y + _FREE + tube_holder.DEEP / 2


def _circle(middle: Corner, radius: float) -> Ring:
    count = segments(radius)
    angles = (2 * math.pi * corner / count for corner in range(count))
    return tuple((middle[0] + radius * math.cos(angle), middle[1] + radius * math.sin(angle)) for angle in angles)


def _raised(rings: tuple[Ring, ...]) -> Construction:
    """A tile as it lies on the bed."""
    outline, *holes = rings
    body: Construction = Prism(outline, SHEET)
    for hole in holes:
        body = body - Prism(hole, SHEET + 2).moved(0, 0, -1)
    return body.moved(-outline[0][0], -outline[0][1], 0)


def _holders(units: Sequence[WinchUnit], options: PartOptions) -> list[Printed]:
    """The holder of each unit; equal ones are the same."""
    made: dict[Construction, Printed] = {}
    found = []
    for unit in units:
        model = tube_holder.tube_holder([leaves.point[2] for leaves in unit.exits], options)
        if model not in made:
            made[model] = Printed(
                name=f"tube_holder_{letters(len(made))}",
                title="Tube holder",
                solid=solid_of(model),
                note="Standing on its foot, the slot upwards, no support.",
                model=model,
            )
        found.append(made[model])
    return found


def _leg(height: float) -> Construction:
    """A post with a hole for a screw at both ends, as it stands on the bed."""
    body: Construction = Box((_LEG, _LEG, height)).moved(-_LEG / 2, -_LEG / 2, 0)
    body = body - Cylinder(13, 1.3).moved(0, 0, -1)
    return body - Cylinder(13, 1.3).moved(0, 0, height - 12)


def _assembly(
    robot: Robot,
    units: Sequence[WinchUnit],
    plan: _Plan,
    tiles: Sequence[Printed],
    holders: Sequence[Printed],
    legs: Printed,
) -> Assembly:
    tall = legs.size[2]
    pieces = [
        Placed(name=tile.name, title=tile.title, solid=tile.solid.translate((*corner, -SHEET)))
        for tile, corner in zip(tiles, plan.corners, strict=True)
    ]
    pieces += [
        Placed(
            name=f"{legs.name} {number}",
            title=legs.title,
            solid=legs.solid.translate((*bolt, -SHEET - tall)),
            pulled=(0, 0, -tall / 2),
        )
        for number, bolt in enumerate(plan.bolts, start=1)
    ]
    for seat, holder in zip(plan.seats, holders, strict=True):
        unit = units[seat.unit]
        pieces += [
            replace(
                piece,
                name=f"{piece.name} ({unit.winch})",
                solid=seat.placed(piece.solid),
                pulled=(0, 0, unit.motor.depth + 20),
            )
            for piece in unit.assembly.pieces
        ]
        x, y = seat.put(_holder_at(unit))
        pieces.append(
            Placed(
                name=f"{holder.name} ({unit.winch})",
                title=holder.title,
                solid=holder.solid.translate((x, y, 0)),
                pulled=(0, 0, 20),
            )
        )
    return Assembly(name=f"base of {robot.name}", pieces=tuple(pieces))


def _too_large(pieces: Sequence[Printed], bed: tuple[float, float, float]) -> tuple[str, ...]:
    found = []
    for piece in pieces:
        if any(side > room + 1e-6 for side, room in zip(piece.size, bed, strict=True)):
            sides = " x ".join(f"{side:.0f}" for side in piece.size)
            room = " x ".join(f"{side:.0f}" for side in bed)
            found.append(
                f"{piece.name} is {sides} mm, the bed {room} mm: cut the base from acrylic, or take smaller motors"
            )
    return tuple(found)
