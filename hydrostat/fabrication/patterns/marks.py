"""Engravings of a panel, without its labels: seam, notches, cables, sheaths, winches, markers."""

from collections.abc import Iterable
from itertools import pairwise

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
HOLE_CLEARANCE = 0.8  # gap between lines and a hole [mm], so that none is engraved into it


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
    """Cables from hole to hole, solid outside and dashed inside; sheaths as tubes; a bar at each stopper."""
    marks: list[Shape] = []
    pinholes = tuple(pinholes)
    holes = shapely.union_all([shapely.Point(hole.center).buffer(hole.radius + HOLE_CLEARANCE) for hole in pinholes])
    sheath = 3.0  # width of the drawn sheath [mm]
    for cable, sewn in zip(robot.cables, stitches, strict=True):
        for bare, points in runs_of(cable):
            if not bare:
                run = LineString([place(cable.points[point]) for point in points])
                tube = run.buffer(sheath / 2, cap_style="flat", join_style="mitre").boundary
                marks.extend(trace(tube.intersection(seam).difference(holes), Layer.GUIDE, PatternPart.SHEATH))
        for index in np.flatnonzero(cable.bare):
            run = LineString([place(point) for point in cable.points[index : index + 2]])
            drawn = run.intersection(seam).difference(holes)
            if sewn.stitches[index].after is Side.INSIDE:
                drawn = dash_lines(drawn)
            marks.extend(trace(drawn, Layer.GUIDE, PatternPart.CABLE))
        marks.append(_stopper_mark(place(cable.points[-2]), place(cable.points[-1])))
    return tuple(marks)


def _stopper_mark(before: Place, end: Place) -> LaserLine:
    """A bar across a cable, beyond its last hole, as on the map: rings are drawn on faces, too."""
    half, beyond = 3.0, 2.5  # half the length of the bar, and its distance from the hole [mm]
    way = np.subtract(end, before)
    along = way / (np.hypot(*way) or 1.0)
    middle, aside = end + beyond * along, half * np.array([-along[1], along[0]])
    points = tuple((float(x), float(y)) for x, y in (middle - aside, middle + aside))
    return LaserLine(layer=Layer.GUIDE, part=PatternPart.STOPPER, points=points)


def winch_marks(robot: Robot, seam: Polygon) -> tuple[Shape, ...]:
    """A circle as large as the largest spool where each winch sits in the body."""
    return tuple(
        Circle(
            layer=Layer.GUIDE, part=PatternPart.WINCH, center=place(winch.at), radius=1e3 * robot.largest_spool(winch)
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
                LaserLine(layer=Layer.GUIDE, part=PatternPart.MARKER, points=((x - dx, y - dy), (x + dx, y + dy)))
            )
    return tuple(marks)


def decoration_marks(robot: Robot, seam: Polygon, pinholes: Iterable[Pinhole]) -> tuple[Shape, ...]:
    """Return the decorations of the body, such as eyes, with gaps at the holes."""
    holes = shapely.union_all([shapely.Point(hole.center).buffer(hole.radius + HOLE_CLEARANCE) for hole in pinholes])
    lines = [LineString([place(point) for point in line]) for line in robot.body.marks]
    drawn = [line.intersection(seam).difference(holes) for line in lines]
    return tuple(mark for line in drawn for mark in trace(line, Layer.MARK, PatternPart.DECORATION))


def crossed_drawings(robot: Robot, stitches: Iterable[CableStitches]) -> tuple[str, ...]:
    """Warn of cables whose holes, stoppers or outer runs lie in drawn shapes, such as eyes: places from the origin."""
    shapes = [shapely.LineString(1e3 * np.asarray(line)) for line in robot.body.marks]
    filled = [shapely.Polygon(line) if line.is_closed and len(line.coords) > 3 else line for line in shapes]
    faces = shapely.union_all([shape.buffer(_AROUND) for shape in filled])
    found = []
    for sewn in stitches:
        holes = [stitch for stitch in sewn.passes if faces.contains(shapely.Point(stitch.place))]
        outside = [
            LineString([one.place, two.place])
            for one, two in pairwise(sewn.stitches)
            if one.after is Side.OUTSIDE and faces.intersects(LineString([one.place, two.place]))
        ]
        told = [
            *([f"hole{'s' * (len(holes) > 1)} {', '.join(str(hole.number) for hole in holes)}"] if holes else []),
            *(["its stopper"] if holes and holes[-1] is sewn.stitches[-1] else []),
            *(["a run outside"] if outside else []),
        ]
        if told:
            x, y = holes[0].place if holes else outside[0].intersection(faces).representative_point().coords[0]
            found.append(f"C{sewn.cable} ({' and '.join(told)}, at x {x:.0f}, y {y:.0f} mm)")
    if not found:
        return ()
    words = "; ".join(found)
    return (
        f"cables cross drawn shapes, such as eyes: {words}. Move their points, or design with a [[keep_out]] zone "
        "there, in a file for --constraints",
    )


_AROUND = 2.0  # cloth round a drawn shape that should stay free, too [mm]


def dash_lines(geometry: BaseGeometry) -> BaseGeometry:
    """Split each line of a geometry into dashes, with one at both of its ends."""
    dashes = []
    for line in shapely.get_parts(geometry).tolist():
        count = max(1, round((line.length - _DASH) / (2 * _DASH)))
        step = line.length / (2 * count + 1)
        dashes += [substring(line, 2 * index * step, (2 * index + 1) * step) for index in range(count + 1)]
    return shapely.MultiLineString([dash for dash in dashes if dash.length])
