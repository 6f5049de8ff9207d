"""`Contact` and `Obstacle`: that a body does not pass through itself, nor through what stands beside it."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Points
from hydrostat.errors import InputError
from hydrostat.geometry.distance_field import (
    DistanceField,
    box_field,
    capsule_field,
    cylinder_field,
    plane_field,
    sphere_field,
)
from hydrostat.robot.checks import Point, check_name, check_point, check_positive

DISTANCE = 0.005
"""Parts begin to feel one another at this share of the size of the body, where nothing else is said."""


@dataclass(frozen=True, kw_only=True)
class Contact:
    """A body that feels itself, and obstacles, before they touch.

    Attributes:
        distance: at which parts begin to push one another off [m]; None: 1/200 of the size of the body.
    """

    distance: float | None = None

    def __post_init__(self) -> None:
        if self.distance is not None:
            check_positive("distance", self.distance, "m")


class ObstacleShape(StrEnum):
    """What an obstacle is."""

    PLANE = "plane"  # all behind `at`, against `normal`
    SPHERE = "sphere"  # about `at`; a disc in the plane
    CAPSULE = "capsule"  # all within `radius` of the way from `at` to `to`
    CYLINDER = "cylinder"  # the same with flat ends; in space only
    BOX = "box"  # with `at` and `to` as opposite corners


@dataclass(frozen=True, kw_only=True)
class Obstacle:
    """A rigid thing that stands still beside the body.

    Attributes:
        name: of it.
        shape: what it is.
        at: a point of the plane, the middle of a sphere, one end of a capsule or cylinder, one corner of a box [m].
        to: the other end or corner [m]; only where there is one.
        radius: of a sphere, capsule or cylinder [m].
        normal: out of a plane, of any length.

    Raises:
        InputError: a key that is missing or does not belong to the shape, or a wrong value.
    """

    name: str
    shape: ObstacleShape | str
    at: Point
    to: Point | None = None
    radius: float | None = None
    normal: Point | None = None

    def __post_init__(self) -> None:
        check_name(self.name)
        kinds = [str(shape) for shape in ObstacleShape]
        if self.shape not in kinds:
            raise InputError(f'there is no shape "{self.shape}"; there are: {", ".join(kinds)}')
        object.__setattr__(self, "shape", ObstacleShape(self.shape))
        needed = _NEEDED[ObstacleShape(self.shape)]
        for key in ("to", "radius", "normal"):
            given = getattr(self, key) is not None
            if given != (key in needed):
                raise InputError(f"a {self.shape} {'has no' if given else 'needs a'} {key}")
        check_point("at", self.at)
        if self.radius is not None:
            check_positive("radius", self.radius, "m")
        for key, point in (("to", self.to), ("normal", self.normal)):
            if point is not None:
                check_point(key, point)
                if len(point) != len(self.at):
                    raise InputError(f"{key} has {len(point)} entries, at has {len(self.at)}; give as many")
        if self.normal is not None and not any(self.normal):
            raise InputError("normal must not be 0 along every axis")
        if self.to is not None and (
            self.at == self.to or (self.shape is ObstacleShape.BOX and 0 in np.subtract(self.at, self.to))
        ):
            raise InputError("at and to leave nothing between them; move one of them")
        if self.shape is ObstacleShape.CYLINDER and len(self.at) == 2:
            raise InputError("a flat body meets no cylinder; use a sphere, which is a disc in the plane, or a box")

    def spine(self) -> Points:
        """Points within it, (points, dim): along the way from `at` to `to`; none of a plane, which has no end [m]."""
        at = np.array(self.at)
        if self.shape == ObstacleShape.PLANE:
            return np.zeros((0, len(at)))
        return at + np.linspace(0, 1, _SPINE)[:, None] * ((self.to or self.at) - at)

    def field(self) -> DistanceField:
        """Distance of points from it."""
        return _FIELDS[ObstacleShape(self.shape)](self)


_SPINE = 41
"""Points along an obstacle that are looked for in the body."""

_NEEDED = {
    ObstacleShape.PLANE: ("normal",),
    ObstacleShape.SPHERE: ("radius",),
    ObstacleShape.CAPSULE: ("to", "radius"),
    ObstacleShape.CYLINDER: ("to", "radius"),
    ObstacleShape.BOX: ("to",),
}
_FIELDS: dict[ObstacleShape, Callable[[Obstacle], DistanceField]] = {
    ObstacleShape.PLANE: lambda one: plane_field(np.array(one.at), np.array(one.normal)),
    ObstacleShape.SPHERE: lambda one: sphere_field(np.array(one.at), one.radius or 0.0),
    ObstacleShape.CAPSULE: lambda one: capsule_field(np.array(one.at), np.array(one.to), one.radius or 0.0),
    ObstacleShape.CYLINDER: lambda one: cylinder_field(np.array(one.at), np.array(one.to), one.radius or 0.0),
    ObstacleShape.BOX: lambda one: box_field(np.array(one.at), np.array(one.to)),
}
