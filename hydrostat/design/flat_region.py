"""`FlatRegion`: where in a flat body cables and winches may be."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float
from shapely import Polygon, contains, linestrings, points, polygonize, prepare
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points

from hydrostat.design.region import MARGIN, Region, Route
from hydrostat.geometry.shell import Shell, outline_shell
from hydrostat.robot import Body


@dataclass(frozen=True, eq=False)
class FlatRegion(Region):
    """A flat body, as a polygon too.

    Attributes:
        shell: its edge.
        clearance: [m].
        body: the whole body [m].
        inner: the body less `MARGIN` clearances.
    """

    shell: Shell
    clearance: float
    body: Polygon
    inner: BaseGeometry

    def push_inside(self, route: Route) -> Route:
        """Each point, moved to the nearest place of the inner part if it lies outside of that."""
        moved = route.copy()
        for index in np.flatnonzero(~contains(self.inner, points(route))):
            moved[index] = nearest_points(self.inner, points(route[index]))[0].coords[0]
        return moved

    def sees(
        self, start: Float[np.ndarray, "segments dim"], end: Float[np.ndarray, "segments dim"]
    ) -> Bool[np.ndarray, " segments"]:
        """Whether each straight segment keeps at least half the clearance all along."""
        return np.asarray(contains(self._half, linestrings(np.stack([start, end], axis=1))))

    @cached_property
    def _half(self) -> BaseGeometry:
        """The body less half the clearance."""
        half = self.body.buffer(-0.5 * self.clearance)
        prepare(half)
        return half


def flat_region(body: Body, clearance: float) -> FlatRegion | None:
    """The region of a flat body; None if it is too thin everywhere."""
    if body.outline is not None:
        whole, shell = body.outline.polygon, outline_shell(body.outline)
    else:
        mesh = body.mesh
        rings = polygonize(list(np.asarray(linestrings(mesh.nodes[mesh.boundary]))))
        whole = max((ring for ring in rings.geoms if isinstance(ring, Polygon)), key=lambda ring: ring.area)
        shell = Shell(mesh.nodes, mesh.boundary)
    inner = whole.buffer(-MARGIN * clearance)
    if inner.is_empty:
        return None
    prepare(inner)
    return FlatRegion(shell, clearance, whole, inner)
