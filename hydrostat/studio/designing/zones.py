"""Zones: how they are painted, moved and shaped, as plain values."""

import math

from hydrostat.design import Zone
from hydrostat.errors import InputError
from hydrostat.robot import Point
from hydrostat.studio.records.wishes import Paint

COLOURS = {Paint.KEEP_OUT: "#c8243f", Paint.WINCH_ZONES: "#00795f", Paint.STILL: "#5a3da6"}
"""Of each paint."""

LABELS = {Paint.KEEP_OUT: "no cable", Paint.WINCH_ZONES: "winches", Paint.STILL: "still"}
"""Written in a zone."""

LEAST = 0.015
"""The smallest radius of a painted zone, as a share of the body."""

COARSE = 0.006
"""A line drawn by hand is made this much simpler, as a share of the body."""


def disc(middle: Point, rim: Point, size: float) -> Zone:
    """A disc or ball from its middle to a point on its rim, not too small for a body of some size [m]."""
    return Zone(at=middle, radius=max(math.dist(middle, rim), LEAST * size))


def lasso(points: tuple[Point, ...], size: float) -> Zone:
    """The polygon that a line drawn by hand goes round; the largest part of it where the line crosses itself.

    Raises:
        InputError: it goes round nothing.
    """
    from shapely import Polygon, make_valid
    from shapely.geometry.base import BaseMultipartGeometry

    whole = make_valid(Polygon(points)) if len(points) >= 3 else Polygon()
    parts = whole.geoms if isinstance(whole, BaseMultipartGeometry) else [whole]
    polygons = [part for part in parts if isinstance(part, Polygon) and not part.is_empty]
    if not polygons or max(part.area for part in polygons) < (LEAST * size) ** 2:
        raise InputError("the line goes round nothing; draw it round the part that is meant")
    largest = max(polygons, key=lambda part: part.area).exterior.simplify(COARSE * size)
    return Zone(outline=tuple((float(x), float(y)) for x, y in list(largest.coords)[:-1]))


def moved(zone: Zone, start: Point, end: Point) -> Zone:
    """A zone carried from one point to another."""

    def there(point: Point) -> Point:
        return tuple(value + last - first for value, first, last in zip(point, start, end, strict=True))

    if zone.at is not None:
        return Zone(at=there(zone.at), radius=zone.radius)
    if zone.box is not None:
        return Zone(box=(there(zone.box[0]), there(zone.box[1])))
    return Zone(outline=tuple(map(there, zone.outline)))


def with_corner(zone: Zone, index: int, place: Point) -> Zone:
    """A polygon with one corner elsewhere."""
    return Zone(outline=(*zone.outline[:index], place, *zone.outline[index + 1 :]))


def rim_handle(zone: Zone) -> Point:
    """Where a disc or ball is taken hold of to be resized."""
    assert zone.at is not None
    assert zone.radius is not None
    return (zone.at[0] + zone.radius, *zone.at[1:])
