"""`Housing`: what holds a spool on its motor: a plate that is screwed on the motor, and a box with the channels.

The motor stands as in `motor.py`; the plate lies on its face, the box stands on the plate, open below, with the far end
of the spool in its roof. Cables leave the box through its sides, each at the height of its groove and tangential to it.
"""

import math
from dataclasses import dataclass
from functools import cached_property

from shapely.geometry import MultiPoint, Polygon

from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.motor import Horn, Motor
from hydrostat.fabrication.parts.screws import Screw
from hydrostat.fabrication.parts.spool import Spool
from hydrostat.fabrication.solids.construct import Box, Construction, Corner, Cuboid, Cylinder

STUB = 8.0  # length of the coupling's shaft in a spool [mm]
SHEET = 4.0  # thickness of the base that motors outside the body stand on, printed or of acrylic [mm]
_NUT = 2.0  # length of a screw in its nut [mm]

_LENGTHS = (8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0)
_SEAT = 5.0
_ROOF = 2.0
_TRY = 0.1
"""Lengths of available screws, depth of the seat of a tube, minimum thickness of the roof, and search step for the
position of the screws [mm]."""


@dataclass(frozen=True, kw_only=True)
class Drive:
    """Place of a spool on a motor; heights above the face of the motor [mm]."""

    floor: float  # thickness of the plate under the heads of its screws
    plate: float  # top of the plate
    disc: float  # thickness of the coupling's disc; 0 without a horn
    start: float  # lower face of the spool
    tip: float  # end of the shaft

    @property
    def inside(self) -> float:
        """Length of the shaft in the spool [mm]; negative if it does not reach it."""
        return self.tip - self.start


def drive_of(motor: Motor, options: PartOptions) -> Drive:
    """Find where a spool stands on a motor."""
    floor = motor.screw.floor(options.wall)
    ridge = motor.ridge.high[2] + options.clearance if motor.ridge is not None else 0.0
    plate = max(floor + motor.screw.head_height, ridge)
    if motor.horn is None:
        start = max(plate, motor.shaft.boss_height) + options.clearance
        return Drive(floor=floor, plate=plate, disc=0.0, start=start, tip=motor.shaft.length)
    disc = motor.horn.screw.floor(coupling_wall(motor.horn, options))
    start = max(plate, motor.horn.height + disc + motor.horn.screw.head_height) + options.clearance
    return Drive(floor=floor, plate=plate, disc=disc, start=start, tip=start + STUB)


def coupling_wall(horn: Horn, options: PartOptions) -> float:
    """Least thickness of a coupling under the heads of its screws [mm]: above a hub there is a wall left."""
    return options.wall if not horn.hub else horn.hub_height + options.clearance + options.wall


def roof_of(options: PartOptions) -> float:
    """Thickness of the roof of a housing [mm]."""
    return max(options.wall, _ROOF)


@dataclass(frozen=True, kw_only=True)
class Housing:
    """A plate and a box round a spool; lengths in millimeters, z above the face of the motor."""

    motor: Motor  # motor under it
    spool: Spool  # spool in it
    # direction in which the cables of each groove leave, counted from +x [degrees], multiples of 90
    azimuths: tuple[int, ...]
    outside: bool  # True if its motor stands on a base outside the body: its screws then go on through the base
    options: PartOptions  # sizes of the parts

    @cached_property
    def drive(self) -> Drive:
        """Place of the spool on its motor."""
        return drive_of(self.motor, self.options)

    @property
    def roof(self) -> float:
        """Thickness of the roof [mm]."""
        return roof_of(self.options)

    @property
    def under_roof(self) -> float:
        """Height of the lower side of the roof [mm]."""
        return self.drive.start + self.spool.body + self.options.clearance

    @property
    def top(self) -> float:
        """Height of the upper side of the roof [mm]."""
        return self.under_roof + self.roof

    @cached_property
    def cavity(self) -> float:
        """Radius of the room for the spool [mm]."""
        turning = max(self.spool.radius, self.motor.horn.radius if self.motor.horn else 0.0)
        return turning + 2 * self.options.clearance

    @cached_property
    def post(self) -> float:
        """Distance of the screws of the box from the axis, along x and along y [mm].

        Clear of the channels, of the room of the spool, of the screws in the face, and outside of the motor if there is
        a base.
        """
        wall, passage = self.options.wall, self.screw.passage / 2
        largest = max(groove.radius for groove in self.spool.grooves)
        least = [largest + self._seat_radius + wall + passage, (self.cavity + wall + passage) / math.sqrt(2)]
        if self.motor.horn is None:
            least.append((self.recess + wall / 2 + passage) / math.sqrt(2))
        found = max(least)
        while self._is_blocked(found):
            found += _TRY
        return found

    def _is_blocked(self, post: float) -> bool:
        """Return True if a screw would collide with a screw in the face, or with a motor below the base."""
        mine = self.screw.passage / 2
        if self.outside:
            corners = MultiPoint([(x, y) for x in (-post, post) for y in (-post, post)])
            cut = Polygon(self.motor.outline).buffer(self.options.clearance)
            if corners.distance(cut) < mine + self.options.wall:
                return True
        if self.motor.horn is None:
            return False
        slots = [(abs(x + side), abs(y)) for x, y in self.motor.holes for side in (-self.motor.slot, self.motor.slot)]
        head = self.motor.screw.head / 2 + self.options.fit
        apart = mine + self.options.wall / 2
        return min(math.dist(slot, (post, post)) for slot in slots) < head + apart or self._is_over_ridge(post, apart)

    def _is_over_ridge(self, post: float, apart: float) -> bool:
        """Return True if a screw would be nearer [mm] to the part of the case that goes through the plate."""
        if self.motor.ridge is None:
            return False
        (x, y, _), (right, top, _) = self.motor.ridge.low, self.motor.ridge.high
        cut = Polygon([(x, y), (right, y), (right, top), (x, top)]).buffer(self.options.clearance)
        return MultiPoint([(side, along) for side in (-post, post) for along in (-post, post)]).distance(cut) < apart

    @cached_property
    def half(self) -> float:
        """Half the width of the box [mm]."""
        wall = self.options.wall
        return max(self.post + self.screw.passage / 2 + wall, self.cavity + wall, self.recess + wall / 2)

    @property
    def recess(self) -> float:
        """Radius of the recess in the plate for the heads of the screws, or for the horn [mm]."""
        if self.motor.horn is not None:
            return self.motor.horn.radius + self.options.clearance
        furthest = max(math.hypot(x, y) for x, y in self.motor.holes)
        return furthest + self.motor.screw.head / 2 + self.options.clearance

    @property
    def _seat_radius(self) -> float:
        return self.options.tube / 2 + self.options.fit

    @cached_property
    def screw(self) -> Screw:
        """Screw that holds the box, one of four: the longest that ends in the plate, or below a nut under the base."""
        if self.outside:
            length = next((each for each in _LENGTHS if each >= self.top + SHEET + _NUT), _LENGTHS[-1])
        else:
            length = max((each for each in _LENGTHS if each <= self.top - 0.3), default=_LENGTHS[0])
        end = "machine thread, with a nut" if self.outside else "self-tapping or machine thread"
        title = f"M2 x {length:g} mm countersunk screw (housing), {end}"
        return Screw(title=title, length=length, core=1.5, pilot=1.7, passage=2.4, head=3.8, head_height=1.2)

    @property
    def head_depth(self) -> float:
        """Depth of the heads of these screws below the upper side of the roof [mm]."""
        return 0.0 if self.outside else max(0.0, self.top - 0.3 - self.screw.length)

    def height(self, groove: int) -> float:
        """Height of the middle of a groove, by its place on the spool [mm]."""
        return self.drive.start + self.spool.middles[groove]

    def heights(self, groove: int) -> tuple[float, ...]:
        """Height of the channel of each cable of a groove, the highest first: tubes of a pair lie side by side [mm]."""
        lines, apart = self.spool.grooves[groove].lines, self.options.tube + self.options.fit
        return tuple(self.height(groove) + apart * ((lines - 1) / 2 - line) for line in range(lines))

    def aside(self, groove: int) -> float:
        """Offset of the channel of a groove to the left of the way in which its cables leave [mm]."""
        found = self.spool.grooves[groove]
        return found.radius if found.reverse else -found.radius

    @property
    def lead(self) -> float:
        """Length of cable from its spool to the outer face of the box [mm]."""
        return self.half

    def seat(self, cable: int) -> float:
        """Depth of the tube of a cable in the box [mm]."""
        radius = self.spool.grooves[cable].radius
        wall = self.half - math.sqrt(max(0.0, self.cavity**2 - radius**2))
        return min(_SEAT, 0.65 * wall)

    @cached_property
    def tongue(self) -> tuple[Corner, Corner]:
        """Corners of what the plate covers, seen along the shaft: the box, and all screws in the face with a wall."""
        wall = self.options.wall
        edge = self.motor.screw.hole / 2 + wall
        xs = [abs(x) + self.motor.slot + edge for x, _ in self.motor.holes] if self.motor.horn is not None else []
        if self.motor.ridge is not None:
            xs.append(self.motor.ridge.high[0] + self.options.clearance + wall)
        low = min([-self.half, *(y - edge for _, y in self.motor.holes)])
        side = max(xs, default=self.half)
        return (-side, low), (side, self.half)

    @property
    def room(self) -> Cuboid:
        """Box round it and its motor [mm]."""
        xs, ys = zip(*self.motor.outline, *self.tongue, strict=True)
        low, high = (min(-self.half, *xs), min(ys), -self.motor.depth), (max(self.half, *xs), max(ys), self.top)
        return Cuboid(low=low, high=high)

    def plate(self) -> Construction:
        """Plate as it lies on the motor."""
        half, drive, motor = self.half, self.drive, self.motor
        body: Construction = Box((2 * half, 2 * half, drive.plate)).move(-half, -half, 0)
        if motor.horn is not None:
            (low_x, low_y), (high_x, _) = self.tongue
            body = body + Box((high_x - low_x, -low_y, drive.floor)).move(low_x, low_y, 0)
            under = motor.horn.under - self.options.clearance if motor.horn.under else -1.0
            body = body - Cylinder(drive.plate + 2, self.recess).move(0, 0, under)
            body = body - Cylinder(drive.plate + 2, motor.shaft.boss + self.options.clearance).move(0, 0, -1)
        else:
            body = body - Cylinder(drive.plate, self.recess).move(0, 0, drive.floor)
            body = body - Cylinder(drive.plate, motor.shaft.boss + self.options.clearance).move(0, 0, -1)
        if motor.ridge is not None:
            wide, deep, tall = (side + 2 * self.options.clearance for side in motor.ridge.size)
            x, y, _ = (low - self.options.clearance for low in motor.ridge.low)
            tall = max(tall, drive.plate + 1)  # no thin skin is left above it
            body = body - Box((wide, deep, tall)).move(x, y, -self.options.clearance)
        for x, y in motor.holes:
            body = body - self._slot(motor.screw.hole / 2).move(x, y, -1)
            if motor.horn is not None:
                body = body - self._slot(motor.screw.head / 2 + self.options.fit).move(x, y, drive.floor)
        if self.outside:
            hole = Cylinder(drive.plate + 2, self.screw.passage / 2).move(0, 0, -1)
        else:
            hole = Cylinder(drive.plate, self.screw.pilot / 2).move(0, 0, 0.4)
        return self._at_posts(body, hole)

    def _slot(self, radius: float) -> Construction:
        """A hole, drawn out to both sides along x."""
        tall, slot = self.drive.plate + 2, self.motor.slot
        hole: Construction = Cylinder(tall, radius)
        if slot:
            ends = hole.move(-slot, 0, 0) + hole.move(slot, 0, 0)
            hole = ends + Box((2 * slot, 2 * radius, tall)).move(-slot, -radius, 0)
        return hole

    def _at_posts(self, body: Construction, hole: Construction) -> Construction:
        for x in (-self.post, self.post):
            for y in (-self.post, self.post):
                body = body - hole.move(x, y, 0)
        return body

    def box(self) -> Construction:
        """Box as it stands on the plate."""
        half, low, top = self.half, self.drive.plate, self.top
        body: Construction = Box((2 * half, 2 * half, top - low)).move(-half, -half, low)
        body = body - Cylinder(self.under_roof - low + 1, self.cavity).move(0, 0, low - 1)
        body = body - Cylinder(self.roof + 2, self.spool.pin + self.options.clearance).move(0, 0, self.under_roof - 1)
        screw, sunk = self.screw, self.head_depth
        cone = (screw.head - screw.passage) / 2 + 0.1
        hole: Construction = Cylinder(top - low + 2, screw.passage / 2).move(0, 0, low - 1)
        hole = hole + Cylinder(cone, screw.passage / 2, screw.head / 2 + 0.1).move(0, 0, top - sunk - cone)
        hole = hole + Cylinder(sunk + 1, screw.head / 2 + 0.1).move(0, 0, top - sunk)
        body = self._at_posts(body, hole)
        for place, azimuth in enumerate(self.azimuths):
            body = body - self._channel(place).rotate(z=azimuth)
        return body

    def _channel(self, place: int) -> Construction:
        """Channels of the cables of a groove that leave along +x."""
        seat = self.seat(place)
        bore = Cylinder(self.half + 1, self.options.bore / 2).rotate(y=90)
        end = Cylinder(seat + 1, self._seat_radius).rotate(y=90).move(self.half - seat, 0, 0)
        aside = self.aside(place)
        first, *others = self.heights(place)
        channels = (bore + end).move(0, aside, first)
        for height in others:
            channels = channels + (bore + end).move(0, aside, height)
        return channels

    def coupling(self) -> Construction | None:
        """The disc with a shaft that is screwed on a horn, as it stands on the bed."""
        horn, drive = self.motor.horn, self.drive
        if horn is None:
            return None
        body: Construction = Cylinder(drive.disc, horn.radius)
        body = body + self.motor.shaft.shape(drive.tip - horn.height)
        if horn.hub:
            body = body - Cylinder(
                horn.hub_height + self.options.clearance + 1, horn.hub + self.options.clearance
            ).move(0, 0, -1)
        hole = Cylinder(drive.disc + 2, horn.screw.hole / 2).move(horn.circle, 0, -1)
        for step in range(horn.count):
            body = body - hole.rotate(z=360 / horn.count * step)
        return body
