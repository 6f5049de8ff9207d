"""`LaserLine` and `Circle`: what a laser follows, each on a `Layer`; `Panel`: a piece of cloth with its shapes."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Self

import shapely
from shapely.geometry.base import BaseGeometry

from hydrostat.given import Point

Place = tuple[float, float]  # a place on a panel or sheet [mm]: x to the right, y up


class Layer(StrEnum):
    """An operation of the laser, in the order in which a sheet is worked."""

    MARK = "mark"
    GUIDE = "guide"  # lines and letters for sewing that would show on the toy
    PINHOLE = "pinhole"
    CUT = "cut"


class PatternPart(StrEnum):
    """Part of a panel that a shape stands for."""

    EDGE = "edge"
    SLIT = "slit"
    SEAM = "seam"
    NOTCH = "notch"
    PINHOLE = "pinhole"
    CABLE = "cable"
    SHEATH = "sheath"
    STOPPER = "stopper"
    WINCH = "winch"
    OPENING = "opening"
    ZIPPER = "zipper"
    MARKER = "marker"
    DECORATION = "decoration"
    GRAIN = "grain"
    RULER = "ruler"
    TEXT = "text"
    LEADER = "leader"


@dataclass(frozen=True, kw_only=True)
class LaserLine:
    """A polyline."""

    layer: Layer  # operation of the laser along it
    part: PatternPart  # part of the panel that it stands for
    points: tuple[Place, ...]  # [mm]; the first is not repeated at the end of a closed line
    closed: bool = False  # True if it ends where it begins

    def move(self, dx: float, dy: float) -> Self:
        """Return the line shifted by an offset [mm]."""
        return replace(self, points=tuple((x + dx, y + dy) for x, y in self.points))

    def mirror(self) -> Self:
        """Return the line mirrored about x = 0."""
        return replace(self, points=tuple((-x, y) for x, y in self.points))

    @property
    def geometry(self) -> BaseGeometry:
        """The same line for shapely."""
        return shapely.LinearRing(self.points) if self.closed else shapely.LineString(self.points)


@dataclass(frozen=True, kw_only=True)
class Circle:
    """A circle."""

    layer: Layer  # operation of the laser along it
    part: PatternPart  # part of the panel that it stands for
    center: Place  # [mm]
    radius: float  # [mm]

    def move(self, dx: float, dy: float) -> Self:
        """Return the circle shifted by an offset [mm]."""
        return replace(self, center=(self.center[0] + dx, self.center[1] + dy))

    def mirror(self) -> Self:
        """Return the circle mirrored about x = 0."""
        return replace(self, center=(-self.center[0], self.center[1]))

    @property
    def geometry(self) -> BaseGeometry:
        """The circle, without its inside, for shapely."""
        return shapely.Point(self.center).buffer(self.radius).exterior


Shape = LaserLine | Circle  # anything on a sheet


def trace(geometry: BaseGeometry, layer: Layer, part: PatternPart) -> tuple[LaserLine, ...]:
    """The lines of a geometry [mm]: rings of polygons closed, lines open, points left out."""
    return tuple(_lines(geometry, layer, part))


def _lines(geometry: BaseGeometry, layer: Layer, part: PatternPart) -> Iterable[LaserLine]:
    if isinstance(geometry, shapely.Polygon):
        for ring in (geometry.exterior, *geometry.interiors):
            yield from _lines(ring, layer, part)
    elif isinstance(geometry, shapely.LineString) and not geometry.is_empty:
        closed = geometry.is_ring
        points = tuple((x, y) for x, y in geometry.coords)
        yield LaserLine(layer=layer, part=part, points=points[:-1] if closed else points, closed=closed)
    else:
        for piece in getattr(geometry, "geoms", ()):
            yield from _lines(piece, layer, part)


@dataclass(frozen=True, kw_only=True)
class Panel:
    """One piece of cloth, its right side up."""

    name: str  # "front", "back", or "gusset-1" and so on for the pieces of the strip between them
    # place of the robot's [0, 0] on the sheet [mm]; for a piece of the gusset, start of its seam with the back
    origin: Place
    mirrored: bool  # True if the robot's x runs to the left, as seen from behind
    shapes: tuple[Shape, ...]  # in places of the sheet [mm]

    def on_sheet(self, point: Point) -> Place:
        """Place of a point of the robot [m] on the sheet [mm]; for the front and the back."""
        x, y = 1e3 * point[0], 1e3 * point[1]
        return self.origin[0] + (-x if self.mirrored else x), self.origin[1] + y

    def move(self, dx: float, dy: float) -> Self:
        """Return the panel shifted on the sheet [mm]."""
        origin = (self.origin[0] + dx, self.origin[1] + dy)
        return replace(self, origin=origin, shapes=tuple(shape.move(dx, dy) for shape in self.shapes))
