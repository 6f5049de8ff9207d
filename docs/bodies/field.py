"""Signed distance fields to build shapes from: distance of points from a part [m], negative inside.

Parts are exact (round cone, rounded box, half space) or nearly so close to their surface (ellipsoid). What is made of
them by union, intersection and placing changes by at most the way between two points, as a distance does, so that
`contour` may skip what is far.
"""

from collections.abc import Callable, Sequence
from functools import reduce

import numpy as np

from hydrostat.arrays import Float, Points, Vector
from hydrostat.errors import InputError

Field = Callable[[Points], Vector]  # about how far each point, (points, 3) [m], is outside [m]; negative inside
Place = Float[np.ndarray, " 3"] | Sequence[float]  # a point or a direction in space


def round_cone(start: Place, end: Place, start_radius: float, end_radius: float) -> Field:
    """Distance from the hull of two balls [m]; a capsule where their radii are equal.

    In the plane of the axis and a point, the nearest place is on the slanted side, which touches both balls, or on one
    of the balls: which one is told by where the foot of the point along the slant falls. Raises InputError: a ball lies
    within the other, so that there is no cone.
    """
    first, axis = np.array(start, dtype=float), np.subtract(end, start).astype(float)
    length, fall = float(np.linalg.norm(axis)), start_radius - end_radius
    if not length > abs(fall) or min(start_radius, end_radius) < 0:
        raise InputError("a round cone needs balls of which none lies within the other, with radii of at least 0")
    sine = fall / length
    cosine = np.sqrt(1 - sine**2)

    def distance(points: Points) -> Vector:
        along = (points - first) @ axis / length
        away = np.linalg.norm(points - first - np.outer(along, axis / length), axis=1)
        foot = np.clip(along - away * sine / cosine, 0.0, length)
        return np.hypot(along - foot, away) - (start_radius - sine * foot)

    return distance


def chain(places: Sequence[Place], radii: Sequence[float], *, blend: float = 0.0) -> Field:
    """Round cones from place to place [m], one after the other, blended where they meet."""
    cones = [round_cone(*ends) for ends in zip(places, places[1:], radii, radii[1:], strict=False)]
    return union(*cones, blend=blend)


def ellipsoid(middle: Place, half_axes: Place) -> Field:
    """About the distance from an ellipsoid with axes along x, y and z [m]; right to first order at its surface."""
    center, axes = np.array(middle, dtype=float), np.array(half_axes, dtype=float)
    return lambda points: ellipsoidal((points - center) / axes, axes)


def ellipsoidal(local: Float[np.ndarray, "points axes"], axes: Float[np.ndarray, "*_ axes"]) -> Vector:
    """About the distance from an ellipse or ellipsoid of points given in half axes [m]: (|q| - 1) / |grad |q||."""
    size = np.linalg.norm(local, axis=1)
    slope = np.linalg.norm(local / axes, axis=1)
    middle = size < 1e-9  # there the slope depends on the way: the shortest half axis is right
    least = np.broadcast_to(axes, local.shape).min(axis=1)
    return np.where(middle, -least, size * (size - 1) / np.where(middle, 1.0, slope))


def rounded_box(middle: Place, half_sides: Place, corner: float) -> Field:
    """Distance from a box with edges rounded by the radius `corner` [m]."""
    center, inner = np.array(middle, dtype=float), np.array(half_sides, dtype=float) - corner
    if inner.min() < 0:
        raise InputError("the corners of a rounded box must be at most as large as the shortest half side")

    def distance(points: Points) -> Vector:
        beyond = np.abs(points - center) - inner
        return np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0) - corner

    return distance


def half_space(place: Place, outward: Place) -> Field:
    """Distance from all that lies behind a plane through a place [m] with a normal that points outward."""
    point, normal = np.array(place, dtype=float), np.array(outward, dtype=float)
    normal = normal / np.linalg.norm(normal)
    return lambda points: (points - point) @ normal


def union(*fields: Field, blend: float = 0.0) -> Field:
    """Union of fields, in turn; creases between them are filled over a width `blend` [m].

    Two fields that are equal at a place are lowered there by a quarter of the blend; where they differ by more than
    the blend nothing changes.
    """

    def distance(points: Points) -> Vector:
        return reduce(lambda one, two: _lower(one, two, blend), (field(points) for field in fields))

    return distance


def intersection(*fields: Field, blend: float = 0.0) -> Field:
    """Intersection of fields; edges between them are rounded over a width `blend` [m]."""

    def distance(points: Points) -> Vector:
        return -reduce(lambda one, two: _lower(one, two, blend), (-field(points) for field in fields))

    return distance


def place_field(field: Field, *, turn: Float[np.ndarray, "3 3"], shift: Place = (0.0, 0.0, 0.0)) -> Field:
    """Field turned about the origin by a rotation matrix and then shifted [m]."""
    moved = np.array(shift, dtype=float)
    return lambda points: field((points - moved) @ turn)


def turn_about(axis: Place, degrees: float) -> Float[np.ndarray, "3 3"]:
    """Rotation matrix about an axis through the origin, counter-clockwise seen from its tip (Rodrigues)."""
    x, y, z = np.array(axis, dtype=float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(np.radians(degrees)) * cross + (1 - np.cos(np.radians(degrees))) * cross @ cross


def _lower(one: Vector, two: Vector, blend: float) -> Vector:
    """Lower of two, with a parabola between where they are nearer than the blend; its slopes add up to one."""
    if blend == 0:
        return np.minimum(one, two)
    near = np.maximum(blend - np.abs(one - two), 0.0)
    return np.minimum(one, two) - near**2 / (4 * blend)
