"""`resample`, `length`, `turns`, `least_along`, `nearest_shares`: routes as polylines, what lies along segments."""

from collections.abc import Callable

import numpy as np

from hydrostat.arrays import Float, Points, Vector

Route = Float[np.ndarray, "_ dim"]  # points that a cable runs through [m]


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


Measure = Callable[[Points], Float[np.ndarray, " points"]]
"""Distances of points from something [m]: they change by no more than one goes."""

MIN_SPACING = 4e-5  # places are at least so far apart [m]: coordinates are rounded to a quarter of it


def least_along(
    measure: Measure,
    starts: Float[np.ndarray, "segments dim"],
    ends: Float[np.ndarray, "segments dim"],
    limit: float,
    *,
    resolution: float = np.inf,
) -> Float[np.ndarray, " segments"]:
    """The least of a distance along each segment [m], as far as it matters whether it is below a limit [m].

    A stretch of a segment is halved only while its ends leave open whether the least is lower in between, as a distance
    cannot fall faster than one goes. What is told is found at a place of the segment; if it is not below the limit,
    then nothing on the segment is, by more than half of `MIN_SPACING`. Where it is below, it is as near to the least as
    the resolution [m] says; by default any place below the limit will do.
    """
    lengths = np.linalg.norm(ends - starts, axis=1)
    first, last = measure(starts), measure(ends)
    least = np.minimum(first, last)
    owner, low, high = np.arange(len(starts)), np.zeros(len(starts)), np.ones(len(starts))
    while True:
        span = (high - low) * lengths[owner]
        bound = 0.5 * (first + last - span)
        known = np.where(least < limit, least - resolution, limit)
        unknown = (span > MIN_SPACING) & (bound < known[owner])
        if not unknown.any():
            return least
        owner, low, high, first, last = owner[unknown], low[unknown], high[unknown], first[unknown], last[unknown]
        middle = 0.5 * (low + high)
        found = measure(starts[owner] + middle[:, None] * (ends - starts)[owner])
        np.minimum.at(least, owner, found)
        owner, low, high = np.tile(owner, 2), np.concatenate([low, middle]), np.concatenate([middle, high])
        first, last = np.concatenate([first, found]), np.concatenate([found, last])


def nearest_shares(
    first: Float[np.ndarray, "pairs 2 dim"], second: Float[np.ndarray, "pairs 2 dim"]
) -> tuple[Float[np.ndarray, " pairs"], Float[np.ndarray, " pairs"]]:
    """Nearest points of two segments, as shares of the way along each (Ericson 2005, 5.1.9).

    In the plane segments that cross meet: their shares are of the same place.
    """
    ways, others = first[:, 1] - first[:, 0], second[:, 1] - second[:, 0]
    between = first[:, 0] - second[:, 0]
    square, square_other = (ways**2).sum(axis=1), (others**2).sum(axis=1)
    along, along_other = (ways * between).sum(axis=1), (others * between).sum(axis=1)
    both = (ways * others).sum(axis=1)
    tiny = np.finfo(float).tiny ** 0.5
    slanted = square * square_other - both**2
    share = np.where(slanted > 1e-12 * square * square_other, both * along_other - along * square_other, 0.0)
    share = np.clip(share / np.maximum(slanted, tiny), 0.0, 1.0)
    other = np.clip((both * share + along_other) / np.maximum(square_other, tiny), 0.0, 1.0)
    return np.clip((both * other - along) / np.maximum(square, tiny), 0.0, 1.0), other
