"""`Region`: where in a body cables and winches may be."""

from abc import ABC, abstractmethod

import numpy as np
from jaxtyping import Bool, Float

from hydrostat.arrays import Points
from hydrostat.design.along import least_along
from hydrostat.geometry.shell import Nearest, Shell

Route = Float[np.ndarray, "_ dim"]
"""Points that a cable runs through [m]."""

MARGIN = 1.02
"""Points are pushed so many clearances deep, so that rounding takes none out again."""


class Region(ABC):
    """A body at rest and the part of it that keeps a clearance from its edge, or from its surface in space.

    Points on a cable keep the whole clearance, straight segments between them at least half of it. The first point of a
    cable of a winch in the world lies outside: callers leave it out.

    Attributes:
        shell: edge or surface of the body.
        clearance: [m].
    """

    shell: Shell
    clearance: float

    def depths(self, places: Points) -> Float[np.ndarray, " points"]:
        """Distance of points from the edge or surface [m]; negative outside."""
        return -self._nearest(places).distances

    def inward(self, places: Points) -> Float[np.ndarray, "points dim"]:
        """Unit vectors in which `depths` grows the fastest: its gradient, but where several places are the nearest."""
        return -self._nearest(places).directions

    def sees(
        self, start: Float[np.ndarray, "segments dim"], end: Float[np.ndarray, "segments dim"]
    ) -> Bool[np.ndarray, " segments"]:
        """Whether each straight segment keeps at least half the clearance all along."""
        half = 0.5 * self.clearance
        return least_along(self.depths, start, end, half) >= half

    def holds(self, route: Route) -> bool:
        """Whether a whole route keeps at least half the clearance."""
        return bool(self.sees(route[:-1], route[1:]).all())

    @abstractmethod
    def push_inside(self, route: Route) -> Route:
        """Each point, moved to a near place `MARGIN` clearances deep if it is less deep."""

    def _nearest(self, places: Points) -> Nearest:
        return self.shell.nearest(places)
