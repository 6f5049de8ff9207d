"""`UnitPlace`: one way in which the unit of a winch lies in a flat body."""

import math
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from hydrostat.fabrication.solids.construct import Corner, Cuboid, sides_text
from hydrostat.robot import Body

COMPRESSION_SHARE = 0.25  # Share of its thickness that stuffing and cloth give for a unit. Assumed, measured on none.
OVERLAP_TOLERANCE = 1.0
"""Area that units may share, or that may stand over the seam [mm^2]: corners of boxes drawn square."""

_SLIDE = 6.0
"""Offset of a unit from its place in the robot file [mm]: this place is still in its housing, and its tubes can bend
that much."""

_STEP = 30  # between the turns that are tried [degrees]: an hour of a clock, which is how a person is told


@dataclass(frozen=True, kw_only=True)
class UnitBox(Cuboid):
    """Box round a unit before it is laid: the shaft along z, the face of the motor at z = 0, the roof at the top."""

    winch: str  # its name
    at: Corner  # place in the robot file: its shaft, or the middle of its housing if it lies
    along: float  # the way in which its first cable goes on, counted from +x [degrees]

    @property
    def words(self) -> str:
        """Name of its winch and its sides, in words."""
        return f'the unit of winch "{self.winch}", {sides_text(self.size)} mm,'

    def ways_to_lie(self, seam: BaseGeometry) -> "list[UnitPlace]":
        """Across the body and in its plane, turned by whole hours and slid a little.

        Those first that are moved least.
        """
        turns = sorted(range(-180 + _STEP, 181, _STEP), key=lambda turn: (abs(turn), turn))
        slides = (
            (0.0, 0.0),
            *((sign * x, sign * y) for x, y in ((0.0, _SLIDE), (_SLIDE, 0.0)) for sign in (1.0, -1.0)),
        )
        ways = [
            (slid, across, flipped, self.along + turn)
            for slid in slides
            for across, flipped in ((True, False), (False, False), (False, True))
            for turn in turns
        ]
        footprints = shapely.polygons([_corners(self, *way) for way in ways])
        shapely.prepare(seam)
        beyond = ~shapely.covers(seam, footprints)
        outside = np.zeros(len(ways))
        left, bottom, right, top = shapely.total_bounds(footprints).tolist()
        near = shapely.clip_by_rect(seam, left - 1.0, bottom - 1.0, right + 1.0, top + 1.0)
        outside[beyond] = shapely.area(shapely.difference(footprints[beyond], near))
        return [
            UnitPlace(
                box=self, across=across, turn=turn, flipped=flipped, slid=slid, footprint=footprint, outside=float(area)
            )
            for (slid, across, flipped, turn), footprint, area in zip(ways, footprints, outside, strict=True)
        ]


@dataclass(frozen=True, eq=False, kw_only=True)
class UnitPlace:
    """One way in which a unit lies."""

    box: UnitBox  # the unit
    across: bool  # its shaft stands across the body, the roof to the front; else it lies in the plane of the body
    turn: float  # angle of its +y, counted from +x [degrees]
    flipped: bool  # a unit that lies has its motor to the right of +y; else to the left
    slid: Corner  # from its place, to the right of its +y, and along it [mm]
    footprint: Polygon  # area of the plane that it covers [mm]
    outside: float  # area of the footprint beyond the seam [mm^2]

    @property
    def depth(self) -> float:
        """Height of the unit across the body's thickness [mm]."""
        return self.box.size[2 if self.across else 0]

    def azimuth(self, way: float) -> int:
        """The side of the housing that is nearest to a way [degrees]: along +y 90; if it lies 90 or 270."""
        quarter = 90 if self.across else 180
        return (90 + quarter * round(_wrap_angle(way - self.turn) / quarter)) % 360

    @property
    def instruction(self) -> str:
        """Instruction to lay it, for a person, after the name of its winch."""
        right, ahead = self.slid
        slid = ""
        if right or ahead:
            way = self.turn - math.degrees(math.atan2(right, ahead))
            slid = f", shifted {math.hypot(right, ahead):g} mm toward {_clock(way)}"
        if self.across:
            channel = self.turn - 90 + self.azimuth(self.box.along)
            return f"across the body, channel of its first cable toward {_clock(channel)}{slid}"
        motor = self.turn + (-90 if self.flipped else 90)
        return f"flat, motor toward {_clock(motor)}{slid}"


def seam_of(body: Body) -> BaseGeometry:
    """The line that a flat body is sewn along, with what is in it [mm]: as drawn, or round its mesh."""
    if body.outline is not None:
        return shapely.transform(body.outline.polygon, lambda points: 1e3 * points)
    return shapely.union_all(shapely.polygons(1e3 * body.mesh.nodes[body.mesh.elements]))


def _corners(box: UnitBox, slid: Corner, across: bool, flipped: bool, turn: float) -> list[Corner]:
    """Corners of a unit with its +y at a turn [degrees]: x is to the right of it, or z to the right or to the left."""
    angle = math.radians(turn)
    up = (math.cos(angle), math.sin(angle))
    right = (up[1], -up[0])
    if across:
        low, high = box.low[0], box.high[0]
    else:
        middle = box.high[2] / 2
        low, high = box.low[2] - middle, box.high[2] - middle
        if flipped:
            low, high = -high, -low
    corners = ((low, box.low[1]), (high, box.low[1]), (high, box.high[1]), (low, box.high[1]))
    x = box.at[0] + slid[0] * right[0] + slid[1] * up[0]
    y = box.at[1] + slid[0] * right[1] + slid[1] * up[1]
    return [(x + u * right[0] + v * up[0], y + u * right[1] + v * up[1]) for u, v in corners]


def _wrap_angle(angle: float) -> float:
    """The same between -180 and 180 degrees, a little towards 180, so that rounding noise changes nothing."""
    return (angle + 180 - 1e-6) % 360 - 180 + 1e-6


def _clock(angle: float) -> str:
    """A way [degrees] as on the face of a clock, which people are surer of than of signs."""
    return f"{round((90 - angle) / 30 - 1e-6) % 12 or 12} o'clock"
