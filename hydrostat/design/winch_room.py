"""`built_in`, `winch_room`: where a flat body has room for motor and spool (a configuration space), and how strong."""

import math
from dataclasses import replace

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry.base import BaseGeometry

from hydrostat.design.constraints import Constraints
from hydrostat.design.zone import Zone
from hydrostat.fabrication import GIVES, MOTORS, Cuboid, Motor, PartOptions, largest_torque, seam_of, unit_room
from hydrostat.robot import Body, Cable, Robot, Winch, sewn_robot


def built_in(robot: Robot, constraints: Constraints, *, winches: int, cables: int) -> Constraints:
    """The constraints with what motors in the body can do: their room, and their torque where only weak ones fit.

    The strongest motor of the kit sets no torque: where poses ask for more than it gives, there is no other to choose.
    """
    zones, motor = winch_room(robot, constraints, -(-cables // winches))
    found = replace(constraints, winch_zones=zones)
    if motor is None or motor is MOTORS[-1]:
        return found
    return replace(
        found,
        torque=min(constraints.torque or math.inf, largest_torque(motor, inside=True)),
        cables_per_winch=min(constraints.cables_per_winch, cables - winches + 1),  # the others have one at least
    )


def winch_room(robot: Robot, constraints: Constraints, cables: int) -> tuple[tuple[Zone, ...], Motor | None]:
    """Zones in which a winch with so many cables can be built into a flat body, and the motor that fits there.

    They are within those of the constraints. The unit lies across the body or in its plane, turned by whole hours of a
    clock; it takes both of a pair. The motor is the strongest that leaves any room. Zones as given and None: where no
    motor fits, and in space.
    """
    body = robot.body
    if body.thickness is None:
        return constraints.winch_zones, None
    allowed = None
    if constraints.winch_zones:
        allowed = shapely.union_all([_shape(zone) for zone in constraints.winch_zones])
    for motor in reversed(MOTORS):
        box = unit_room(*_example(robot, constraints, cables), PartOptions(), motor)
        room = _room(body, box)
        zones = _zones(room if allowed is None else room.intersection(allowed))
        if zones:
            return zones, motor
    return constraints.winch_zones, None


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


def _room(body: Body, box: Cuboid) -> BaseGeometry:
    """Places of the unit's middle at which it is within the seam some way round [mm]."""
    thickness = 1e3 * float(body.thickness or 0.0)
    seam = shapely.simplify(seam_of(body).buffer(-_ROUGH), _ROUGH)
    sides = []
    if box.size[2] <= (1 + GIVES) * thickness:
        sides.append((box.low[:2], box.high[:2]))
    if box.size[0] <= (1 + GIVES) * thickness:
        middle = box.high[2] / 2
        low, high = box.low[2] - middle, box.high[2] - middle
        sides += [((low, box.low[1]), (high, box.high[1])), ((-high, box.low[1]), (-low, box.high[1]))]
    found = [_erode(seam, low, high, math.radians(turn)) for low, high in sides for turn in range(0, 360, _HOUR)]
    return shapely.union_all(found) if found else shapely.Polygon()


def _erode(seam: BaseGeometry, low: tuple[float, ...], high: tuple[float, ...], turn: float) -> BaseGeometry:
    """Erode the seam's region to middles of a turned rectangle that is inside with all of its rim (Minkowski) [mm]."""
    corners = np.array([low[:2], (high[0], low[1]), high[:2], (low[0], high[1])], dtype=float)
    right, up = np.array([math.sin(turn), -math.cos(turn)]), np.array([math.cos(turn), math.sin(turn)])
    corners = corners[:, :1] * right + corners[:, 1:] * up
    room = seam
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = max(1, math.ceil(float(np.linalg.norm(end - start)) / _APART))
        for share in np.arange(count) / count:
            x, y = start + share * (end - start)
            room = room.intersection(affinity.translate(seam, -x, -y))
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
    """The parts of a room that are worth standing in, without their holes [m]."""
    parts = shapely.get_parts(shapely.simplify(room, _ROUGH))
    kept = [part for part in parts if isinstance(part, shapely.Polygon) and part.area >= _LEAST]
    return tuple(
        Zone(outline=tuple((float(x), float(y)) for x, y in 1e-3 * np.array(part.exterior.coords)[:-1]))
        for part in sorted(kept, key=lambda part: -part.area)
    )


_HOUR = 30  # between the turns that are tried [degrees]
_APART = 5.0  # between the places of a rim that are looked at [mm]
_ROUGH = 0.2  # by so much may the seam be drawn simpler [mm]
_LEAST = 4.0  # smaller rooms are none [mm^2]
