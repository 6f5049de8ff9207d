"""Engravings of a panel, without its labels: seam, notches, cables, sheaths, winches, markers."""

from collections.abc import Iterable

import numpy as np
import shapely
from shapely import LineString, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import substring

from hydrostat.fabrication.patterns.pinholes import Pinhole
from hydrostat.fabrication.patterns.shape import Circle, LaserLine, Layer, PatternPart, Place, Shape, trace
from hydrostat.fabrication.patterns.skin import Notch, Skin
from hydrostat.fabrication.patterns.stitches import CableStitches, Side, runs_of
from hydrostat.robot import Robot

_DASH = 2.0  # length of a dash, and about that of the gap after it [mm]
_CLEAR = 0.8  # gap between lines and a hole [mm], so that none is engraved into it


def place(point: Iterable[float]) -> Place:
    """A point of the robot [m] on a panel seen from the front [mm]."""
    x, y = point
    return 1e3 * x, 1e3 * y


def seam_marks(skin: Skin, notches: Iterable[Notch]) -> tuple[Shape, ...]:
    """The seam line, and the notches across its allowance."""
    strokes = [line for notch in notches for line in trace(notch.stroke, Layer.MARK, PatternPart.NOTCH)]
    return (*trace(skin.seam, Layer.MARK, PatternPart.SEAM), *strokes)


def cable_marks(
    robot: Robot, stitches: Iterable[CableStitches], seam: Polygon, pinholes: Iterable[Pinhole]
) -> tuple[Shape, ...]:
    """Cables from hole to hole, solid outside and dashed inside; sheaths as tubes; a ring at each stopper."""
    marks: list[Shape] = []
    pinholes = tuple(pinholes)
    holes = shapely.union_all([shapely.Point(hole.center).buffer(hole.radius + _CLEAR) for hole in pinholes])
    sheath = 3.0  # width of the drawn sheath [mm]
    stopper = 3.0  # radius of the ring round the hole at a stopper [mm]
    for cable, sewn in zip(robot.cables, stitches, strict=True):
        for bare, points in runs_of(cable):
            if not bare:
                run = LineString([place(cable.points[point]) for point in points])
                tube = run.buffer(sheath / 2, cap_style="flat", join_style="mitre").boundary
                marks.extend(trace(tube.intersection(seam).difference(holes), Layer.MARK, PatternPart.SHEATH))
        for index in np.flatnonzero(cable.bare):
            run = LineString([place(point) for point in cable.points[index : index + 2]])
            drawn = run.intersection(seam).difference(holes)
            if sewn.stitches[index].after is Side.INSIDE:
                drawn = dash_lines(drawn)
            marks.extend(trace(drawn, Layer.MARK, PatternPart.CABLE))
        marks.append(Circle(layer=Layer.MARK, part=PatternPart.STOPPER, center=place(cable.points[-1]), radius=stopper))
    return tuple(marks)


def winch_marks(robot: Robot, seam: Polygon) -> tuple[Shape, ...]:
    """A circle as large as the largest spool where each winch sits in the body."""
    return tuple(
        Circle(
            layer=Layer.MARK, part=PatternPart.WINCH, center=place(winch.at), radius=1e3 * robot.largest_spool(winch)
        )
        for winch in robot.winches
        if seam.contains(shapely.Point(place(winch.at)))
    )


def marker_marks(robot: Robot) -> tuple[Shape, ...]:
    """A small cross at each marker."""
    marks = []
    for marker in robot.markers:
        x, y = place(marker.at)
        for dx, dy in ((2.0, 0.0), (0.0, 2.0)):
            marks.append(
                LaserLine(layer=Layer.MARK, part=PatternPart.MARKER, points=((x - dx, y - dy), (x + dx, y + dy)))
            )
    return tuple(marks)


def decoration_marks(robot: Robot, seam: Polygon, pinholes: Iterable[Pinhole]) -> tuple[Shape, ...]:
    """Return the decorations of the body, such as eyes, with gaps at the holes."""
    holes = shapely.union_all([shapely.Point(hole.center).buffer(hole.radius + _CLEAR) for hole in pinholes])
    lines = [LineString([place(point) for point in line]) for line in robot.body.marks]
    drawn = [line.intersection(seam).difference(holes) for line in lines]
    return tuple(mark for line in drawn for mark in trace(line, Layer.MARK, PatternPart.DECORATION))


def dash_lines(geometry: BaseGeometry) -> BaseGeometry:
    """Split each line of a geometry into dashes, with one at both of its ends."""
    dashes = []
    for line in shapely.get_parts(geometry).tolist():
        count = max(1, round((line.length - _DASH) / (2 * _DASH)))
        step = line.length / (2 * count + 1)
        dashes += [substring(line, 2 * index * step, (2 * index + 1) * step) for index in range(count + 1)]
    return shapely.MultiLineString([dash for dash in dashes if dash.length])
