"""`move_off_drawings`: a place for a pin near its own that covers no small drawn shape, such as a face."""

from dataclasses import replace

import numpy as np
import shapely

from hydrostat.robot.body import Body
from hydrostat.robot.pin import Pin

_COVERABLE_SIZE = 0.3
"""Size of a drawn shape, as a share of the body's, from which on a pin may cover it, such as a belly."""


def move_off_drawings(pin: Pin, body: Body, outline: shapely.Polygon) -> Pin:
    """Return a pin at the nearest place in the body where it covers no small drawn shape; itself if there is none."""
    hulls = [shapely.LineString(line).convex_hull for line in body.marks]
    sizes = [max(hull.bounds[2] - hull.bounds[0], hull.bounds[3] - hull.bounds[1]) for hull in hulls]
    limit = _COVERABLE_SIZE * body.mesh.size
    small = shapely.union_all([hull for hull, size in zip(hulls, sizes, strict=True) if size < limit])
    if pin.at is None or small.is_empty or shapely.Point(pin.at).distance(small) >= pin.radius:
        return pin
    reach = pin.radius * np.arange(0.25, 8.1, 0.25)
    turns = np.linspace(0.0, 2 * np.pi, 48, endpoint=False)
    away = (reach[:, None, None] * np.stack([np.cos(turns), np.sin(turns)], axis=-1)).reshape(-1, 2)
    places = np.round(np.array(pin.at) + away, 3)  # whole millimeters
    points = shapely.points(places)
    shapely.prepare(outline)
    room = np.where(shapely.contains(outline, points), shapely.distance(outline.boundary, points), 0.0)
    fits = (room >= pin.radius) & (shapely.distance(small, points) >= pin.radius)
    if not fits.any():
        return pin
    x, y = places[np.argmax(fits)].tolist()
    return replace(pin, at=(x, y))
