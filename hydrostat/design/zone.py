"""`Zone`: a part of the plane or of space, at rest."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Points
from hydrostat.robot import Point


@dataclass(frozen=True, kw_only=True)
class Zone:
    """A disc or ball (`at` and `radius`), a box, or a polygon (flat bodies) [m]."""

    at: Point | None = None
    radius: float | None = None
    box: tuple[Point, Point] | None = None
    outline: tuple[Point, ...] = ()

    def distances(self, points: Points) -> Float[np.ndarray, " points"]:
        """Distance from the zone [m]; negative inside."""
        raise NotImplementedError
