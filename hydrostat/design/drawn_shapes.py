"""`drawn_shapes`, `drawn_zones`: decorations of a flat body, such as eyes, that pins and cables leave free."""

import math
from collections.abc import Iterator

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from hydrostat.design.zone import Zone
from hydrostat.robot import Body, Pin, Robot

_MAX_SHARE = 0.3  # share of the body above which a drawn shape is no eye or mouth: cables must cross it
_ROUND = 0.9  # a shape that fills such a share of the circle around it becomes a disc
_SIMPLER = 2e-4  # largest error of a simplified outline [m]


def drawn_shapes(body: Body) -> list[BaseGeometry]:
    """Convex hulls of the small shapes that are drawn on a body [m]; none for large ones, such as a belly."""
    hulls = [shapely.LineString(line).convex_hull for line in body.marks]
    return [hull for hull in hulls if _width(hull) < _MAX_SHARE * body.mesh.size]


def drawn_zones(body: Body, gap: float) -> tuple[Zone, ...]:
    """Zones around the small shapes that are drawn on a body, as far as a gap [m] from them; none for a gap of 0."""
    if gap == 0.0:
        return ()
    together = shapely.union_all([hull.buffer(gap) for hull in drawn_shapes(body)])
    return tuple(_zone(shapely.convex_hull(part)) for part in shapely.get_parts(together))


def _width(hull: BaseGeometry) -> float:
    left, bottom, right, top = hull.bounds
    return max(right - left, top - bottom)


def _zone(hull: BaseGeometry) -> Zone:
    radius = float(shapely.minimum_bounding_radius(hull))
    if hull.area >= _ROUND * math.pi * radius**2:
        center = shapely.minimum_bounding_circle(hull).centroid
        return Zone(at=(center.x, center.y), radius=radius)
    corners = shapely.get_coordinates(shapely.simplify(hull, _SIMPLER))[:-1]
    return Zone(outline=tuple(map(tuple, corners.tolist())))


def _pin_field(pin: Pin) -> "shapely.Polygon":
    if pin.box is None:
        assert pin.at is not None
        return shapely.Point(pin.at).buffer(pin.radius)
    (left, low), (right, high) = np.asarray(pin.box)
    return shapely.box(float(left), float(low), float(right), float(high))


def find_pinned_drawings(robot: Robot) -> Iterator[str]:
    """Sentence for each pin that covers most of a small shape drawn on a flat body, such as an eye."""
    for index, pin in enumerate(robot.pins if robot.body.mesh.dim == 2 else ()):
        field = _pin_field(pin)
        for hull in (shape.buffer(_SIMPLER) for shape in drawn_shapes(robot.body)):
            if field.intersection(hull).area > 0.5 * hull.area:
                x, y = (f"{1e3 * value:z.0f}" for value in hull.centroid.coords[0])
                yield f"pin[{index}]: covers the shape drawn at [{x}, {y}] mm. Move the pin, or make it smaller"
                break
