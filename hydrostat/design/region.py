"""`Region`: where in a body, flat or in space, cables and winches may be."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from shapely import Polygon, contains, linestrings, points, polygonize, prepare
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points

from hydrostat.arrays import Bool, Float, Points, Vector
from hydrostat.design.polyline import Route, least_along
from hydrostat.errors import InputError
from hydrostat.geometry import Nearest, Shell
from hydrostat.robot import Body

MARGIN = 1.02  # points are pushed so many clearances deep, so that rounding takes none out again


Band = tuple[float, float]
"""The least and the largest depth [m]."""


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

    @property
    def hole_band(self) -> Band:
        """Least and largest depth of a point of a cable [m]."""
        return self.clearance, np.inf

    @property
    def run_band(self) -> Band:
        """Least and largest depth along a straight run [m]."""
        return 0.5 * self.clearance, np.inf

    def fits(self, places: Points) -> Bool[np.ndarray, " points"]:
        """True for each position where a cable may have a point."""
        least, most = self.hole_band
        depths = self.depths(places)
        return (depths >= least) & (depths <= most)

    def depths(self, places: Points) -> Float[np.ndarray, " points"]:
        """Distance of points from the edge or surface [m]; negative outside."""
        return -self._nearest(places).distances

    def inward(self, places: Points) -> Float[np.ndarray, "points dim"]:
        """Unit vectors in which `depths` grows the fastest: its gradient, but where several places are the nearest."""
        return -self._nearest(places).directions

    def depths_and_ways(self, places: Points) -> tuple[Float[np.ndarray, " points"], Float[np.ndarray, "points dim"]]:
        """Give `depths` and `inward` of points in one search [m]."""
        nearest = self._nearest(places)
        return -nearest.distances, -nearest.directions

    def sees(
        self, start: Float[np.ndarray, "segments dim"], end: Float[np.ndarray, "segments dim"]
    ) -> Bool[np.ndarray, " segments"]:
        """True for each straight segment that keeps at least half the clearance all along."""
        least, _ = self.run_band
        return least_along(self.depths, start, end, least) >= least

    def holds(self, route: Route) -> bool:
        """True if a whole route keeps at least half the clearance."""
        return bool(self.sees(route[:-1], route[1:]).all())

    @abstractmethod
    def push_inside(self, route: Route) -> Route:
        """Each point, moved to a near place `MARGIN` clearances deep if it is less deep."""

    def _nearest(self, places: Points) -> Nearest:
        return self.shell.nearest(places)

    @staticmethod
    def of_body(body: Body, clearance: float) -> "Region":
        """The region of a body, as drawn or scanned, or of its mesh (InputError.

        Too thin everywhere for the clearance).
        """
        region = (flat_region if body.mesh.dim == 2 else space_region)(body, clearance)
        if region is None:
            depth = f"{1e3 * clearance:g} mm inside its {'edge' if body.mesh.dim == 2 else 'surface'}"
            raise InputError(f"the body is too thin for cables {depth}; lower the clearance")
        return region


@dataclass(frozen=True, eq=False)
class FlatRegion(Region):
    """A flat body, as a polygon too."""

    shell: Shell  # its edge
    clearance: float  # [m]
    body: Polygon  # the whole body [m]
    inner: BaseGeometry  # the body less `MARGIN` clearances

    def push_inside(self, route: Route) -> Route:
        """Each point, moved to the nearest place of the inner part if it lies outside of that."""
        moved = route.copy()
        for index in np.flatnonzero(~contains(self.inner, points(route))):
            moved[index] = nearest_points(self.inner, points(route[index]))[0].coords[0]
        return moved

    def sees(
        self, start: Float[np.ndarray, "segments dim"], end: Float[np.ndarray, "segments dim"]
    ) -> Bool[np.ndarray, " segments"]:
        """True for each straight segment that keeps at least half the clearance all along."""
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
        whole, shell = body.outline.polygon, Shell.of_outline(body.outline)
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


_STEPS = 60  # most steps of a point on its way inside
_MIN_STEP = 1 / 64  # a point that gains nothing by a step of this many clearances has come as deep as it can


@dataclass(frozen=True, eq=False)
class SpaceRegion(Region):
    """A body in space."""

    shell: Shell  # its surface
    clearance: float  # [m]

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
            going = np.flatnonzero((depths < wanted) & (reach > _MIN_STEP * self.clearance))
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
    region = SpaceRegion(body_shell(body), clearance)
    deep = region.push_inside(mesh.nodes[mesh.elements].mean(axis=1))
    return region if region.depths(deep).max() >= MARGIN * clearance else None


def body_shell(body: Body) -> Shell:
    """The surface of a body in space: as it was healed, or of its mesh."""
    if body.healing is not None:
        return Shell(body.healing.surface.vertices, body.healing.surface.triangles)
    return Shell(body.mesh.nodes, body.mesh.boundary)
