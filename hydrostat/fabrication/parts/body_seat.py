"""`BodySeat`: a cup for the end by which a body of foam is held, above a plate where its tubes end, on legs.

A body is simulated as held in its pins, and its outside cables as beginning at fixed places behind it. The seat makes
both true: the cup is as deep as the pin, and the plate has a bore at the very place where each cable begins. In its own
coordinates it stands upright: the body's end lies on the floor of the cup, z = 0, and the body rises along z.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from manifold3d import Manifold
from shapely.geometry import LineString, Point, Polygon, box
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from hydrostat.arrays import Float
from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.base_plan import POST, post
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed
from hydrostat.fabrication.solids.body_solid import body_solid
from hydrostat.fabrication.solids.construct import Construction, Corner, Cylinder, Prism, sides_text
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.robot import Mount, Pin, Robot
from hydrostat.units import MILLIMETERS


@dataclass(frozen=True, kw_only=True)
class _SeatSizes:
    """Sizes of a seat in millimeters.

    Attributes:
        wall: thickness of the cup.
        floor: thickness of its floor.
        plate: thickness of the plate.
        lip: height of the plate above the end of a tube.
        flange: width of the flange round the cup.
        inset: distance of its screws from its corner.
        beyond: width of the plate beyond the flange, for the legs.
        screw_hole: hole for a screw M3.
        tie_hole: hole for a thread or cable tie.
        tie_spacing: approximate distance of these holes.
        under: room below the plate, where tubes bend away.
        min_post: shortest post that takes a screw at both ends.
        level: maximum difference in height of the first points of cables.
        max_wider: maximum ratio of the area of the cup to the pinned area.
    """

    wall: float = 2.4
    floor: float = 4.0
    plate: float = 8.0
    lip: float = 1.5
    flange: float = 11.0
    inset: float = 5.5
    beyond: float = 14.0
    screw_hole: float = 3.4
    tie_hole: float = 3.0
    tie_spacing: float = 30.0
    under: float = 70.0
    min_post: float = 28.0
    level: float = 1.0
    max_wider: float = 1.3


_SIZES = _SeatSizes()


@dataclass(frozen=True, eq=False, kw_only=True)
class BodySeat:
    """A seat for a body whose winches stand outside, or why there is none."""

    printed: tuple[Printed, ...] = ()  # cup, plate, posts, legs
    assembly: PartAssembly | None = None  # all of it, with the end of the body
    bought: tuple[tuple[str, int], ...] = ()  # parts to buy for it, with the count of each
    held: tuple[int, ...] = ()  # indices of cables whose tubes are held where they begin
    problems: tuple[str, ...] = ()  # why it cannot be printed
    warnings: tuple[str, ...] = ()  # warnings for the builder


def body_seat(robot: Robot, options: PartOptions, bed: tuple[float, float, float]) -> BodySeat:
    """The seat of a body in space, in pieces that fit the bed [mm]; empty, with the reason, where none can be made."""
    outside = {winch.name for winch in robot.winches if winch.mount is Mount.WORLD}
    cables = [index for index, cable in enumerate(robot.cables) if cable.winch in outside]
    if not cables:
        return BodySeat()
    plan = _plan(robot, cables, options)
    if isinstance(plan, str):
        return BodySeat(warnings=(f"no seat is made for the body: {plan}. Clamp the body at its pins",))
    return plan.seat(robot.name, options, bed)


Line = Float[np.ndarray, "2 3"]  # from where a cable begins to where it comes to the body, in the seat's coordinates


@dataclass(frozen=True, eq=False, kw_only=True)
class _SeatPlan:
    """The seat from above, and how high its parts are [mm]."""

    end: Manifold  # end of the body, a little more than the cup holds
    cavity: Polygon  # cavity of the cup
    depth: float  # depth of the cup
    below: float  # from the body's end down to where cables begin
    lines: tuple[Line, ...]  # lines of the cables that are held
    held: tuple[int, ...]  # indices of these cables
    ends: tuple[bool, ...]  # True for each tube that ends there
    flange: Polygon  # round the cup, with the posts at its corners

    def seat(self, name: str, options: PartOptions, bed: tuple[float, float, float]) -> BodySeat:
        """All parts of it."""
        plate, legs = self._plate(options), post(_SIZES.under)
        solids = (
            Printed.of(self._cup(options), name="seat_cup", title="Cup of the seat", note="Floor down, no support."),
            Printed.of(plate, name="seat_plate", title="Plate of the seat", note="Narrow holes up, no support."),
            Printed.of(
                post(self._tall), name="seat_post", title="Post of the seat", count=4, note="Standing, with a brim."
            ),
            Printed.of(legs, name="seat_leg", title="Leg of the seat", count=4, note="Standing, with a brim."),
        )
        large = [part for part in solids if not part.fits(bed)]
        return BodySeat(
            printed=solids,
            assembly=self._assembly(name, solids),
            bought=(("M3 x 10 mm screw (seat)", 16),),
            held=self.held,
            problems=tuple(
                f"{part.name} is {sides_text(part.size)} mm, the bed {sides_text(bed)} mm" for part in large
            ),
        )

    @property
    def _tall(self) -> float:
        """Height of the posts."""
        return self.below - _SIZES.lip - _SIZES.floor

    @property
    def _posts(self) -> tuple[Corner, ...]:
        return _corners(self.flange.buffer(-_SIZES.inset, join_style="mitre"))

    @property
    def _board(self) -> Polygon:
        """The plate: as large as the flange and all tubes, and the legs beyond."""
        tubes = [Point(line[0, :2]).buffer(6.0) for line in self.lines]
        return box(*unary_union([self.flange, *tubes]).bounds).buffer(_SIZES.beyond, join_style="mitre")

    @property
    def _legs(self) -> tuple[Corner, ...]:
        return _corners(self._board.buffer(-POST / 2, join_style="mitre"))

    def _cup(self, options: PartOptions) -> Construction:
        """Flange and cup, with room for the cables and holes for the thread that holds the body; its floor at z = 0."""
        around = Polygon(self.cavity.buffer(_SIZES.wall).simplify(0.1).exterior)  # type: ignore[attr-defined]
        made = Prism(_ring(self.flange), _SIZES.floor) + Prism(_ring(around), _SIZES.floor + self.depth)
        made = made - Prism(_ring(self.cavity), self.depth + 1).move(z=_SIZES.floor)
        for spot, turn in self._ties():
            hole = Cylinder(3 * _SIZES.wall, _SIZES.tie_hole / 2).rotate(y=90, z=turn)
            made = made - hole.move(*spot, _SIZES.floor + self.depth / 2)
        for x, y in self._posts:
            made = made - Cylinder(_SIZES.floor + 2, _SIZES.screw_hole / 2).move(x, y, -1)
        for line in self.lines:
            made = made - _way(line, options.tube / 2 + 0.75).move(z=_SIZES.floor)
        return made

    def _ties(self) -> list[tuple[Corner, float]]:
        """Holes through the wall: where each begins outside of it, and its direction inwards [degrees]."""
        rim, found = self.cavity.exterior, []
        count = max(4, round(rim.length / _SIZES.tie_spacing))
        for place in (np.arange(count) + 0.5) / count:
            one, other = (np.array(rim.interpolate(place + step, normalized=True).coords[0]) for step in (-0.01, 0.01))
            along = (other - one) / np.linalg.norm(other - one)
            inward = np.array([-along[1], along[0]])  # the rim runs counter-clockwise
            x, y = (one + other) / 2 - 2 * _SIZES.wall * inward
            found.append(((float(x), float(y)), math.degrees(math.atan2(inward[1], inward[0]))))
        return found

    def _plate(self, options: PartOptions) -> Construction:
        """The plate, its upper side at z = 0; a tube that ends in it stops below a lip, any other goes through."""
        made: Construction = Prism(_ring(self._board), _SIZES.plate).move(z=-_SIZES.plate)
        for line, stops in zip(self.lines, self.ends, strict=True):
            x, y = line[0, :2]
            top, play = (-_SIZES.lip, 0.05) if stops else (1.0, 0.25)
            made = made - Cylinder(_SIZES.plate + 1 + top, options.tube / 2 + play).move(x, y, -_SIZES.plate - 1)
            made = made - Cylinder(_SIZES.plate, options.cable + 0.2).move(x, y, -_SIZES.plate + 1)
        for x, y in (*self._posts, *self._legs):
            made = made - Cylinder(_SIZES.plate + 2, _SIZES.screw_hole / 2).move(x, y, -_SIZES.plate - 1)
        return made.move(z=_SIZES.plate)

    def _assembly(self, name: str, solids: Sequence[Printed]) -> PartAssembly:
        cup, plate, posts, legs = solids
        top = -self.below + _SIZES.lip
        pieces = [
            Placed(name="body", title="End of the body", solid=self.end, pulled=(0, 0, 25 + self.depth), printed=False),
            Placed(name=cup.name, title=cup.title, solid=cup.solid.translate((0, 0, -_SIZES.floor))),
            Placed(
                name=plate.name,
                title=plate.title,
                solid=plate.solid.translate((0, 0, top - _SIZES.plate)),
                pulled=(0, 0, -60),
            ),
        ]
        for part, spots, low, pulled in (
            (posts, self._posts, top, -30.0),
            (legs, self._legs, top - _SIZES.plate - _SIZES.under, -90.0),
        ):
            pieces += [
                Placed(
                    name=f"{part.name} {number}",
                    title=part.title,
                    solid=part.solid.translate((*spot, low)),
                    pulled=(0, 0, pulled),
                )
                for number, spot in enumerate(spots, start=1)
            ]
        return PartAssembly(name=f"seat of {name}", pieces=tuple(pieces))


def _plan(robot: Robot, cables: Sequence[int], options: PartOptions) -> "_SeatPlan | str":
    """Return the layout of the seat, or the reason why there can be none."""
    if robot.body.mesh.dim == 2:
        return "the body is flat"
    if len(robot.pins) != 1:
        return f"it has {len(robot.pins)} pins" if robot.pins else "it has no pin"
    ways = MILLIMETERS * np.array([robot.cables[index].points[:2] for index in cables])
    back = (ways[:, 0] - ways[:, 1]).mean(axis=0)
    body, turn = body_solid(robot.body), _upright(back)
    body = body.transform(np.column_stack([turn, np.zeros(3)]))
    floor = body.bounding_box()[2]
    body, lines = body.translate((0, 0, -floor)), ways @ turn.T - [0, 0, floor]
    low, top = (reach - floor for reach in _reach(robot.pins[0], turn))
    if low > 1.0 or top < 1.0:
        return "it is not pinned at the end where its cables begin"
    pinned = robot.pins[0].holds(robot.body.mesh)
    own = Polygon(box(*_bounds(MILLIMETERS * robot.body.mesh.nodes[pinned] @ turn.T)))
    cavity = _outline(body, top, options)
    if cavity is None or cavity.area > _SIZES.max_wider * own.buffer(5.0).area:
        return "another part of it is next to the pinned end"
    below = float(np.median(-lines[:, 0, 2]))
    level = [place for place in range(len(cables)) if abs(-lines[place, 0, 2] - below) <= _SIZES.level]
    needed = _SIZES.min_post + _SIZES.lip + _SIZES.floor
    if below < needed:
        return f"its cables begin {below:.0f} mm behind it, and {needed:.0f} mm are needed"
    held = tuple(lines[place] for place in level)
    return _SeatPlan(
        end=body.trim_by_plane((0, 0, -1), -(top + 12.0)),
        cavity=cavity,
        depth=top,
        below=below,
        lines=held,
        held=tuple(cables[place] for place in level),
        ends=tuple(bool(robot.cables[cables[place]].bare[0]) for place in level),
        flange=_flange(cavity, held, options),
    )


def _upright(back: np.ndarray) -> Float[np.ndarray, "3 3"]:
    """The turn that brings the axis nearest to a direction to -z, a right-handed one."""
    axis = int(np.argmax(np.abs(back)))
    up = -np.sign(back[axis]) * np.eye(3)[axis]
    side = np.eye(3)[(axis + 1) % 3]
    return np.array([side, np.cross(up, side), up])


def _reach(pin: Pin, turn: Float[np.ndarray, "3 3"]) -> tuple[float, float]:
    """From where to where a pin holds, along z of the seat [mm]."""
    if pin.box is not None:
        heights = MILLIMETERS * np.array(pin.box) @ turn[2]
        return float(heights.min()), float(heights.max())
    middle = MILLIMETERS * float(np.dot(pin.at or (0.0, 0.0, 0.0), turn[2]))
    return middle - MILLIMETERS * pin.radius, middle + MILLIMETERS * pin.radius


def _outline(body: Manifold, top: float, options: PartOptions) -> Polygon | None:
    """Return the footprint of the end of a body with its clearance [mm]; None if it is in several pieces."""
    rings = body.trim_by_plane((0, 0, -1), -top).project().to_polygons()
    covered = unary_union([Polygon(ring).buffer(0) for ring in rings]).buffer(options.clearance).simplify(0.1)
    return orient(Polygon(covered.exterior)) if isinstance(covered, Polygon) else None


def _flange(cavity: Polygon, lines: Sequence[Line], options: PartOptions) -> Polygon:
    """A rectangle round the cup whose corners, with the posts there, leave room for all cables."""
    ways = [LineString(line[:, :2]).buffer(options.tube / 2 + 1.0) for line in lines]
    flange = cavity
    for more in range(0, 60, 2):
        flange = box(*cavity.buffer(_SIZES.wall + _SIZES.flange + more, join_style="mitre").bounds)
        posts = _corners(flange.buffer(-_SIZES.inset, join_style="mitre"))
        if not any(box(*Point(spot).buffer(POST / 2).bounds).intersects(way) for spot in posts for way in ways):
            break
    return flange


def _way(line: Line, radius: float) -> Construction:
    """Return the channel of a straight cable or tube, up to 2 mm beyond its end [mm]."""
    along = line[1] - line[0]
    length = float(np.linalg.norm(along))
    tilt = math.degrees(math.acos(along[2] / length))
    rod = Cylinder(length + 2.0, radius).rotate(y=tilt, z=math.degrees(math.atan2(along[1], along[0])))
    return rod.move(*(float(value) for value in line[0]))


def _bounds(points: Float[np.ndarray, "points 3"]) -> tuple[float, float, float, float]:
    (x, y, _), (right, high, _) = points.min(axis=0), points.max(axis=0)
    return float(x), float(y), float(right), float(high)


def _corners(area: Polygon) -> tuple[Corner, ...]:
    left, low, right, high = area.bounds
    return (left, low), (right, low), (right, high), (left, high)


def _ring(area: Polygon) -> tuple[Corner, ...]:
    return tuple((float(x), float(y)) for x, y in orient(area).exterior.coords[:-1])
