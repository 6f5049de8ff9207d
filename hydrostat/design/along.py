"""`least_along`: the least distance along straight segments, from as few places as can tell."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Points

Measure = Callable[[Points], Float[np.ndarray, " points"]]
"""Distances of points from something [m]: they change by no more than one goes."""

FINEST = 4e-5
"""Places are at least so far apart [m]: coordinates are rounded to a quarter of it."""


def least_along(
    measure: Measure,
    starts: Float[np.ndarray, "segments dim"],
    ends: Float[np.ndarray, "segments dim"],
    limit: float,
    *,
    resolution: float = np.inf,
) -> Float[np.ndarray, " segments"]:
    """The least of a distance along each segment [m], as far as it matters whether it is below a limit.

    A stretch of a segment is halved only while its ends leave open whether the least is lower in between, as a
    distance cannot fall faster than one goes. What is told is found at a place of the segment; if it is not below the
    limit, then nothing on the segment is, by more than half of `FINEST`.

    Args:
        measure: the distance.
        starts: of the segments [m].
        ends: of the segments [m].
        limit: that is asked about [m].
        resolution: how near to the least what is told must be where it is below the limit [m]; by default any place
            below the limit will do.
    """
    lengths = np.linalg.norm(ends - starts, axis=1)
    first, last = measure(starts), measure(ends)
    least = np.minimum(first, last)
    owner, low, high = np.arange(len(starts)), np.zeros(len(starts)), np.ones(len(starts))
    while True:
        span = (high - low) * lengths[owner]
        bound = 0.5 * (first + last - span)
        known = np.where(least < limit, least - resolution, limit)
        unknown = (span > FINEST) & (bound < known[owner])
        if not unknown.any():
            return least
        owner, low, high, first, last = owner[unknown], low[unknown], high[unknown], first[unknown], last[unknown]
        middle = 0.5 * (low + high)
        found = measure(starts[owner] + middle[:, None] * (ends - starts)[owner])
        np.minimum.at(least, owner, found)
        owner, low, high = np.tile(owner, 2), np.concatenate([low, middle]), np.concatenate([middle, high])
        first, last = np.concatenate([first, found]), np.concatenate([found, last])
