"""`ease`: time steps from one keyframe to the next, as studies of grasps take them."""

from collections.abc import Callable, Iterator

from hydrostat.arrays import Vector
from hydrostat.simulation import Motion


def ease(
    go: Callable[[Vector, float], Motion], begin: Vector, goal: Vector, *, seconds: float, step: float
) -> Iterator[Motion]:
    """Yield the motion after each time step from contractions to others [m], which begins and ends at rest.

    `go` takes contractions [m] and a time step [s], and returns the motion one step later.
    """
    count = max(1, round(seconds / step))
    for number in range(1, count + 1):
        share = number / count
        yield go(begin + share * share * (3 - 2 * share) * (goal - begin), seconds / count)
