"""`Sensor`: a sensor in or on a body, such as a flex sensor, a string potentiometer or an inertial one."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from hydrostat import units
from hydrostat.closed_set import make_member
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.given import Point, check_name, check_not_negative, check_point, check_positive
from hydrostat.robot.pin_drive import PinDrive, format_angle


class SensorKind(StrEnum):
    """Quantity that a sensor reads."""

    BEND = "bend"  # turn along a path [rad]
    STRAIN = "strain"  # change of length along a path, as a share of it
    LENGTH = "length"  # length of a passive string through its points [m]
    PRESSURE = "pressure"  # mean contact pressure on a face of the skin [Pa]
    ORIENTATION = "orientation"  # turn of the material since rest: angle, or rotation vector in space [rad]
    GYROSCOPE = "gyroscope"  # angular velocity, in axes that turn with the material [rad/s]
    ACCELEROMETER = "accelerometer"  # acceleration less gravity, in axes that turn with the material [m/s^2]


_PATHS = (SensorKind.BEND, SensorKind.STRAIN, SensorKind.LENGTH)
_UNITS = {
    SensorKind.BEND: units.ANGLE,
    SensorKind.LENGTH: units.LENGTH,
    SensorKind.PRESSURE: units.PRESSURE,
    SensorKind.ORIENTATION: units.ANGLE,
    SensorKind.ACCELEROMETER: units.ACCELERATION,
}
_COLUMNS = {
    SensorKind.BEND: ("deg", math.degrees(1.0)),
    SensorKind.STRAIN: ("", 1.0),
    SensorKind.LENGTH: ("mm", 1e3),
    SensorKind.PRESSURE: ("kPa", 1e-3),
    SensorKind.ORIENTATION: ("deg", math.degrees(1.0)),
    SensorKind.GYROSCOPE: ("deg/s", math.degrees(1.0)),
    SensorKind.ACCELEROMETER: ("m/s^2", 1.0),
}


@dataclass(frozen=True, kw_only=True)
class Sensor:
    """Sensor that moves with the body and has neither stiffness nor mass.

    Attributes:
        name: name, unique in the robot.
        kind: measured quantity.
        points: corners of its path at rest [m], for a bend, strain or string sensor; empty for others.
        at: position at rest [m], for other sensors.
        normal: direction across a bend sensor in space; bending towards it raises the reading. None for others. In the
            plane the reading rises as the path turns from x to y.
        radius: radius around `at` of the surface that a pressure sensor covers [m]; None for others.
        noise: standard deviation of its readings, in their unit.

    Raises:
        InputError: a missing key, a key that its kind does not have, or a value out of range.
    """

    name: str
    kind: SensorKind
    points: tuple[Point, ...] = ()
    at: Point | None = None
    normal: tuple[float, ...] | None = None
    radius: float | None = None
    noise: float = 0.0

    def __post_init__(self) -> None:
        check_name(self.name)
        make_member(self, "kind", SensorKind)
        kind, along = self.kind, self.kind in _PATHS
        if along != bool(self.points) or along == (self.at is not None):
            raise InputError(
                f"a {kind} sensor needs {'points (its path)' if along else 'at (its place)'}, and no other"
            )
        if along and len(self.points) < 2:
            raise InputError("points: a sensor along a path needs at least two")
        for index, point in enumerate(self.points):
            check_point(f"points[{index}]", point)
            if index and point == self.points[index - 1]:
                raise InputError(f"points[{index}] is the one before it; remove it")
        if self.at is not None:
            check_point("at", self.at)
        if (self.radius is not None) != (kind is SensorKind.PRESSURE):
            raise InputError("radius is that of the face of a pressure sensor, which needs it, and of no other")
        if self.radius is not None:
            check_positive("radius", self.radius, "m")
        bends_in_space = kind is SensorKind.BEND and len(self.points[0]) == 3
        if (self.normal is not None) != bends_in_space:
            raise InputError("normal is the direction across a bend sensor in space, which needs it; no other has one")
        if self.normal is not None:
            check_point("normal", self.normal)
            if len(self.normal) != 3 or not any(self.normal):
                raise InputError("normal must be a direction in space, such as [0, 0, 1]")
        check_not_negative("noise", self.noise, self.column[0])

    @property
    def column(self) -> tuple[str, float]:
        """Unit of its readings in tables and texts, and the factor from SI."""
        return _COLUMNS[self.kind]

    @property
    def places(self) -> tuple[tuple[str, Point], ...]:
        """Points in the body, with their keys."""
        keyed = tuple((f"points[{index}]", point) for index, point in enumerate(self.points))
        return keyed if self.at is None else (("at", self.at),)

    def count_values(self, dim: int) -> int:
        """Return the number of values in a reading for a body of `dim` dimensions."""
        if self.kind is SensorKind.ACCELEROMETER:
            return dim
        return 3 if dim == 3 and self.kind in (SensorKind.ORIENTATION, SensorKind.GYROSCOPE) else 1

    def heads(self, dim: int) -> list[str]:
        """Return the name of each value in a reading, such as "imu_x"."""
        count = self.count_values(dim)
        return [self.name] if count == 1 else [f"{self.name}_{axis}" for axis in "xyz"[:count]]

    def columns(self, dim: int) -> list[str]:
        """Return the table header of each value with its unit, such as "imu_x_deg"."""
        unit = self.column[0].replace("/", "_").replace("^", "")
        return [f"{head}_{unit}" if unit else head for head in self.heads(dim)]

    def with_transform(self, move: Callable[[Point], Point], scale: Callable[[float], float]) -> "Sensor":
        """Return the sensor moved, with its lengths [m] scaled."""
        noise = scale(self.noise) if self.kind is SensorKind.LENGTH else self.noise
        return replace(
            self,
            points=tuple(map(move, self.points)),
            at=None if self.at is None else move(self.at),
            radius=None if self.radius is None else scale(self.radius),
            noise=noise,
        )

    def face(self, mesh: Mesh) -> np.ndarray:
        """Return the boundary facets of a pressure sensor, (facets, dim), whose centers are within its radius."""
        middles = mesh.nodes[mesh.boundary].mean(axis=1)
        return mesh.boundary[np.linalg.norm(middles - np.array(self.at), axis=1) <= (self.radius or 0.0)]

    @staticmethod
    def parse_noise(kind: SensorKind, given: object) -> float:
        """Return the noise in SI from a value in robot.toml (InputError: no unit, or a wrong one)."""
        if kind is SensorKind.STRAIN:
            if isinstance(given, str):
                raise InputError(f"noise of a strain is a number, such as 0.01, not {units.quote(given)}")
            return float(given)  # type: ignore[arg-type]
        if kind is SensorKind.GYROSCOPE:
            if not (isinstance(given, str) and given.rstrip().endswith("/s")):
                raise InputError(f'noise of a gyroscope is an angular velocity, such as "1 deg/s", not {given!s:.60}')
            return PinDrive.parse_value(given.rstrip().removesuffix("/s"), turns=True)
        value = units.parse_quantity(given, _UNITS[kind])
        return math.radians(value) if _UNITS[kind] is units.ANGLE else value

    def noise_value(self) -> str | float:
        """Noise in the format of robot.toml, for `parse_noise`."""
        if self.kind is SensorKind.STRAIN:
            return self.noise
        if self.kind is SensorKind.GYROSCOPE:
            return format_angle(self.noise) + "/s"
        unit = _UNITS[self.kind]
        return format_angle(self.noise) if unit is units.ANGLE else units.format_quantity(self.noise, unit)


def check_sensors(sensors: tuple[Sensor, ...], mesh: Mesh, columns: list[str], places: list[str]) -> None:
    """Reject sensors of another dimension, on no facet of the skin, or whose names clash in tables (InputError).

    `columns` and those of positions of `places` are the others of motion.csv.
    """
    taken = dict.fromkeys(["time_s", "kinetic_J", "potential_J", *columns], "the motion")
    taken |= {f"{name}_{axis}_mm": f"the position of {name}" for name in places for axis in "xyz"[: mesh.dim]}
    for index, sensor in enumerate(sensors):
        for key, point in sensor.places:
            if len(point) != mesh.dim:
                raise InputError(f"sensor[{index}].{key} has {len(point)} coordinates, but the body has {mesh.dim}")
        if sensor.kind is SensorKind.PRESSURE and not len(sensor.face(mesh)):
            raise InputError(
                f"sensor[{index}]: no face of the skin lies within its radius; move at to the skin or widen it"
            )
        for head in {*sensor.heads(mesh.dim), *sensor.columns(mesh.dim)}:
            if head in taken:
                raise InputError(
                    f'sensor[{index}].name: column "{head}" is that of {taken[head]} too. Rename the sensor.'
                )
        taken |= dict.fromkeys({*sensor.heads(mesh.dim), *sensor.columns(mesh.dim)}, f"sensor {sensor.name}")
