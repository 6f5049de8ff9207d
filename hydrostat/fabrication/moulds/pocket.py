"""`Pocket`: room in the foam for a winch, left by a core of the mold; and dents in the foam where cables run."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from manifold3d import Manifold

from hydrostat.arrays import Float
from hydrostat.errors import InputError
from hydrostat.fabrication.moulds.release import FineSurface, axes_along
from hydrostat.fabrication.moulds.solids import join_solids, rod
from hydrostat.fabrication.moulds.stance import MoldOrientation
from hydrostat.fabrication.solids.construct import Cuboid, Sides, sides_text
from hydrostat.geometry import Solid, Surface
from hydrostat.robot import Mount, Robot
from hydrostat.units import MILLIMETERS


@dataclass(frozen=True, kw_only=True)
class WinchRoom(Cuboid):
    """Box round a winch, its shaft along z through the origin; lengths in millimeters."""

    @classmethod
    def about_the_middle(cls, sides: Sides) -> "WinchRoom":
        """A box whose shaft is in its middle."""
        a, b, c = (side / 2 for side in sides)
        return cls(low=(-a, -b, -c), high=(a, b, c))

    @property
    def off(self) -> Sides:
        """Way from the winch's place to the middle of the box [mm]: across the shaft only.

        Along the shaft the middle of the box is at the winch's place: the foam gives a cable that little way.
        """
        return (self.low[0] + self.high[0]) / 2, (self.low[1] + self.high[1]) / 2, 0.0


MIN_SKIN = 2.0  # foam between a pocket and the next surface [mm]
_WIRES = (8.0, 4.0)  # width and depth of the groove for the wires of a motor, beside it [mm]

_OUTSIDE = 0.02
_SHARED = 0.01

_DENT_RADIUS = 1.5


@dataclass(frozen=True, eq=False, kw_only=True)
class Pocket:
    """Room for a winch in the foam."""

    winch: str  # its name
    size: tuple[float, float, float]  # size of the room, in the coordinates of the mold [mm]
    upper: bool  # it is a core of the upper half; else of the lower
    unit: Manifold  # the winch itself, a box within the room
    reach: Manifold  # from the deep end of the pocket out of the body, with a groove for wires at the end of the motor
    core: Manifold  # solid that it removes from the body
    outside: float  # share of the room that is outside the body
    problem: str = ""  # why it cannot be built well, or nothing


def make_pockets(
    robot: Robot, body: Manifold, stance: MoldOrientation, rooms: Mapping[str, Sides | WinchRoom], *, clearance: float
) -> tuple[Pocket, ...]:
    """A pocket for each winch that sits in the body, from its place straight out along the pull.

    The shaft is at the winch's place, whichever way the winch is laid. Pockets that meet become one room. `rooms` are
    what winches take up, or three sides [mm] if the shaft is in the middle; those that are missing get no pocket. The
    clearance [mm] is between a winch and the foam, on each side. Raises InputError: a size for a winch that is not
    there, or that is not above 0.
    """
    boxes = {
        name: room if isinstance(room, WinchRoom) else WinchRoom.about_the_middle(room) for name, room in rooms.items()
    }
    for name, box in boxes.items():
        robot.winch(name)
        if not all(np.isfinite(side) and side > 0 for side in box.size):
            raise InputError(f'the pocket of winch "{name}" must be above 0 mm along all sides, not {box.size}')
    inside = [winch for winch in robot.winches if winch.mount is Mount.BODY and winch.name in boxes]
    ways = [
        _pockets_for(winch.name, body, stance.into(_spot(winch.at)[None])[0], boxes[winch.name], clearance)
        for winch in inside
    ]
    return _together(ways)


def _together(ways: list[list[Pocket]]) -> tuple[Pocket, ...]:
    """One way to lay each winch, so that they are least in each other's way: each in turn, until none changes."""
    chosen = [min(tried, key=lambda pocket: _worth(pocket, [])) for tried in ways]
    sweeps = 5
    for _ in range(sweeps):
        before = list(chosen)
        for place, tried in enumerate(ways):
            others = chosen[:place] + chosen[place + 1 :]
            rated = [(_worth(pocket, others), number) for number, pocket in enumerate(tried)]
            chosen[place] = tried[min(rated)[1]]
        if chosen == before:
            break
    return tuple(chosen)


def _worth(pocket: Pocket, others: list[Pocket]) -> tuple[float, bool, float, float, float]:
    """The lower the better: what is outside, too little skin, winches in one place, halves that cross, size."""
    shared = sum(_overlap_volume(pocket.unit, other.unit) for other in others)
    crossed = sum(_overlap_volume(pocket.reach, other.reach) for other in others if other.upper != pocket.upper)
    outside = round(max(pocket.outside, _OUTSIDE), 3)
    return (outside, bool(pocket.problem), round(shared, 3), round(crossed, 3), round(float(pocket.core.volume()), 3))


def _overlap_volume(one: Manifold, other: Manifold) -> float:
    """Overlap volume of two boxes along the axes [mm^3]."""
    (low, high), (low_other, high_other) = (np.reshape(box.bounding_box(), (2, 3)) for box in (one, other))
    return float(np.prod(np.maximum(np.minimum(high, high_other) - np.maximum(low, low_other), 0.0)))


def _spot(at: tuple[float, ...]) -> Float[np.ndarray, "3"]:
    """A place of a robot, flat or in space [mm]."""
    return MILLIMETERS * np.array([*at, 0.0][:3])


@dataclass(frozen=True, kw_only=True)
class LyingWinch:
    """One way to lay a winch, with its sides along those of the mold."""

    sides: Sides  # sides of the winch along x, y, z of the mold [mm]
    middle: Sides  # middle of its box [mm]
    wires: tuple[int, int]  # the side wall at which its wires come out: axis across the pull, and sign


def _pockets_for(
    name: str, body: Manifold, at: Float[np.ndarray, "3"], room: WinchRoom, clearance: float
) -> list[Pocket]:
    """All ways to lay a winch that leave the least of it outside the body, each open to either half."""
    lain = _lain(at, room)
    boxes = [_cuboid(way, clearance) for way in lain]
    outside = [round(max(_part_outside(box, body), _OUTSIDE), 3) for box in boxes]
    best = [way for way, out in zip(lain, outside, strict=True) if out == min(outside)]
    return [_pocket(name, body, way, upper, clearance) for way in best for upper in (True, False)]


def ways_to_turn(room: WinchRoom) -> list[LyingWinch]:
    """All ways to lay a winch whose place is at 0; those that differ in no length only once."""
    return _lain(np.zeros(3), room)


def _lain(at: Float[np.ndarray, "3"], room: WinchRoom) -> list[LyingWinch]:
    """All ways to lay a winch; those that differ in no length only once."""
    rounding = 1e-6
    off = np.where(np.abs(room.off) > rounding, room.off, 0.0)
    found = []
    orders = sorted(permutations(range(3)), key=lambda order: (room.size[order[2]], room.size[order[0]], order))
    for order, x, y in product(orders, (1, -1), (1, -1)):
        turn = round(np.linalg.det(np.eye(3)[list(order)])) * x * y if off[0] and off[1] else 1
        signs = np.array([x if off[0] else 1, y if off[1] else 1, turn])
        a, b, c = (at + (signs * off)[list(order)]).tolist()
        shaft = order.index(2)
        wires = (shaft, -int(signs[2])) if shaft < 2 else (0, -1)
        sides = (room.size[order[0]], room.size[order[1]], room.size[order[2]])
        found.append(LyingWinch(sides=sides, middle=(a, b, c), wires=wires))
    return list(dict.fromkeys(found))


_MOVE = (
    'Move the winch to a thicker part of the body, choose a smaller motor, or put the winch outside: mount = "world"'
)


def _pocket(name: str, body: Manifold, way: LyingWinch, upper: bool, clearance: float) -> Pocket:
    """A pocket for a winch laid one way, open to one half."""
    low, high = np.reshape(body.bounding_box(), (2, 3))
    at = np.array(way.middle)
    a, b, c = (side + 2 * clearance for side in way.sides)
    far = (high[2] if upper else low[2]) + (5.0 if upper else -5.0)
    deep = at[2] - c / 2 if upper else at[2] + c / 2
    straight = _upright_box(at, a, b, deep, far)
    reach = straight + _groove(at, (a, b), way.wires, deep, far)
    core = next((part for part in (reach ^ body).decompose() if _holds(part, at)), Manifold())
    skin = _skin(at, (a, b, c), upper) - straight
    out = _part_outside(_cuboid(way, clearance), body)
    side = sides_text(sorted((a, b, c), reverse=True))
    problem = ""
    bare = 0.1
    if core.is_empty() or out > _OUTSIDE:
        problem = (
            f'winch "{name}": the pocket of {side} mm does not fit into the body at its place ({100 * out:.0f} % '
            f"outside). {_MOVE}"
        )
    elif float((skin - body).volume()) > bare * float(skin.volume()):
        problem = (
            f'winch "{name}": less than {MIN_SKIN:g} mm of foam would be left next to the pocket of {side} mm. {_MOVE}'
        )
    return Pocket(
        winch=name,
        size=(a, b, c),
        upper=upper,
        unit=_cuboid(way, 0.0),
        reach=reach,
        core=core,
        outside=out,
        problem=problem,
    )


def _cuboid(way: LyingWinch, clearance: float) -> Manifold:
    """The box round a winch with some air on all sides."""
    return Manifold.cube([side + 2 * clearance for side in way.sides], True).translate(way.middle)


def _part_outside(box: Manifold, body: Manifold) -> float:
    """Share of a box that is outside the body."""
    return float((box - body).volume()) / float(box.volume())


def _groove(at: np.ndarray, across: tuple[float, float], wires: tuple[int, int], deep: float, far: float) -> Manifold:
    """A groove along the pull in the middle of a side wall: wires lie in it from the motor to the outside."""
    axis, sign = wires
    width, depth = _WIRES
    spot, sides = at.copy(), [0.0, 0.0]
    spot[axis] += sign * (across[axis] + depth) / 2
    sides[axis], sides[1 - axis] = depth, min(width, across[1 - axis])
    return _upright_box(spot, sides[0], sides[1], deep, far)


def _skin(at: np.ndarray, sides: tuple[float, float, float], upper: bool) -> Manifold:
    """The room with a skin round it, but for its open side."""
    sign = 1.0 if upper else -1.0
    deep, end = at[2] - sign * (sides[2] / 2 + MIN_SKIN), at[2] + sign * sides[2] / 2
    return _upright_box(at, sides[0] + 2 * MIN_SKIN, sides[1] + 2 * MIN_SKIN, deep, end)


def _upright_box(at: np.ndarray, width: float, height: float, deep: float, far: float) -> Manifold:
    low, high = min(deep, far), max(deep, far)
    return Manifold.cube((width, height, high - low)).translate((at[0] - width / 2, at[1] - height / 2, low))


def _holds(part: Manifold, at: np.ndarray) -> bool:
    """Return True if a point is in a solid, tested with a small box round it."""
    return float((Manifold.cube((0.1, 0.1, 0.1), True).translate(tuple(at.tolist())) ^ part).volume()) > 0


def clashes(pockets: tuple[Pocket, ...]) -> list[str]:
    """Sentences for winches that would need the same place; pockets round them may meet."""
    found = []
    for place, one in enumerate(pockets):
        for other in pockets[place + 1 :]:
            shared = float((one.unit ^ other.unit).volume())
            if shared > _SHARED * min(float(one.unit.volume()), float(other.unit.volume())):
                found.append(
                    f'winches "{one.winch}" and "{other.winch}" run into each other in the body by {shared / 1e3:.1f} '
                    "cm^3; move the winches apart, or choose smaller motors"
                )
    return found


def cable_dents(robot: Robot, surface: FineSurface, stance: MoldOrientation, *, deepest: float) -> Manifold:
    """Cones on the wall of the mold at the spot nearest to each cable point that is no deeper than `deepest` [mm]."""
    points = [_spot(point) for cable in robot.cables for point in cable.points]
    if not points:
        return Manifold()
    solid = Solid(Surface(surface.vertices, surface.triangles))
    asked = np.unique(np.array(points), axis=0)
    spots, triangles = solid.nearest(asked)
    near = np.linalg.norm(spots - asked, axis=1) <= deepest
    spots = stance.into(spots[near])
    inward = -(surface.normals[triangles[near]] @ stance.axes.T)
    kept: list[int] = []
    for place in range(len(spots)):
        if all(np.linalg.norm(spots[place] - spots[other]) > 2 * _DENT_RADIUS for other in kept):
            kept.append(place)
    return join_solids(_dent(spots[place], inward[place]) for place in kept)  # their roots meet where cables are near


def _dent(spot: Float[np.ndarray, "3"], inward: Float[np.ndarray, "3"]) -> Manifold:
    """A blunt cone that stands on the wall with its root in it."""
    dent = 1.0
    upright = rod(np.array([0.0, 0.0, -dent]), np.array([0.0, 0.0, dent]), 2 * _DENT_RADIUS - 0.4, 0.4)
    return upright.transform(np.column_stack([axes_along(inward).T, spot]))
