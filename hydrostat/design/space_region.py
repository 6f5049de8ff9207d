"""`SpaceRegion`: where in a body in space cables and winches may be."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Points, Vector
from hydrostat.design.region import MARGIN, Region, Route
from hydrostat.geometry.shell import Shell
from hydrostat.robot import Body

_STEPS = 60
"""Most steps of a point on its way inside."""

_SMALLEST = 1 / 64
"""A point that gains nothing by a step of this many clearances has come as deep as it can."""


@dataclass(frozen=True, eq=False)
class SpaceRegion(Region):
    """A body in space.

    Attributes:
        shell: its surface.
        clearance: [m].
    """

    shell: Shell
    clearance: float

    def push_inside(self, route: Route) -> Route:
        """Each point, moved inward until it is `MARGIN` clearances deep; in a thin part, to where that is deepest.

        A point steps away from its nearest place on the surface. Where two sides are equally near that gains nothing:
        there it goes in the mean direction about it, along the ridge between the sides. Steps that gain nothing are
        halved.
        """
        wanted = MARGIN * self.clearance
        moved = route.copy()
        depths = self.depths(moved)
        reach = np.full(len(moved), self.clearance)
        for _ in range(_STEPS):
            going = np.flatnonzero((depths < wanted) & (reach > _SMALLEST * self.clearance))
            if not len(going):
                break
            steps = np.where(depths[going] < 0, wanted - depths[going], np.minimum(reach, wanted - depths)[going])
            places, found = self._deeper(moved[going], steps, reach[going])
            gains = found > depths[going] + 1e-3 * np.minimum(steps, reach[going])
            moved[going[gains]], depths[going[gains]] = places[gains], found[gains]
            reach[going[~gains]] *= 0.5
        return moved

    def _deeper(
        self, places: Points, steps: Float[np.ndarray, " points"], reach: Float[np.ndarray, " points"]
    ) -> tuple[Points, Vector]:
        """The deeper of where the nearest place and where the surroundings tell each point to go."""
        straight = places + steps[:, None] * self.inward(places)
        ridge = places + reach[:, None] * self._mean_inward(places, reach)
        depths = np.stack([self.depths(straight), self.depths(ridge)])
        best = depths[0] >= depths[1]
        return np.where(best[:, None], straight, ridge), depths.max(axis=0)

    def _mean_inward(self, places: Points, reach: Float[np.ndarray, " points"]) -> Points:
        """Direction of the mean of `inward` at places about each point; nought where these go all ways."""
        about = places[:, None] + reach[:, None, None] * np.concatenate([np.eye(3), -np.eye(3)])
        mean = self.inward(about.reshape(-1, 3)).reshape(about.shape).mean(axis=1)
        lengths = np.linalg.norm(mean, axis=1, keepdims=True)
        return mean / np.where(lengths > 0, lengths, 1.0)


def space_region(body: Body, clearance: float) -> SpaceRegion | None:
    """The region of a body in space, by its healed surface if it has one; None if it is too thin everywhere."""
    mesh = body.mesh
    if body.healing is not None:
        shell = Shell(body.healing.surface.vertices, body.healing.surface.triangles)
    else:
        shell = Shell(mesh.nodes, mesh.boundary)
    region = SpaceRegion(shell, clearance)
    deep = region.push_inside(mesh.nodes[mesh.elements].mean(axis=1))
    return region if region.depths(deep).max() >= MARGIN * clearance else None
