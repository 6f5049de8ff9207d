"""`SkinRegion`: the layer at one depth under the surface of a body in space, for cables on its skin (R53)."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Bool, Float
from hydrostat.design.constraints import Constraints
from hydrostat.design.polyline import Route, least_along
from hydrostat.design.region import Band, Region, SpaceRegion, body_shell
from hydrostat.errors import InputError
from hydrostat.robot import Body

STITCH = 5e-4  # points may be so much farther in or out than they should [m]: nobody sews finer
SINK = 3e-3
"""A straight run between two points may lie so much deeper than they do [m]: on a round body it cuts the corner, and a
cable that was simulated so near to the skin acts as if it were on it. Assumed."""

_STEPS = 8  # most steps of a point on its way to the layer: beside an edge each step may change what is nearest


@dataclass(frozen=True, eq=False)
class SkinRegion(SpaceRegion):
    """A body in space whose cables lie at one depth.

    Points lie there to a stitch; straight runs leave the body by no more than that, also where it is hollow, and dive
    no deeper than a little.
    """

    depth: float  # under the surface; 0 for on it [m]

    @property
    def hole_band(self) -> Band:
        """Least and largest depth of a point of a cable: never outside, where nothing holds it [m]."""
        return max(self.depth - STITCH, 0.0), self.depth + STITCH

    @property
    def run_band(self) -> Band:
        """Least and largest depth along a straight run [m]."""
        return min(self.depth - STITCH, 0.5 * self.depth), self.depth + SINK

    def push_inside(self, route: Route) -> Route:
        """Each point, moved to the nearest place of the layer; in a part that is thinner, as near as it comes."""
        moved, wanted = route.copy(), float(np.mean(self.hole_band))
        for _ in range(_STEPS):
            depths, ways = self.depths_and_ways(moved)
            off = np.flatnonzero(np.abs(wanted - depths) > 0.1 * STITCH)
            if not len(off):
                break
            moved[off] += (wanted - depths[off])[:, None] * ways[off]
        return moved

    def sees(
        self, start: Float[np.ndarray, "segments dim"], end: Float[np.ndarray, "segments dim"]
    ) -> Bool[np.ndarray, " segments"]:
        """True for each straight segment that keeps to the layer all along."""
        least, most = self.run_band
        seen = least_along(self.depths, start, end, least) >= least
        seen[seen] = least_along(lambda places: -self.depths(places), start[seen], end[seen], -most) >= -most
        return seen


def cable_region(body: Body, constraints: Constraints) -> Region:
    """Region that cables of a body may use: a clearance from its edge or surface, or a layer under its skin.

    Raises InputError: the body is too thin for that everywhere.
    """
    if constraints.depth is None:
        return Region.of_body(body, constraints.clearance)
    region = SkinRegion(body_shell(body), max(constraints.depth - STITCH, 0.0), constraints.depth)
    nodes = body.mesh.nodes[np.unique(body.mesh.boundary)]
    if not region.fits(region.push_inside(nodes)).any():
        raise InputError(f"the body is too thin for cables {1e3 * constraints.depth:g} mm under its skin; lower depth")
    return region
