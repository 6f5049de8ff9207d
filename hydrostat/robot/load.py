"""`Load`: a force at a point of the body, or a mass that hangs there."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.given import Point, check_name, check_number, check_point, check_positive


@dataclass(frozen=True, kw_only=True)
class Load:
    """Force with a constant direction or weight of a hung mass at a marker or point, or pressure in a closed cavity.

    Attributes:
        name: name, unique in the robot.
        at: point of the body at rest, for a pressure in the cavity [m]; None with `marker`.
        marker: name of the marker that carries it; None with `at`.
        force: force along each axis [N]; None for others.
        mass: point mass [kg]: gravity pulls at it, and it has inertia in motion; None for others.
        pressure: pressure in the hole around `at` that the body closes [Pa], below 0 for a vacuum.

    Raises:
        InputError: not one of `at` and `marker`, not one of `force`, `mass` and `pressure`, or a number out of range.
    """

    name: str
    at: Point | None = None
    marker: str | None = None
    force: tuple[float, ...] | None = None
    mass: float | None = None
    pressure: float | None = None

    def __post_init__(self) -> None:
        check_name(self.name)
        if (self.at is None) == (self.marker is None):
            raise InputError("give either marker, or at (a point of the body)")
        if sum(value is not None for value in (self.force, self.mass, self.pressure)) != 1:
            raise InputError("give either force, or mass (which hangs there), or pressure (in the hole around at)")
        if self.pressure is not None:
            if self.at is None:
                raise InputError("pressure needs at, a point in the hole of the body that it fills")
            check_number("pressure", self.pressure, "Pa")
        if self.at is not None:
            check_point("at", self.at)
        if self.force is not None:
            check_point("force", self.force)
        if self.mass is not None:
            check_positive("mass", self.mass, "kg")

    @property
    def body_points(self) -> tuple[Point, ...]:
        """Its `at` if that is a point of the body; that of a pressure lies in a hole."""
        return () if self.at is None or self.pressure is not None else (self.at,)

    def force_under(self, gravity: tuple[float, ...] | None, dim: int) -> Vector:
        """Force on the body [N], (dim,): the weight of a mass under gravity [m/s^2]."""
        if self.force is not None:
            return np.array(self.force, dtype=float)
        return (self.mass or 0.0) * (np.zeros(dim) if gravity is None else np.array(gravity))


def check_cavity(index: int, load: Load, mesh: Mesh) -> None:
    """Reject a pressure at a point that is in no hole of the body (InputError)."""
    if load.pressure is None or load.at is None:
        return
    if len(load.at) != mesh.dim:
        raise InputError(f"load[{index}].at has {len(load.at)} coordinates, but the body has {mesh.dim}")
    if not len(mesh.cavity(np.array(load.at))):
        raise InputError(
            f"load[{index}].at: a pressure fills a hole that the body closes, and this point is in none; move it there"
        )
