"""What is engraved on a panel, before its labels: seam, notches, cables, sheaths, winches, opening, markers."""

from collections.abc import Iterable, Iterator
from itertools import groupby

import numpy as np
import shapely
from shapely import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from hydrostat.fabrication.patterns.pinholes import Pinhole
from hydrostat.fabrication.patterns.shape import Circle, Layer, Line, Part, Place, Shape, trace
from hydrostat.fabrication.patterns.skin import Skin
from hydrostat.robot import Cable, Robot

_NOTCH_SPACING = 80.0
"""About how far apart notches are along the seam [mm]."""

_NOTCH_PAIR = 5.0
"""How far apart the two notches of the double notch are [mm]: it tells where top is."""

_SHEATH = 3.0
"""Width of the drawn sheath [mm]."""

_STOPPER = 3.0
"""Radius of the ring round the hole at a stopper [mm]."""

_CLEAR = 0.8
"""How far lines end before a hole [mm], so that none is engraved into it."""


def place(point: Iterable[float]) -> Place:
    """A point of the robot [m] on a panel seen from the front [mm]."""
    x, y = point
    return 1e3 * x, 1e3 * y


def seam_marks(skin: Skin) -> tuple[Shape, ...]:
    """The seam line, and notches across the allowance that meet when the panels lie on each other."""
    marks: list[Shape] = [*trace(skin.seam, Layer.MARK, Part.SEAM)]
    allowance = skin.seam.boundary.distance(skin.cut.boundary)
    for seam, cut in _allowances(skin):
        top = seam.project(shapely.Point(max(seam.coords, key=lambda corner: corner[1])))
        count = max(4, round(seam.length / _NOTCH_SPACING))
        along = [top + _NOTCH_PAIR, *(top + seam.length * index / count for index in range(count))]
        for distance in along:
            notch = shapely.shortest_line(seam.interpolate(distance % seam.length), cut)
            if notch.length < 1.5 * allowance and not notch.intersects(skin.slits):
                marks.extend(trace(notch, Layer.MARK, Part.NOTCH))
    return tuple(marks)


def cable_marks(robot: Robot, seam: Polygon, pinholes: Iterable[Pinhole]) -> tuple[Shape, ...]:
    """Cables as lines from hole to hole, sheathed stretches as tubes, a ring round the hole at each stopper."""
    marks: list[Shape] = []
    pinholes = tuple(pinholes)
    holes = shapely.union_all([shapely.Point(hole.centre).buffer(hole.radius + _CLEAR) for hole in pinholes])
    for cable in robot.cables:
        for sheathed, run in _runs(cable):
            tube = run.buffer(_SHEATH / 2, cap_style="flat", join_style="mitre").boundary
            drawn, part = (tube, Part.SHEATH) if sheathed else (run, Part.CABLE)
            marks.extend(trace(drawn.intersection(seam).difference(holes), Layer.MARK, part))
        marks.append(Circle(layer=Layer.MARK, part=Part.STOPPER, centre=place(cable.points[-1]), radius=_STOPPER))
    return tuple(marks)


def winch_marks(robot: Robot, seam: Polygon) -> tuple[Shape, ...]:
    """A circle as large as the largest spool where each winch sits in the body."""
    return tuple(
        Circle(layer=Layer.MARK, part=Part.WINCH, centre=place(winch.at), radius=1e3 * robot.largest_spool(winch))
        for winch in robot.winches
        if seam.contains(shapely.Point(place(winch.at)))
    )


def marker_marks(robot: Robot) -> tuple[Shape, ...]:
    """A small cross at each marker."""
    marks = []
    for marker in robot.markers:
        x, y = place(marker.at)
        for dx, dy in ((2.0, 0.0), (0.0, 2.0)):
            marks.append(Line(layer=Layer.MARK, part=Part.MARKER, points=((x - dx, y - dy), (x + dx, y + dy))))
    return tuple(marks)


def opening_mark(robot: Robot, seam: Polygon, reach: float) -> Line | None:
    """Where the zipper goes that gives access to the winches (R10).

    It runs along the row of winches and `reach` [mm] beyond; turned, and shortened if need be, so as to stay inside.

    Returns:
        None without a winch in the body, without reach, or without room.
    """
    winches = np.array([place(winch.at) for winch in robot.winches if seam.contains(shapely.Point(place(winch.at)))])
    inside = seam.buffer(-reach / 3)
    if not len(winches) or not reach or inside.is_empty:
        return None
    middle = shapely.Point(winches.mean(axis=0))
    middle = shapely.shortest_line(inside, middle).interpolate(0.0)
    row = np.linalg.svd(winches - winches.mean(axis=0))[2][0] if len(winches) > 1 else np.array([1.0, 0.0])
    half = np.abs((winches - winches.mean(axis=0)) @ row).max() + reach
    turns = (0, 90, 15, -15, 30, -30, 45, -45, 60, -60, 75, -75)
    chords = [_chord(inside, middle, row @ _turn(np.radians(angle)), half) for angle in turns]
    longest = max(chords, key=lambda chord: round(chord.length))
    chosen = next((chord for chord in chords if chord.length > 0.75 * longest.length), longest)
    return trace(chosen, Layer.MARK, Part.OPENING)[0] if longest.length > reach else None


def _allowances(skin: Skin) -> Iterator[tuple[shapely.LinearRing, shapely.LinearRing]]:
    """Each ring of the seam with its parallel in the cut."""
    if skin.seam.boundary.distance(skin.cut.boundary) < 1.0:
        return
    yield skin.seam.exterior, skin.cut.exterior
    for cut in skin.cut.interiors:
        inner = shapely.Point(cut.coords[0])
        yield min(skin.seam.interiors, key=lambda ring: Polygon(ring).distance(inner)), cut


def _runs(cable: Cable) -> Iterator[tuple[bool, LineString]]:
    """Stretches of a cable [mm], each with whether it is sheathed."""
    points = [place(point) for point in cable.points]
    for bare, group in groupby(range(len(points) - 1), key=lambda segment: bool(cable.bare[segment])):
        segments = list(group)
        yield not bare, LineString(points[segments[0] : segments[-1] + 2])


def _chord(inside: BaseGeometry, middle: shapely.Point, direction: np.ndarray, half: float) -> LineString:
    """The stretch of a line through a point that stays inside."""
    centre = np.array([middle.x, middle.y])
    line = LineString([centre - half * direction, centre + half * direction]).intersection(inside)
    pieces = [piece for piece in getattr(line, "geoms", (line,)) if isinstance(piece, LineString)]
    return min(pieces, key=middle.distance, default=LineString())


def _turn(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
