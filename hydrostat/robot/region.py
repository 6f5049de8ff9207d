"""`PartRegion`: part of space by a simple shape."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Self

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.closed_set import make_member
from hydrostat.errors import InputError
from hydrostat.given import Point, check_name, check_point
from hydrostat.robot.contact import ClosedMesh, Obstacle


class PartShape(StrEnum):
    """Shape of the region of a body part. A shape in the plane goes through all of a body in space."""

    SPHERE = "sphere"  # all within `radius` of `at`; a disc in the plane
    CAPSULE = "capsule"  # all within `radius` of the line from `at` to `to`
    CYLINDER = "cylinder"  # the same with flat ends; in space only
    BOX = "box"  # with `at` and `to` as opposite corners
    POLYGON = "polygon"  # what the corners `points` enclose, in the plane
    CELLS = "cells"  # elements that a mesh file has under `label`; for parts of a ready mesh only
    MESH = "mesh"  # what a closed surface from a file encloses, moved by `at`; in space only


@dataclass(frozen=True, kw_only=True)
class PartRegion:
    """Region of a body by a simple shape.

    Attributes:
        name: name, unique among its kind.
        shape: shape of the region; None: all of the body.
        at: center of a sphere, one end of a capsule or cylinder, one corner of a box, shift of a mesh [m].
        to: other end or corner [m]; only for shapes that have one.
        radius: radius of a sphere, capsule or cylinder [m].
        points: corners of a polygon [m].
        mesh: closed surface, moved by `at`.
        label: label of elements in a mesh file; for the shape cells.

    Raises:
        InputError: a key that is missing or does not belong to the shape.
    """

    name: str
    shape: PartShape | str | None = None
    at: Point | None = None
    to: Point | None = None
    radius: float | None = None
    points: tuple[Point, ...] = ()
    mesh: ClosedMesh | None = None
    label: str | None = None

    def __post_init__(self) -> None:
        check_name(self.name)
        if self.shape is None:
            if any(getattr(self, key) not in (None, ()) for key in _KEYS):
                raise InputError("a region needs its shape, such as box")
            return
        make_member(self, "shape", PartShape)
        if (self.shape is PartShape.CELLS) != bool(self.label):
            raise InputError('shape = "cells" needs a label, and no other shape has one')
        if self.shape is PartShape.POLYGON:
            self._check_polygon()
        elif self.shape is PartShape.CELLS:
            self._check_none("at", "to", "radius", "mesh", "points")
        elif self.points:
            raise InputError(f"a {self.shape} has no points")
        elif self.at is None:
            raise InputError(f"a {self.shape} needs at")
        else:
            self._solid()

    def _check_none(self, *keys: str) -> None:
        for key in keys:
            if getattr(self, key) not in (None, ()):
                what = "a polygon" if self.shape is PartShape.POLYGON else "a region of cells"
                raise InputError(f"{what} has no {key}")

    def _check_polygon(self) -> None:
        self._check_none("at", "to", "radius", "mesh")
        for index, point in enumerate(self.points):
            check_point(f"points[{index}]", point)
        from shapely import Polygon

        if any(len(point) != 2 for point in self.points) or len(self.points) < 3:
            raise InputError("a polygon needs at least three points of two coordinates")
        if not Polygon(self.points).is_valid:
            raise InputError("the sides of the polygon cross; give its corners in order")

    @property
    def dim(self) -> int:
        """Number of coordinates of its region; 0 for all of the body, and for cells."""
        if self.shape is None or self.shape is PartShape.CELLS:
            return 0
        return len(self.points[0]) if self.at is None else len(self.at)

    def holds(self, points: Points) -> np.ndarray:
        """Mask of the points [m] in the region, (points,)."""
        if self.shape is None:
            return np.ones(len(points), dtype=bool)
        return self._depths(points[:, : self.dim])[0] <= 0.0

    def border(self, points: Points) -> tuple[Vector, Points]:
        """Signed distance of points from the border [m], below 0 inside, and the place of the border next to each."""
        depths, places = self._depths(points[:, : self.dim])
        if self.shape is not PartShape.POLYGON:
            for _ in range(2):  # distances of points inside may be too small
                places = self._depths(places)[1]
        return depths, np.concatenate([places, points[:, self.dim :]], axis=1)

    def _depths(self, points: Points) -> tuple[Vector, Points]:
        if self.shape is not PartShape.POLYGON:
            found = self._solid().field()(points)
            return found.values, points - found.values[:, None] * found.normals
        import shapely

        polygon, spots = shapely.Polygon(self.points), shapely.points(points)
        ring = polygon.exterior
        shapely.prepare(polygon)
        inside = shapely.intersects(polygon, spots)
        places = shapely.get_coordinates(shapely.line_interpolate_point(ring, shapely.line_locate_point(ring, spots)))
        distances = np.linalg.norm(places - points, axis=1)
        return np.where(inside, -distances, distances), places

    def grid(self, count: int) -> Points:
        """Points of a regular grid of about `count` over the box about the region, also outside it [m]."""
        if self.mesh is not None:
            corners = self.mesh.surface.vertices + np.array(self.at)
        else:
            corners = np.array([point for point in (self.at, self.to, *self.points) if point is not None])
        far = self._reach()
        low, high = corners.min(axis=0) - far, corners.max(axis=0) + far
        steps = round(count ** (1 / self.dim)) | 1
        low, high = low + 1e-9 * (high - low), high - 1e-9 * (high - low)  # or rounding puts its sides outside
        lines = [np.linspace(*ends, steps) for ends in zip(low, high, strict=True)]
        return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, self.dim)

    def _reach(self) -> Vector | float:
        """Distance along each axis by which the region reaches beyond its points [m]."""
        radius = self.radius or 0.0
        if self.shape is not PartShape.CYLINDER or self.at is None or self.to is None:
            return radius
        axis = np.subtract(self.to, self.at)
        return radius * np.sqrt(np.maximum(1.0 - (axis / np.linalg.norm(axis)) ** 2, 0.0))

    def with_transform(self, move: Callable[[Point], Point], scale: float = 1.0) -> Self:
        """Return the same with every point moved, and its radius scaled; a mesh is only shifted."""
        return replace(
            self,
            at=None if self.at is None else move(self.at),
            to=None if self.to is None else move(self.to),
            radius=None if self.radius is None else scale * self.radius,
            points=tuple(map(move, self.points)),
        )

    def _solid(self) -> Obstacle:
        """PartRegion as an obstacle, which checks the keys and measures distances."""
        return Obstacle(
            name=self.name, shape=str(self.shape), at=self.at or (), to=self.to, radius=self.radius, mesh=self.mesh
        )


_KEYS = ("at", "to", "radius", "points", "mesh", "label")
