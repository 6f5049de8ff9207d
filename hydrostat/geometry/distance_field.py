"""`DistanceField`: distance of points from a rigid shape, with its first two derivatives."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Float, Points, Vector


class Distances(NamedTuple):
    """Distance of points from a shape.

    Attributes:
        values: signed distances [m], (points,); negative inside, where the magnitude may be too small but the sign is
            right.
        normals: gradients dd/dx, away from the shape, (points, dim).
        curvatures: d2d/dx2 [1/m], (points, dim, dim).
    """

    values: Vector
    normals: Points
    curvatures: Float[np.ndarray, "points dim dim"]


@dataclass(frozen=True)
class DistanceField:
    """Signed distance of points [m], (points, dim), from one shape; can be sent to other processes.

    Attributes:
        whole: function that returns distances with their derivatives.
        lean: function that returns distances alone, if that is cheaper.
    """

    whole: Callable[[Points], Distances]
    lean: Callable[[Points], Vector] | None = None

    def __call__(self, points: Points) -> Distances:
        """Distances and their derivatives."""
        return self.whole(points)

    def values(self, points: Points) -> Vector:
        """Distances alone [m]."""
        return self.whole(points).values if self.lean is None else self.lean(points)

    @staticmethod
    def box(at: Vector, to: Vector) -> "DistanceField":
        """Distance from a box with two opposite corners [m]; a rectangle in the plane."""
        middle, half = 0.5 * (at + to), 0.5 * np.abs(to - at)
        return DistanceField(partial(_from_box, middle, half), partial(_box_values, middle, half))

    @staticmethod
    def capsule(at: Vector, to: Vector, radius: float) -> "DistanceField":
        """Signed distance from a capsule: all points within a radius of a segment [m]."""
        length = float(np.linalg.norm(to - at))
        axis = (to - at) / length
        return DistanceField(partial(_from_capsule, at, axis, length, radius))

    @staticmethod
    def cylinder(at: Vector, to: Vector, radius: float) -> "DistanceField":
        """Distance from a cylinder with flat ends, in space [m]."""
        length = float(np.linalg.norm(to - at))
        return DistanceField(partial(_from_cylinder, 0.5 * (at + to), (to - at) / length, length, radius))

    @staticmethod
    def plane(at: Vector, normal: Vector) -> "DistanceField":
        """Distance from all that lies behind a plane through a point [m]."""
        unit = normal / np.linalg.norm(normal)
        return DistanceField(partial(_from_plane, at, unit), partial(_plane_values, at, unit))

    @staticmethod
    def sphere(at: Vector, radius: float) -> "DistanceField":
        """Distance from a ball; a disc in the plane [m]."""
        return DistanceField(partial(_from_sphere, at, radius), partial(_sphere_values, at, radius))


def _from_plane(at: Vector, unit: Vector, points: Points) -> Distances:
    curvatures = np.zeros((*points.shape, points.shape[1]))
    return Distances(_plane_values(at, unit, points), np.broadcast_to(unit, points.shape).copy(), curvatures)


def _plane_values(at: Vector, unit: Vector, points: Points) -> Vector:
    return (points - at) @ unit


def _sphere_values(at: Vector, radius: float, points: Points) -> Vector:
    return lengths_of(points - at) - radius


def _box_values(middle: Vector, half: Vector, points: Points) -> Vector:
    beyond = np.abs(points - middle) - half
    far = lengths_of(np.maximum(beyond, 0.0))
    return np.where(far == 0.0, beyond.max(axis=1), far)


def _from_sphere(at: Vector, radius: float, points: Points) -> Distances:
    return _around(points - at, np.zeros_like(points), radius)


def _from_capsule(at: Vector, axis: Vector, length: float, radius: float, points: Points) -> Distances:
    along = (points - at) @ axis
    nearest = np.clip(along, 0.0, length)
    free = np.where((along > 0) & (along < length), 1.0, 0.0)[:, None] * axis
    return _around(points - at - nearest[:, None] * axis, free, radius)


def _from_cylinder(middle: Vector, axis: Vector, length: float, radius: float, points: Points) -> Distances:
    along = (points - middle) @ axis
    outward = points - middle - along[:, None] * axis
    far = np.maximum(np.linalg.norm(outward, axis=1), _TINY)
    outward, end = outward / far[:, None], np.where(along < 0, -1.0, 1.0)[:, None] * axis
    beside, beyond = far - radius, np.abs(along) - 0.5 * length
    round_, rim = beside > beyond, (beside > 0) & (beyond > 0)
    values = np.where(rim, np.hypot(beside, beyond), np.maximum(beside, beyond))
    away = np.where(rim, values, 1.0)
    side, flat = (np.where(rim, one / away, kept) for one, kept in ((beside, round_), (beyond, ~round_)))
    normals = side[:, None] * outward + flat[:, None] * end
    turning = np.cross(axis, outward)
    curvatures = (side / far)[:, None, None] * _square(turning)
    sharp = flat[:, None] * outward - side[:, None] * end
    curvatures += np.where(rim, 1.0 / away, 0.0)[:, None, None] * _square(sharp)
    return Distances(values, normals, curvatures)


def _from_box(middle: Vector, half: Vector, points: Points) -> Distances:
    beyond = np.abs(points - middle) - half
    signs = np.where(points < middle, -1.0, 1.0)
    out = np.maximum(beyond, 0.0)
    far = lengths_of(out)
    inside = far == 0.0
    values = np.where(inside, beyond.max(axis=1), far)
    sides = np.eye(points.shape[1])[beyond.argmax(axis=1)]
    normals = signs * np.where(inside[:, None], sides, out / np.maximum(far, _TINY)[:, None])
    across = np.eye(points.shape[1]) * (out > 0)[:, None, :] - _square(normals)
    curvatures = np.where(inside, 0.0, 1.0 / np.maximum(far, _TINY))[:, None, None] * across
    return Distances(values, normals, curvatures)


def _around(spans: Points, free: Points, radius: float) -> Distances:
    """Distance beyond a radius from a point or, where `free` is its direction, a line; `spans` lead from there."""
    far = np.maximum(lengths_of(spans), _TINY)
    normals = spans / far[:, None]
    across = np.eye(spans.shape[1]) - _square(normals) - _square(free)
    return Distances(far - radius, normals, across / far[:, None, None])


def lengths_of(vectors: Points) -> Vector:
    """Length of each vector."""
    return np.sqrt(np.einsum("pd,pd->p", vectors, vectors))


def _square(vectors: Points) -> Float[np.ndarray, "points dim dim"]:
    return vectors[:, :, None] * vectors[:, None, :]


_TINY = np.finfo(float).tiny
