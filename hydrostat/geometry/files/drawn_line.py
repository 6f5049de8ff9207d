"""`DrawnLine`: a line of a drawing with its paint; `PageFacts`: what the drawing says of its page."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from functools import cached_property, reduce

import numpy as np
from shapely import MultiPoint, Point, Polygon, get_parts, unary_union
from shapely.geometry.base import BaseGeometry

from hydrostat.geometry.outline import Ring


class Fill(Enum):
    """Paint within a line."""

    UNKNOWN = "unknown"  # the kind of drawing has no paint, or the reader does not tell
    NONE = "none"  # only the line itself is drawn
    PALE = "pale"  # white or nearly
    FULL = "full"


PAINTED = (Fill.PALE, Fill.FULL)
"""Paint that covers what is behind it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnLine:
    """Line of a drawing, in its units.

    Attributes:
        points: points along it, (points, 2).
        closed: it ends where it begins.
        fill: paint within it.
        width: width that it is drawn with.
        color: color of the paint, red, green and blue from 0 to 255; None without paint or for gradients.
        element: number of the element whose paint it bounds with others, evenly in and out.
        label: names of its layer, class or element, in one text.
    """

    points: Ring
    closed: bool
    fill: Fill = Fill.UNKNOWN
    width: float = 0.0
    color: tuple[int, int, int] | None = None
    element: int = 0
    label: str = ""

    @cached_property
    def extent(self) -> float:
        """Longest side of the bounding box."""
        return float(np.ptp(self.points, axis=0).max())

    @cached_property
    def hull_area(self) -> float:
        """Area of the convex hull: 0 for what is straight."""
        return float(MultiPoint(self.points).convex_hull.area)

    @cached_property
    def polygon(self) -> BaseGeometry:
        """Area within it, repaired where it crosses itself."""
        return Polygon(self.points).buffer(0) if len(self.points) >= 3 else Polygon()


@dataclass(frozen=True, eq=False, kw_only=True)
class PageFacts:
    """Drawing's own word on what surrounds the body, in its units.

    Attributes:
        box: left, low, right and high side of the page; None if the drawing does not say.
        unit: length of a unit [mm]; None if the drawing has none.
        texts: places of texts, such as those of a title block.
    """

    box: tuple[float, float, float, float] | None = None
    unit: float | None = None
    texts: tuple[tuple[float, float], ...] = ()

    @cached_property
    def points(self) -> tuple[Point, ...]:
        """Places of texts as points."""
        return tuple(map(Point, self.texts))


def painted_area(lines: Iterable[DrawnLine]) -> BaseGeometry:
    """Area that the lines of one element bound: what is within an odd number of them."""
    area = reduce(lambda one, two: one.symmetric_difference(two), (line.polygon for line in lines), Polygon())
    return unary_union([part for part in get_parts(area) if isinstance(part, Polygon)])
