"""Mirror lines: `find_mirror`, and `mirror_points`, which puts points on such a line or in pairs across it."""

from collections.abc import Callable

import numpy as np

from hydrostat.arrays import Int, Nodes, Points, Vector
from hydrostat.robot.body import Body

MIRROR_TOLERANCE = 0.02
"""Share of a body's size by which a point may be off its mirror image."""


def measure_asymmetry(body: Body, axis: int) -> float:
    """Distance [m] by which the mirror image of a body, about 0 of one axis, sticks out of it."""
    flip = np.ones(body.mesh.dim)
    flip[axis] = -1.0
    return float(body.distances(body.mesh.nodes[body.mesh.boundary_nodes] * flip).max())


def find_mirror(body: Body) -> int | None:
    """Axis about whose 0 a body is its own mirror image, the more exact one if both are; None without one.

    A drawn body has 0 in the middle of its drawing. Slanted lines are not found.
    """
    off = [measure_asymmetry(body, axis) for axis in range(body.mesh.dim)]
    axis = int(np.argmin(np.round(off, 4)))
    return axis if off[axis] <= MIRROR_TOLERANCE * body.mesh.size else None


def mirror_points(
    points: Points, axis: int, *, near: float, holds: Callable[[Vector], bool]
) -> tuple[Nodes, Int[np.ndarray, " nodes"]]:
    """Points on a mirror line or in pairs across it, and the number of each one's twin (its own on the line).

    Twins are moved to the mean of each and the other's image. A point near the line without a twin goes to it if
    `holds` says that this place is in the body, else its image is added. A single point far from the line stays alone.

    Args:
        points: about a mirror where a coordinate is 0 [m].
        axis: number of this coordinate.
        near: maximum distance of twins from each other's image, and of a point from the line that it goes to [m].
        holds: test of a place.
    """
    flip = np.ones(points.shape[1])
    flip[axis] = -1.0
    apart = np.linalg.norm(points[:, None] * flip - points[None], axis=2)
    found, twins = points.copy(), np.full(len(points), -1)
    for one, two in sorted(np.argwhere(apart <= near).tolist(), key=lambda pair: (apart[*pair], pair)):
        if one != two and twins[one] < 0 and twins[two] < 0 and points[one, axis] * points[two, axis] <= 0:
            twins[one], twins[two] = two, one
            found[one] = (points[one] + points[two] * flip) / 2
            found[two] = found[one] * flip
    for alone in np.flatnonzero(twins < 0).tolist():
        on_line = np.where(flip < 0, 0.0, points[alone])
        if abs(points[alone, axis]) <= near and holds(on_line):
            found[alone], twins[alone] = on_line, alone
        elif len(points) == 1:
            twins[alone] = alone
        else:
            twins = np.append(twins, alone)
            twins[alone] = len(found)
            found = np.vstack([found, points[alone] * flip])
    return found, twins
