"""`BasePlan`: the base of winches outside the body from above: where units stand, what is cut out, in which tiles."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from manifold3d import Manifold
from shapely.geometry import Polygon
from shapely.geometry.polygon import orient

from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.housing import SHEET
from hydrostat.fabrication.parts.winch_unit import WinchUnit
from hydrostat.fabrication.solids.construct import Box, Construction, Corner, Cylinder, Prism, segments

HOLDER_WIDTH = 10.0
HOLDER_DEPTH = 8.0  # size of a tube holder, across and along the tubes [mm]

HOLDER_PASSAGE = 3.4
_PILOT = 2.6
_INTO = 8.0  # hole in the base for the M3 screw that holds the block, its pilot in the block, and how deep that is [mm]
_SLOT = 1.0  # width of the slot that closes when the block is screwed together [mm]
_ABOVE = 3.0  # from the highest tube to the screw that pinches [mm]


def tube_holder(heights: Sequence[float], options: PartOptions) -> Construction:
    """A block on the plane z = 0 with a bore along y for a tube at each height [mm], x = y = 0 in its middle.

    The bores have the size of the tube; a slot goes down through all of them from the top, and a screw M2 across it
    closes the block on the tubes.
    """
    lowest, highest = min(heights), max(heights)
    screw = highest + options.tube / 2 + _ABOVE
    top = screw + 3.0
    body: Construction = Box((HOLDER_WIDTH, HOLDER_DEPTH, top)).move(-HOLDER_WIDTH / 2, -HOLDER_DEPTH / 2, 0)
    for height in heights:
        body = body - Cylinder(HOLDER_DEPTH + 2, options.tube / 2).rotate(x=90).move(0, HOLDER_DEPTH / 2 + 1, height)
    deep = lowest - options.tube / 2 - 0.5
    body = body - Box((_SLOT, HOLDER_DEPTH + 2, top)).move(-_SLOT / 2, -HOLDER_DEPTH / 2 - 1, deep)
    body = body - Cylinder(HOLDER_WIDTH, 1.2).rotate(y=90).move(0, 0, screw)
    body = body - Cylinder(HOLDER_WIDTH, 0.85).rotate(y=-90).move(0, 0, screw)
    depth = min(_INTO, deep - 1.2)
    return body - Cylinder(depth + 1, _PILOT / 2).move(0, 0, -1)


COUPLER = (17.0, 9.0, 3.0)  # size of a line coupler [mm]
STOP = 2.0  # plastic behind the end of a tube in a core plate [mm]
_EYE, _APART = 1.6, 4.5  # radius of an eye of a coupler, and its distance from the middle [mm]
_INSET = 4.0  # from the end of a core plate to its screw [mm]


def line_coupler(options: PartOptions) -> Construction:
    """Two eyes in a plate [mm], each open by a slit as wide as the line, for the loops of two lines that pull apart."""
    long, wide, thick = COUPLER
    body: Construction = Box(COUPLER).move(-long / 2, -wide / 2, 0)
    for turn in (0.0, 180.0):
        slit = Box((wide, options.cable + 0.3, thick + 2)).move(0, -(options.cable + 0.3) / 2, -1).rotate(z=60)
        eye = Cylinder(thick + 2, _EYE).move(0, 0, -1) + slit
        body = body - eye.move(-_APART, 0, 0).rotate(z=turn)
    return body


def core_plate(width: float, bores: Sequence[tuple[float, float]], options: PartOptions) -> Construction:
    """A wall on the plane z = 0 from x = 0 on, with a blind bore along y for a tube at each (x, height) [mm].

    Tubes come from +y up to a stop, lines go on through it; two screws M3 stand upright in the ends.
    """
    top = max(height for _, height in bores) + options.tube / 2 + _ABOVE
    body: Construction = Box((width, HOLDER_DEPTH, top)).move(0, -HOLDER_DEPTH / 2, 0)
    for x, height in bores:
        for length, radius in ((HOLDER_DEPTH + 1 - STOP, options.tube / 2 + 0.05), (HOLDER_DEPTH + 2, options.cable)):
            body = body - Cylinder(length, radius).rotate(x=90).move(x, HOLDER_DEPTH / 2 + 1, height)
    for x in (_INSET, width - _INSET):
        body = body - Cylinder(top + 2, 1.7).move(x, 0, -1)
    return body


POST = 12.0  # width of a post [mm]


def post(height: float) -> Construction:
    """A post [mm] with a hole for a screw M3 at both ends, as it stands on the bed."""
    body: Construction = Box((POST, POST, height)).move(-POST / 2, -POST / 2, 0)
    body = body - Cylinder(13, 1.3).move(0, 0, -1)
    return body - Cylinder(13, 1.3).move(0, 0, height - 12)


Ring = tuple[Corner, ...]  # a closed line, its first corner not repeated [mm]
HOLDER_GAP = 15.0  # from a unit to its tube holder [mm]

_GAP = 3.0
_STRIP = 12.0
_SHORTER = 3.0  # by which a core plate reaches into the margins of its tile [mm]
_LEG_SCREW = 3.4  # between units; margin for the screws of the legs; hole for such a screw, M3 [mm]


@dataclass(frozen=True)
class Hole:
    """A round hole in the plate [mm]."""

    middle: Corner
    radius: float

    @property
    def ring(self) -> Ring:
        """Outline of it as a polygon [mm]."""
        count = segments(self.radius)
        angles = (2 * math.pi * corner / count for corner in range(count))
        x, y = self.middle
        return tuple((x + self.radius * math.cos(angle), y + self.radius * math.sin(angle)) for angle in angles)

    @property
    def solid(self) -> Construction:
        """Shape of the hole, to be subtracted."""
        return Cylinder(SHEET + 2, self.radius).move(*self.middle, -1)


@dataclass(frozen=True, kw_only=True)
class Seat:
    """Place of a unit on the base."""

    unit: int  # index among the units outside
    x: float  # x of its shaft [mm]

    def place_point(self, point: Corner) -> Corner:
        """A point of the unit on the base [mm]."""
        return self.x + point[0], point[1]

    def place_solid(self, solid: Manifold) -> Manifold:
        """Move a solid of the unit to its seat on the base."""
        return solid.translate((self.x, 0, 0))


@dataclass(frozen=True, kw_only=True)
class BasePlan:
    """The plate seen from above."""

    seats: tuple[Seat, ...]
    tiles: tuple["BaseTile", ...]
    bolts: tuple[Corner, ...]
    sheet: tuple[Ring, ...]
    free: float  # from a unit to the holder of its tubes

    @staticmethod
    def of(
        units: Sequence[WinchUnit], options: PartOptions, bed: tuple[float, float, float], *, reach: float = 0.0
    ) -> "BasePlan":
        """One row, so that all tubes leave to one side, in tiles of as many units as the bed takes.

        Where cores are swapped, couplers have room to move by `reach` [mm].
        """
        free = reach + COUPLER[0] + 8.0 if options.swap else HOLDER_GAP
        pitch = max(unit.room.size[0] for unit in units) + _GAP
        low = min(unit.room.low[1] for unit in units) - _GAP / 2
        high = max(unit.room.high[1] for unit in units) + free + HOLDER_DEPTH + 2.0
        most = max(1, math.floor((bed[0] - 2 * _STRIP) / pitch))
        count = math.ceil(len(units) / most)
        seats: list[Seat] = []
        tiles: list[BaseTile] = []
        left = 0.0
        for share in (len(units) // count + (place < len(units) % count) for place in range(count)):
            mine = [Seat(unit=len(seats) + place, x=left + _STRIP + (place + 0.5) * pitch) for place in range(share)]
            right = left + share * pitch + 2 * _STRIP
            tiles.append(
                BaseTile.of((left, low), (right, high), [(seat, units[seat.unit]) for seat in mine], options, free)
            )
            seats += mine
            left = right
        return BasePlan(
            seats=tuple(seats),
            tiles=tuple(tiles),
            bolts=tuple(bolt for tile in tiles for bolt in tile.bolts),
            sheet=(_rectangle((0.0, low), (left, high)), *(ring for tile in tiles for ring in tile.rings)),
            free=free,
        )


@dataclass(frozen=True, kw_only=True)
class BaseTile:
    """A piece of the plate that is printed in one go."""

    low: Corner
    high: Corner
    bolts: tuple[Corner, ...]
    cuts: tuple[Ring, ...]
    holes: tuple[Hole, ...]

    @staticmethod
    def of(
        low: Corner, high: Corner, seats: Sequence[tuple[Seat, WinchUnit]], options: PartOptions, free: float
    ) -> "BaseTile":
        """Make a tile with a hole for each motor, the screws of its housing and its tube holder, and for each leg."""
        inset = _STRIP / 2
        bolts = tuple((x, y) for x in (low[0] + inset, high[0] - inset) for y in (low[1] + inset, high[1] - inset))
        holes = [Hole(bolt, _LEG_SCREW / 2) for bolt in bolts]
        cuts = []
        for seat, unit in seats:
            post, passage = unit.housing.post, unit.housing.screw.passage
            cut = Polygon(unit.motor.outline).buffer(options.clearance, join_style="mitre")
            cuts.append(tuple(seat.place_point((float(x), float(y))) for x, y in orient(cut).exterior.coords[:-1]))
            holes += [Hole(seat.place_point((x, y)), passage / 2) for x in (-post, post) for y in (-post, post)]
            if not options.swap:
                holes.append(Hole(seat.place_point(holder_at(unit, free)), HOLDER_PASSAGE / 2))
        if options.swap:
            level = holder_at(seats[0][1], free)[1]
            ends = (low[0] + _STRIP - _SHORTER + _INSET, high[0] - _STRIP + _SHORTER - _INSET)
            holes += [Hole((x, level), _PILOT / 2) for x in ends]
        return BaseTile(low=low, high=high, bolts=bolts, cuts=tuple(cuts), holes=tuple(holes))

    def core_plate(self, bores: Sequence[tuple[float, float]], options: PartOptions) -> tuple[Construction, float]:
        """Return the wall of a core on this tile for bores at (x, height) of the base, and where it begins [mm]."""
        start, end = self.low[0] + _STRIP - _SHORTER, self.high[0] - _STRIP + _SHORTER
        return core_plate(end - start, [(x - start, height) for x, height in bores], options), start

    @property
    def rings(self) -> tuple[Ring, ...]:
        """All that is cut out."""
        return (*self.cuts, *(hole.ring for hole in self.holes))

    @property
    def solid(self) -> Construction:
        """Shape of the tile as it lies on the bed."""
        body: Construction = Prism(_rectangle(self.low, self.high), SHEET)
        for cut in self.cuts:
            body = body - Prism(cut, SHEET + 2).move(0, 0, -1)
        for hole in self.holes:
            body = body - hole.solid
        return body.move(-self.low[0], -self.low[1], 0)


def _rectangle(low: Corner, high: Corner) -> Ring:
    return low, (high[0], low[1]), high, (low[0], high[1])


def holder_at(unit: WinchUnit, free: float = HOLDER_GAP) -> Corner:
    """The middle of its tube holder, in the unit's coordinates [mm]."""
    x, y, _ = unit.exits[0].point
    return x, y + free + HOLDER_DEPTH / 2
