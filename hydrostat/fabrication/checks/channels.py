"""`channel_problems`: where a tube in a body of foam would have too thin a wall."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float

from hydrostat.fabrication.parts.part_options import PartOptions
from hydrostat.robot import Robot

SKIN = 1.0
"""Least foam between a tube and the skin [mm]: thinner, it tears when the tube is pulled. Measured on none."""

_STEP = 1e-3
"""Distance of the places that are looked at [m]."""


def channel_problems(robot: Robot, options: PartOptions) -> tuple[str, ...]:
    """Sheathed stretches that come too near the skin between two deeper places, a line each.

    Where a tube enters the body, or ends at the skin, it is near by intent.
    """
    solid = robot.body.solid
    if solid is None:
        return ()
    needed = options.tube / 2 + SKIN
    problems = []
    for number, cable in enumerate(robot.cables, start=1):
        for start, end in cable.sheathed:
            places = _along(np.array(cable.points[start : end + 1]))
            depths = -1e3 * solid.distances(places)
            thin = _between(depths, needed)
            if thin is not None:
                at = ", ".join(f"{1e3 * value:.0f}" for value in places[thin])
                problems.append(
                    f"cable {number}: its tube comes within {max(depths[thin], 0.0):.1f} mm of the skin at [{at}] mm, "
                    f"but needs {needed:.1f} mm of depth; move the points of the sheath inwards"
                )
    return tuple(problems)


def _between(depths: Float[np.ndarray, " places"], needed: float) -> int | None:
    """The shallowest place between the first and the last deep one, if it is too shallow."""
    deep = np.flatnonzero(depths >= needed)
    if not len(deep):
        return None
    inner = depths[deep[0] : deep[-1] + 1]
    lowest = int(inner.argmin())
    return int(deep[0]) + lowest if inner[lowest] < needed else None


def _along(points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "places 3"]:
    """Places along a line through points [m]."""
    pieces = []
    for one, other in pairwise(points):
        count = max(int(np.ceil(np.linalg.norm(other - one) / _STEP)), 1)
        pieces.append(one + np.linspace(0.0, 1.0, count, endpoint=False)[:, None] * (other - one))
    return np.concatenate([*pieces, points[-1:]])
