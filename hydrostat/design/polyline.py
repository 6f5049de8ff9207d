"""`resample`, `length`, `turns`: routes as polylines."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.design.region import Route


def resample(route: Route, spacing: float) -> Route:
    """Points at equal distances along a polyline, both ends kept."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(route, axis=0), axis=1))])
    count = max(round(along[-1] / spacing), 1)
    places = np.linspace(0.0, along[-1], count + 1)
    return np.column_stack([np.interp(places, along, route[:, axis]) for axis in range(route.shape[1])])


def length(route: Route) -> float:
    """Length of a polyline [m]."""
    return float(np.linalg.norm(np.diff(route, axis=0), axis=1).sum())


def turns(route: Route) -> Vector:
    """Angle between each segment of a polyline and the next [rad]."""
    spans = np.diff(route, axis=0)
    units = spans / np.maximum(np.linalg.norm(spans, axis=1), 1e-300)[:, None]
    return np.arccos(np.clip((units[:-1] * units[1:]).sum(axis=1), -1.0, 1.0))


def sharpest_turn(route: Route) -> float:
    """Largest of its turns [degrees]."""
    return float(np.degrees(turns(route).max(initial=0.0)))
