"""`Region`: where in a flat body cables and winches may be."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float
from shapely import LineString, Polygon, contains, distance, linestrings, points, polygonize
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points

from hydrostat.errors import InputError
from hydrostat.robot import Body

Route = Float[np.ndarray, "_ dim"]
"""Points that a cable runs through [m]."""


@dataclass(frozen=True, eq=False)
class Region:
    """A flat body and the part of it that keeps a clearance from the edge.

    Attributes:
        body: the whole body [m].
        inner: the body less a margin of `clearance`, less a hair more for points pushed onto its rim.
        clearance: [m].
    """

    body: Polygon
    inner: BaseGeometry
    clearance: float

    def push_inside(self, route: Route) -> Route:
        """Each point, moved to the nearest place of the inner part if it lies outside."""
        moved = route.copy()
        for index in np.flatnonzero(~contains(self.inner, points(route))):
            moved[index] = nearest_points(self.inner, points(route[index]))[0].coords[0]
        return moved

    def sees(self, start: Route, end: Route) -> Bool[np.ndarray, " segments"]:
        """Whether each straight segment keeps at least half the clearance."""
        segments = linestrings(np.stack([start, end], axis=1))
        return np.asarray(contains(self._half, segments))

    def holds(self, route: Route) -> bool:
        """Whether a whole route keeps at least half the clearance."""
        return bool(contains(self._half, LineString(route)))

    @cached_property
    def _half(self) -> BaseGeometry:
        """The body less half the clearance."""
        return self.body.buffer(-0.5 * self.clearance)

    def depths(self, places: Float[np.ndarray, "places dim"]) -> Float[np.ndarray, " places"]:
        """Distance of points from the edge of the body [m]; negative outside."""
        spots = points(places)
        return np.where(contains(self.body, spots), 1.0, -1.0) * distance(self.body.boundary, spots)


def body_region(body: Body, clearance: float) -> Region:
    """The region of a flat body.

    Raises:
        InputError: a body in space, or one too thin for the clearance.
    """
    if body.mesh.dim != 2:
        raise InputError("networks can be designed for flat bodies only, this body lies in space")
    if body.outline is not None:
        whole = body.outline.polygon
    else:
        rings = polygonize(list(np.asarray(linestrings(body.mesh.nodes[body.mesh.boundary]))))
        whole = max((ring for ring in rings.geoms if isinstance(ring, Polygon)), key=lambda ring: ring.area)
    inner = whole.buffer(-1.02 * clearance)
    if inner.is_empty:
        raise InputError(f"the body is too thin for cables {1e3 * clearance:g} mm inside its edge; lower the clearance")
    return Region(whole, inner, clearance)
