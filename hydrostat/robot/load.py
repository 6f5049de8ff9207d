"""`Load`: a force at a point of the body, or a mass that hangs there."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.robot.checks import Point, check_name, check_point, check_positive


@dataclass(frozen=True, kw_only=True)
class Load:
    """Dead load: a force with a constant direction, or the weight of a hung mass, at a marker or a point of the body.

    Attributes:
        name: name, unique in the robot.
        at: point of the body at rest [m]; None with `marker`.
        marker: name of the marker that carries it; None with `at`.
        force: force along each axis [N]; None with `mass`.
        mass: point mass [kg]: gravity pulls at it, and it has inertia in motion; None with `force`.

    Raises:
        InputError: both or neither of `at` and `marker`, or of `force` and `mass`, or a number out of its range.
    """

    name: str
    at: Point | None = None
    marker: str | None = None
    force: tuple[float, ...] | None = None
    mass: float | None = None

    def __post_init__(self) -> None:
        check_name(self.name)
        if (self.at is None) == (self.marker is None):
            raise InputError("give either marker, or at (a point of the body)")
        if (self.force is None) == (self.mass is None):
            raise InputError("give either force, or mass (which hangs there)")
        if self.at is not None:
            check_point("at", self.at)
        if self.force is not None:
            check_point("force", self.force)
        if self.mass is not None:
            check_positive("mass", self.mass, "kg")

    def force_under(self, gravity: tuple[float, ...] | None, dim: int) -> Vector:
        """Force on the body [N], (dim,): the weight of a mass under gravity [m/s^2]."""
        if self.force is not None:
            return np.array(self.force, dtype=float)
        return (self.mass or 0.0) * (np.zeros(dim) if gravity is None else np.array(gravity))
