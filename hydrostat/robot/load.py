"""`Load`: a force or moment at a point of the body, a mass that hangs there, or a pressure in a cavity."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.given import Point, check_name, check_number, check_point, check_positive, check_unique, list_choices
from hydrostat.units import quote

MAX_SHARE = 100.0
"""Largest share of a load in a motion: 1 is all of it. Write a larger load instead."""


@dataclass(frozen=True, kw_only=True)
class Load:
    """Force or moment about a constant axis, or weight of a hung mass at a marker or point; or pressure in a cavity.

    Attributes:
        name: name, unique in the robot.
        at: point of the body at rest, for a pressure in the cavity [m]; None with `marker`.
        marker: name of the marker that carries it; None with `at`.
        force: force along each axis [N]; None for others.
        mass: point mass [kg], with weight under gravity and inertia in motion; None for others.
        pressure: pressure in the closed hole of the body around `at` [Pa], below 0 for a vacuum.
        moment: moment on the elements there [N m]: one value in the plane, from x to y, or one about each axis.
        path: keyframes of a motion: times [s] and load shares, linear between them, constant before and after. Without
            a path, and in statics, the full load acts.
        drive: name of the `LoadDrive` that scales the load; None without one.

    Raises:
        InputError: not exactly one of `at` and `marker`, not exactly one of `force`, `mass`, `pressure` and `moment`,
            or a value out of range.
    """

    name: str
    at: Point | None = None
    marker: str | None = None
    force: tuple[float, ...] | None = None
    mass: float | None = None
    pressure: float | None = None
    moment: tuple[float, ...] | None = None
    path: tuple[tuple[float, float], ...] = ()
    drive: str | None = None

    def __post_init__(self) -> None:
        check_name(self.name)
        if (self.at is None) == (self.marker is None):
            raise InputError("give either marker, or at (a point of the body)")
        if sum(value is not None for value in (self.force, self.mass, self.pressure, self.moment)) != 1:
            raise InputError(
                "give either force, or mass (which hangs there), or pressure (in the hole around at), or moment"
            )
        if self.moment is not None:
            self._check_moment(self.moment)
        if self.path:
            self._check_path()
        if self.drive is not None and (self.path or self.mass is not None):
            raise InputError(f"drive: not available with {'path' if self.path else 'mass'}. Remove one of them.")
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

    def _check_moment(self, moment: tuple[float, ...]) -> None:
        for index, value in enumerate(moment):
            check_number(f"moment[{index}]", value, "N m")
            if not math.isfinite(value):
                raise InputError(f"moment[{index}] must be finite, not {value:g} N m")
        if not any(moment):
            raise InputError("moment must not be 0; remove this load")

    def _check_path(self) -> None:
        if self.mass is not None:
            raise InputError("path: a hung mass is always there; give its weight as a force, or remove path")
        before = -math.inf
        for instant, share in self.path:
            check_number("path", instant, "s")
            check_number("path", share, "")
            if not math.isfinite(instant):
                raise InputError(f"path: its times must be finite, not {instant:g} s")
            if not abs(share) <= MAX_SHARE:
                raise InputError(f"path: a share must be from -{MAX_SHARE:g} to {MAX_SHARE:g}, not {share:g}")
            if not (instant >= 0 and instant > before):
                after = "" if before < 0 else f" after {before:g} s"
                raise InputError(f"path: its times must rise from 0 s; {instant:g} s comes{after or ' first'}")
            before = instant

    def share_at(self, instant: float) -> float:
        """Return the share of the load that acts at a time of a motion [s]."""
        if not self.path:
            return 1.0
        return float(np.interp(instant, [time for time, _ in self.path], [share for _, share in self.path]))

    def held_at(self, instant: float) -> "Load | None":
        """Return the load that acts at a time of a motion [s], without a path; None if none of it acts."""
        share = self.share_at(instant)
        if share == 0.0:
            return None
        if not self.path:
            return self
        return replace(
            self,
            path=(),
            force=None if self.force is None else tuple(share * part for part in self.force),
            moment=None if self.moment is None else tuple(share * part for part in self.moment),
            pressure=None if self.pressure is None else share * self.pressure,
        )

    @property
    def body_points(self) -> tuple[Point, ...]:
        """Its `at` if that is a point of the body; the point of a pressure is in a hole."""
        return () if self.at is None or self.pressure is not None else (self.at,)

    def force_under(self, gravity: tuple[float, ...] | None, dim: int) -> Vector:
        """Return the force on the body [N], (dim,): for a mass, its weight under gravity [m/s^2]."""
        if self.force is not None:
            return np.array(self.force, dtype=float)
        return (self.mass or 0.0) * (np.zeros(dim) if gravity is None else np.array(gravity))


def check_loads(loads: Sequence[Load], names: list[str], mesh: Mesh, *, weightless: bool) -> None:
    """Reject loads that do not fit a body with markers of these `names` (InputError)."""
    check_unique("load", [load.name for load in loads])
    for index, load in enumerate(loads):
        if load.marker is not None and load.marker not in names:
            raise InputError(
                f"load[{index}].marker: unknown marker {quote(load.marker)}. "
                f"{list_choices('markers', names, load.marker)}"
            )
        if load.mass is not None and weightless:
            raise InputError(f'load[{index}].mass weighs nothing without gravity; add gravity = "-y", or a force')
        _check_cavity(index, load, mesh)
        _check_axes(index, load, mesh.dim)


def _check_cavity(index: int, load: Load, mesh: Mesh) -> None:
    """Reject a pressure at a point that is in no hole of the body (InputError)."""
    if load.pressure is None or load.at is None:
        return
    if len(load.at) != mesh.dim:
        raise InputError(f"load[{index}].at has {len(load.at)} coordinates, but the body has {mesh.dim}")
    if not len(mesh.cavity(np.array(load.at))):
        raise InputError(
            f"load[{index}].at: a pressure fills a hole that the body closes, and this point is in none; move it there"
        )


def _check_axes(index: int, load: Load, dim: int) -> None:
    """Reject a force or moment with entries for another number of axes (InputError)."""
    if load.force is not None and (count := len(load.force)) != dim:
        raise InputError(f"load[{index}].force has {count} entries, but the body has {dim} axes")
    axes = 1 if dim == 2 else 3
    if load.moment is not None and (count := len(load.moment)) != axes:
        allowed = 'one in the plane: moment = "0.01 N m"' if axes == 1 else "one about each of x, y and z"
        raise InputError(f"load[{index}].moment has {count} entries; this body needs {allowed}")
