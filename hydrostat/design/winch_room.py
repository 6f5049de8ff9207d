"""`built_in`, `winch_room`: where a body has room for motor and spool (a configuration space), and how strong."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry.base import BaseGeometry

from hydrostat.arrays import Points
from hydrostat.design.constraints import Constraints
from hydrostat.design.drawn_shapes import drawn_shapes
from hydrostat.design.request import DesignRequest
from hydrostat.design.zone import Zone
from hydrostat.errors import InputError
from hydrostat.fabrication import (
    ALL_MOTORS,
    COMPRESSION_SHARE,
    MOTORS,
    Cuboid,
    Demand,
    KitOptions,
    Method,
    Motor,
    PartOptions,
    PocketRoom,
    find_motor,
    seam_of,
    sides_text,
    unit_room,
)
from hydrostat.ik import IKResult
from hydrostat.robot import Body, Cable, Mount, Robot, Winch, sewn_robot
from hydrostat.units import plural


def built_in(robot: Robot, constraints: Constraints, *, winches: int, cables: int) -> Constraints:
    """The constraints with what motors in the body can do: their room, and the torque that they hold for long.

    Raises InputError: no motor of the kit fits into the body.
    """
    if not has_known_room(robot.body):
        return constraints
    each = -(-cables // winches)
    zones, motor = winch_room(robot, constraints, each, winches=winches)
    if motor is None:
        raise InputError(_no_room(robot, constraints, each, winches))
    own = constraints.torque or math.inf
    return replace(constraints, winch_zones=zones, torque=min(own, _torque_to_hold(motor)))


def limit_torque(constraints: Constraints) -> Constraints:
    """The constraints with the torque that a motor of choice holds for long, wherever the winches stand."""
    if constraints.motor == "auto":
        return constraints
    most = _torque_to_hold(Motor.choose(constraints.motor))
    return replace(constraints, torque=min(constraints.torque or math.inf, most))


def find_holding_torque(robot: Robot, reached: Sequence[IKResult]) -> float | None:
    """Torque that the motor of a kit holds for long [N m], if poses ask for more; None if not, or for no motor."""
    if not any(winch.mount is Mount.BODY for winch in robot.winches):
        return None
    torques = Demand.of_results(robot, reached).torques
    chosen = find_motor(robot, torques.tolist(), KitOptions())
    return _torque_to_hold(chosen) if float(torques.max()) > chosen.largest_torque() else None


def _torque_to_hold(motor: Motor) -> float:
    """Torque that poses may ask of a motor for long [N m], with room for solvers that end near it."""
    return motor.largest_torque() / _RULES.torque_margin


def find_no_room(robot: Robot) -> str | None:
    """Return why no motor of the kit fits into the body for winches that a design would place; None if one fits.

    None too for a robot that drives alone move. A design of one winch may put all of its cables there,
    and its unit is longer the more cables it holds.
    """
    constraints, usual = Constraints(motor=robot.motor), DesignRequest.cables
    if (robot.drives and not robot.winches) or constraints.stand_outside(robot) or not has_known_room(robot.body):
        return None
    return None if winch_room(robot, constraints, usual)[1] is not None else _no_room(robot, constraints, usual, 1)


def find_winch_places(robot: Robot, constraints: Constraints) -> Points:
    """Places in a flat body where a winch of one cable can be built in [m]."""
    zones, motor = winch_room(robot, constraints, 1)
    if motor is None or robot.body.outline is None:
        return np.zeros((0, 2))
    inner = robot.body.outline.polygon.buffer(-constraints.winch_clearance - 1e-5)
    return _grid(
        shapely.intersection(
            shapely.union_all([_shape(zone) for zone in zones]), affinity.scale(inner, 1e3, 1e3, origin=(0.0, 0.0))
        )
    )


def has_known_room(body: Body) -> bool:
    """True for bodies whose room for motors can be computed: flat ones, and those of foam."""
    return body.thickness is not None or KitOptions().method_for(body) is Method.FOAM


def winch_room(
    robot: Robot, constraints: Constraints, cables: int, *, winches: int = 1
) -> tuple[tuple[Zone, ...], Motor | None]:
    """Zones in which a winch with so many cables can be built into a body, and the motor that fits there.

    They are within those of the constraints. In a flat body the unit lies across the body or in its plane, turned by
    whole hours of a clock; it takes both of a pair. In space its pocket lies along the mold. The motor is the strongest
    that leaves room for all winches. Zones as given and None: where no motor fits.
    """
    for motor in reversed(_motors(constraints)):
        box = unit_room(*_example(robot, constraints, cables), PartOptions(), motor)
        if robot.body.thickness is None:
            zones = _pocket_zones(robot, constraints, box, winches)
        else:
            zones = _flat_zones(robot, constraints, box, winches)
        if zones:
            return zones, motor
    return constraints.winch_zones, None


def _motors(constraints: Constraints) -> tuple[Motor, ...]:
    """Motors that a kit may take, from the weakest to the strongest."""
    return tuple(motor for motor in ALL_MOTORS if motor.key == constraints.motor) or MOTORS


def _flat_zones(robot: Robot, constraints: Constraints, box: Cuboid, winches: int) -> tuple[Zone, ...]:
    """Zones in which a unit lies within the seam of a flat body; none if there is no room for all winches.

    Winches stand in no pin and on no drawn eye, unless there is no other room.
    """
    room = _room(robot.body, box)
    if constraints.winch_zones:
        room = room.intersection(shapely.union_all([_shape(zone) for zone in constraints.winch_zones]))
    free = room.difference(_find_taken_parts(robot, constraints.spool_radius))
    for part in (free, room):
        if _has_room_for(_grid(part), winches, _width(box)):
            return _zones(part)
    return ()


def _find_taken_parts(robot: Robot, around: float) -> BaseGeometry:
    """Pins, where the body is clamped, and small shapes drawn on it, such as eyes, and around these [mm]."""
    parts: list[BaseGeometry] = []
    for pin in robot.pins:
        if pin.box is not None:
            (left, bottom), (right, top) = (1e3 * np.array(pin.box)[:, :2]).tolist()
            parts.append(shapely.box(left, bottom, right, top))
        elif pin.at is not None:
            parts.append(shapely.Point(1e3 * np.array(pin.at[:2])).buffer(1e3 * pin.radius))
    drawn = shapely.union_all([shape.buffer(around) for shape in drawn_shapes(robot.body)])
    return shapely.union_all([*parts, affinity.scale(drawn, 1e3, 1e3, origin=(0.0, 0.0))])


def _grid(room: BaseGeometry) -> Points:
    """Places in a room and on its rim [m]."""
    if room.is_empty:
        return np.zeros((0, 2))
    left, bottom, right, top = room.bounds
    x, y = np.meshgrid(np.arange(left, right, _RULES.spacing), np.arange(bottom, top, _RULES.spacing))
    inside = shapely.contains_xy(room, x, y)
    rim = shapely.get_coordinates(shapely.segmentize(room, _RULES.spacing))
    return 1e-3 * np.concatenate([np.column_stack([x[inside], y[inside]]), rim])


def _width(box: Cuboid) -> float:
    """Distance at which units lie next to each other [m]: side of a square as large as the side on which one lies."""
    _, middle, longest = sorted(box.size)
    return 1e-3 * math.sqrt(middle * longest)


def _pocket_zones(robot: Robot, constraints: Constraints, box: Cuboid, winches: int) -> tuple[Zone, ...]:
    """Balls in which the pocket of a winch has room in a body of foam, the largest first."""
    points, radii = PocketRoom.of_robot(robot).places(box)
    if constraints.winch_zones and len(points):
        inside = -np.min([zone.distances(points) for zone in constraints.winch_zones], axis=0)
        points, radii = points[inside >= 0], np.minimum(radii, np.maximum(inside, _RULES.zone_radius))[inside >= 0]
    if not _has_room_for(points, winches, _width(box)):
        return ()
    zones: list[Zone] = []
    left = np.ones(len(points), dtype=bool)
    while left.any() and len(zones) < _RULES.num_balls:
        number = int(np.argmax(np.where(left, radii, -1.0)))
        middle = points[number]
        zones.append(Zone(at=tuple(middle.round(5).tolist()), radius=round(float(radii[number]), 5)))
        left &= np.linalg.norm(points - middle, axis=1) > radii[number]
    return tuple(zones)


def _has_room_for(points: Points, winches: int, apart: float) -> bool:
    """True if so many places are farther apart than a unit is wide [m], each as far as it can be from the others."""
    if not len(points):
        return False
    away = np.linalg.norm(points - points[np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1))], axis=1)
    for _ in range(winches - 1):
        farthest = int(np.argmax(away))
        if away[farthest] < apart:
            return False
        away = np.minimum(away, np.linalg.norm(points - points[farthest], axis=1))
    return True


def _no_room(robot: Robot, constraints: Constraints, cables: int, winches: int) -> str:
    """Reason why no motor can be built in, and the changes that would allow one."""
    counts = range(cables - 1, 0, -1)
    fits = next((count for count in counts if winch_room(robot, constraints, count, winches=winches)[1] is not None), 0)
    if fits:
        return (
            f"body: no room for a motor with {cables} cables on its winch, but for one with {fits}. Ask for fewer, "
            f"e.g. --winches {winches} --cables {winches * fits}."
        )
    motor, body, cables = _motors(constraints)[0], robot.body, 1
    box = unit_room(*_example(robot, constraints, cables), PartOptions(), motor)
    smallest = f"{motor.title}, {sides_text(sorted(box.size, reverse=True))} mm"
    lift = 'Or put winches outside, as [[winch]] with mount = "world".'
    free = replace(constraints, winch_zones=())
    if constraints.winch_zones and winch_room(robot, free, cables, winches=winches)[1] is not None:
        return f"winch_zones: no motor of the kit fits in them (smallest: {smallest}). Widen or remove them. {lift}"
    scale = _least_scale(lambda scale: _has_room(robot, box, winches, scale))
    sizes = f"{_round_up(1e3 * scale * body.mesh.size):g} mm long"
    if body.thickness is not None:
        thick = 1e-3 * _round_up(1e3 * scale * body.thickness)
        alone = _has_room(replace(robot, body=replace(body, thickness=thick)), box, winches, 1.0)
        sizes = f"{1e3 * thick:g} mm thick" if alone else f"{sizes} and {1e3 * thick:g} mm thick"
    count = plural(winches, "motor") if winches > 1 else "the motor"
    return f"body: no room for {count} (smallest: {smallest}). Make it at least {sizes}. {lift}"


def _has_room(robot: Robot, box: Cuboid, winches: int, scale: float) -> bool:
    """True if the units of all winches have room in a body that is scaled by a factor."""
    if robot.body.thickness is not None:
        return _has_room_for(_grid(_room(robot.body, box, scale)), winches, _width(box))
    return _has_room_for(PocketRoom.of_robot(robot).places(box, scale=scale)[0], winches, _width(box))


def _least_scale(fits: Callable[[float], bool]) -> float:
    """The least factor of a body at which it has room, to 2 %."""
    low, high = 1.0, 1.25
    while not fits(high):
        low, high = high, 1.25 * high
    while high - low > _RULES.precision * low:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if fits(middle) else (middle, high)
    return high


def _round_up(length: float) -> float:
    """A length [mm] as a builder would give it: in steps of 1 mm, from 100 mm on of 5 mm."""
    step = 5.0 if length >= 100 else 1.0
    return step * math.ceil(length / step)


def _example(robot: Robot, constraints: Constraints, cables: int) -> tuple[Robot, Winch]:
    """A robot with such a winch somewhere."""
    first, second = robot.body.mesh.nodes[robot.body.mesh.elements[0][:2]]
    winch = Winch(
        name="winch", at=tuple(first.tolist()), spool_radius=constraints.spool_radius, travel=constraints.travel,
        release=constraints.release,
    )  # fmt: skip
    ends = first + np.linspace(1.0, 0.5, cables)[:, None] * (second - first)
    drawn = [Cable(winch="winch", points=(winch.at, tuple(end))) for end in ends.tolist()]
    return sewn_robot(robot.with_network([winch], drawn)), winch


def _room(body: Body, box: Cuboid, scale: float = 1.0) -> BaseGeometry:
    """Places of the unit's middle at which it is within the seam of a scaled body some way round [mm]."""
    thickness = scale * 1e3 * float(body.thickness or 0.0)
    seam = affinity.scale(seam_of(body), scale, scale, origin=(0.0, 0.0))
    seam = shapely.simplify(seam.buffer(-_RULES.simplification), _RULES.simplification)
    sides = []
    if box.size[2] <= (1 + COMPRESSION_SHARE) * thickness:
        sides.append((box.low[:2], box.high[:2]))
    if box.size[0] <= (1 + COMPRESSION_SHARE) * thickness:
        middle = box.high[2] / 2
        low, high = box.low[2] - middle, box.high[2] - middle
        sides += [((low, box.low[1]), (high, box.high[1])), ((-high, box.low[1]), (-low, box.high[1]))]
    found = [_erode(seam, low, high, math.radians(turn)) for low, high in sides for turn in range(0, 360, _RULES.turn)]
    return shapely.union_all(found) if found else shapely.Polygon()


def _erode(seam: BaseGeometry, low: tuple[float, ...], high: tuple[float, ...], turn: float) -> BaseGeometry:
    """Erode the seam's region to middles of a turned rectangle that is inside with all of its rim (Minkowski) [mm]."""
    corners = np.array([low[:2], (high[0], low[1]), high[:2], (low[0], high[1])], dtype=float)
    right, up = np.array([math.sin(turn), -math.cos(turn)]), np.array([math.cos(turn), math.sin(turn)])
    corners = corners[:, :1] * right + corners[:, 1:] * up
    room = seam
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = max(1, math.ceil(float(np.linalg.norm(end - start)) / _RULES.spacing))
        for share in np.arange(count) / count:
            place = start + share * (end - start)
            room = room.intersection(shapely.transform(seam, partial(np.add, -place)))
            if room.is_empty:
                return room
    return room


def _shape(zone: Zone) -> BaseGeometry:
    """The zone as a polygon [mm]."""
    if zone.at is not None and zone.radius is not None:
        return shapely.Point(1e3 * np.array(zone.at)).buffer(1e3 * zone.radius)
    if zone.box is not None:
        (left, bottom), (right, top) = (1e3 * np.array(corner) for corner in zone.box)
        return shapely.box(left, bottom, right, top)
    return shapely.Polygon(1e3 * np.array(zone.outline))


def _zones(room: BaseGeometry) -> tuple[Zone, ...]:
    """The parts of a room that are worth standing in [m]; those with holes as parts without that overlap."""
    parts = shapely.get_parts(shapely.simplify(room, _RULES.simplification))
    kept = [piece for part in parts if isinstance(part, shapely.Polygon) for piece in _without_holes(part)]
    return tuple(
        Zone(outline=tuple((float(x), float(y)) for x, y in 1e-3 * np.array(part.exterior.coords)[:-1]))
        for part in sorted(kept, key=lambda part: -part.area)
        if part.area >= _RULES.min_area
    )


def _without_holes(part: shapely.Polygon) -> list[shapely.Polygon]:
    """The part itself, or what lies left, right, below and above of its largest hole; small holes are filled."""
    holes = [shapely.Polygon(ring) for ring in part.interiors if shapely.Polygon(ring).area >= _RULES.min_hole]
    if not holes:
        return [shapely.Polygon(part.exterior)]
    left, bottom, right, top = max(holes, key=lambda hole: hole.area).bounds
    low_x, low_y, high_x, high_y = part.bounds
    sides = (
        shapely.box(low_x, low_y, left, high_y),
        shapely.box(right, low_y, high_x, high_y),
        shapely.box(low_x, low_y, high_x, bottom),
        shapely.box(low_x, top, high_x, high_y),
    )
    pieces = [piece for side in sides for piece in shapely.get_parts(part.intersection(side))]
    return [
        more
        for piece in pieces
        if isinstance(piece, shapely.Polygon) and piece.area > 0
        for more in _without_holes(piece)
    ]


@dataclass(frozen=True, kw_only=True)
class _RoomRules:
    """Tolerances and sizes of the search for room.

    Attributes:
        torque_margin: factor by which torques may end above their limit, or half of that.
        turn: angle between the turns that are tried [degrees].
        spacing: distance of the places of a rim that are examined [mm].
        simplification: maximum error of the simplified seam [mm].
        min_area: area below which rooms are left out [mm^2].
        min_hole: area below which holes of a room are left out [mm^2].
        zone_radius: radius of a zone that stands for a point [m].
        num_balls: number of balls that show where pockets have room.
        precision: precision of the scale.
    """

    torque_margin: float = 1.002
    turn: int = 30
    spacing: float = 5.0
    simplification: float = 0.2
    min_area: float = 4.0
    min_hole: float = 100.0
    zone_radius: float = 1e-4
    num_balls: int = 24
    precision: float = 0.02


_RULES = _RoomRules()
