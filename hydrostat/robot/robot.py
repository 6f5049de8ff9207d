"""`Robot`: complete description of a robot, checked when it is created."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self, TypeVar

import numpy as np

from hydrostat import units
from hydrostat.arrays import Points, Vector
from hydrostat.closed_set import make_member
from hydrostat.errors import InputError
from hydrostat.given import NamedParts, Point, check_type, check_unique, list_choices
from hydrostat.painters import draw_record, html_repr
from hydrostat.robot.body import Body
from hydrostat.robot.cable import Cable, given_names, name_cables
from hydrostat.robot.cable_side import CableSide
from hydrostat.robot.checked_parts import checked_parts
from hydrostat.robot.contact import DISTANCE, Contact, Obstacle, ObstacleShape, check_obstacles
from hydrostat.robot.grading import Grading
from hydrostat.robot.gravity import check_gravity, gravity_along
from hydrostat.robot.load import Load, check_loads
from hydrostat.robot.load_drive import LoadDrive
from hydrostat.robot.marker import Marker, PoseTarget
from hydrostat.robot.material import Material
from hydrostat.robot.materials import get_material
from hydrostat.robot.pin import Pin, take_pins
from hydrostat.robot.pin_drive import PinDrive, check_drives
from hydrostat.robot.rod import Rod, check_rods_inside
from hydrostat.robot.sensor import Sensor, check_sensors
from hydrostat.robot.sheet import Membrane, check_sheets
from hydrostat.robot.winch import Mount, Winch, check_drive_limits
from hydrostat.units import plural, quote

_Part = TypeVar("_Part", Winch, Cable, Marker)


@dataclass(frozen=True, kw_only=True)
class Robot:
    """Soft robot: body, pins, winches, cables, markers and target poses.

    Attributes:
        name: name of the robot.
        body: soft body.
        pins: boundary conditions that together exclude rigid motion. Without pins the robot lies on the ground, an
            obstacle.
        drives: actuators that move pins or scale loads, in the order of every array of drive values.
        winches: winches in the order of every array of contractions.
        cables: cables in the order of every array of tensions; a cable without a name gets one.
        markers: tracked points.
        poses: target poses by name.
        length_unit: length unit of the coordinates in its file.
        gravity: acceleration along each axis of the body [m/s^2], or a direction such as "-y"; None for weightless.
        face: side of a flat body on which its cables run, or a text such as "pairs"; None if unspecified.
        motor: key of the motor of its winches, such as "sts3215"; "auto" for the weakest that fits.
        max_tension: maximum cable tension in poses [N], from a design; None for no limit.
        max_torque: maximum torque of a winch in poses [N m]; None for no limit.
        contact: self-contact and obstacle contact; None disables contact, so the body can pass through itself.
        obstacles: rigid objects next to the body.
        loads: forces at points of the body, and hung masses.
        rods: elastic rods in the body.
        sheets: elastic sheets on its skin.
        sensors: sensors in the body; they do not affect its physics.

    Raises:
        InputError: parts that do not fit together, such as a cable point outside the body.
    """

    name: str
    body: Body
    pins: tuple[Pin, ...]
    drives: tuple[PinDrive | LoadDrive, ...] = ()
    winches: tuple[Winch, ...] = ()
    cables: tuple[Cable, ...] = ()
    markers: tuple[Marker, ...] = ()
    poses: Mapping[str, PoseTarget]
    length_unit: str = "mm"
    gravity: tuple[float, ...] | None = None
    face: CableSide | None = None
    motor: str = "auto"
    max_tension: float | None = None
    max_torque: float | None = None
    contact: Contact | None = None
    obstacles: tuple[Obstacle, ...] = ()
    loads: tuple[Load, ...] = ()
    rods: tuple[Rod, ...] = ()
    sheets: tuple[Membrane, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    MAX_RADIUS_RATIO = 4.0  # the spools of cables on one shaft differ by at most so many times

    def __post_init__(self) -> None:
        self._check_kinds()
        if not self.name:
            raise InputError("name must not be empty")
        try:
            units.unit_factor(self.length_unit, units.LENGTH)
        except InputError as error:
            raise InputError(f"length_unit: {error}") from None
        object.__setattr__(self, "cables", name_cables(self.cables))
        for kind in ("winch", "cable", "marker", "obstacle", "rod", "sheet", "sensor"):
            check_unique(kind, [part.name for part in getattr(self, "winches" if kind == "winch" else f"{kind}s")])
        for index, (name, pose) in enumerate(self.poses.items()):
            if name != pose.name:
                raise InputError(f'pose[{index}].name: a pose called "{pose.name}" is filed under "{name}"')
        self._check_dimensions()
        self._check_face()
        if isinstance(self.gravity, str):
            object.__setattr__(self, "gravity", gravity_along(self.gravity, self.body.mesh.dim))
        if self.gravity is not None:
            check_gravity(self.gravity, self.body.mesh.dim)
        self._take_pins()
        check_drives(self.drives, (self.pins, self.loads), self.winches, self.cables, self.body.mesh.dim)
        check_obstacles(self.obstacles, self.body.mesh, self.contact_distance)
        self._check_markers_and_poses()
        self._check_inner_parts()
        self._check_cables()

    def winch(self, name: str) -> Winch:
        """Return the winch of this name (InputError: there is none)."""
        return _find_part("winch", "winches", self.winches, name)

    def marker(self, name: str) -> Marker:
        """Return the marker of this name (InputError: there is none)."""
        return _find_part("marker", "markers", self.markers, name)

    def cable(self, name: str) -> Cable:
        """Return the cable of this name (InputError: there is none)."""
        return _find_part("cable", "cables", self.cables, name)

    @property
    def given_cable_names(self) -> tuple[str, ...]:
        """Name of each cable, or "" if the robot named it."""
        return given_names(self.cables)

    def pose(self, name: str) -> PoseTarget:
        """Return the target pose of this name (InputError: there is none)."""
        return self.poses[name]

    @property
    def contact_distance(self) -> float:
        """Distance at which contact forces between parts, and with obstacles, start [m]."""
        given = None if self.contact is None else self.contact.distance
        return DISTANCE * self.body.mesh.size if given is None else given

    def friction_of(self, obstacle: Obstacle) -> float:
        """Return the Coulomb friction coefficient between the body and an obstacle."""
        if obstacle.friction is not None:
            return obstacle.friction
        return 0.0 if self.contact is None else self.contact.friction

    @property
    def spool_ratios(self) -> Vector:
        """Length that each cable takes in when its winch takes in 1 m [m], from the spool radii, (cables,).

        Negative for cables that are wound in the opposite direction.
        """
        radii = {winch.name: winch.spool_radius for winch in self.winches}
        own = [
            (-1 if cable.reverse else 1) * (cable.spool_radius or radii[cable.winch]) / radii[cable.winch]
            for cable in self.cables
        ]
        return np.array(own, dtype=float)

    def largest_spool(self, winch: Winch) -> float:
        """Return the radius of the largest step on the shaft of a winch [m]."""
        return max(
            [winch.spool_radius, *(cable.spool_radius or 0 for cable in self.cables if cable.winch == winch.name)]
        )

    @property
    def num_controls(self) -> int:
        """Number of winches and drives."""
        return len(self.winches) + len(self.drives)

    @property
    def control_limits(self) -> tuple[Vector, Vector]:
        """Least and largest contraction of each winch [m], then value of each drive [rad, m or share]."""
        ranges = [(-winch.release, winch.travel) for winch in self.winches] + [drive.limits for drive in self.drives]
        low, high = np.array(ranges, dtype=float).reshape(-1, 2).T
        return low, high

    def with_network(self, winches: Iterable[Winch], cables: Iterable[Cable]) -> Self:
        """Return the robot with other winches and cables; body parts for the units of removed winches are removed."""
        kept = tuple(winches)
        staying = {"", *(winch.name for winch in kept if winch.body)}
        parts = tuple(part for part in self.body.parts if part.winch in staying)
        body = self.body if len(parts) == len(self.body.parts) else self.body.with_parts(parts)
        return replace(self, body=body, winches=kept, cables=tuple(cables))

    def with_material(self, material: Material | str | None = None, **changed: float) -> Self:
        """Return the robot with another material on the same mesh.

        Args:
            material: a `Material`, or a name in the material table; that of the robot if left out.
            changed: values to change, such as `young=50e3`.

        Raises:
            InputError: an unknown material, an unknown value, or a value out of range.
        """
        known = get_material(material) if isinstance(material, str) else material or self.body.material
        if not isinstance(known, Material):
            raise InputError(f"material must be a Material or a name of the table, not {material!r:.60}")
        numbers = ("young", "poisson", "density", "viscosity")
        for name in (each for each in changed if each not in numbers):
            raise InputError(f'unknown material value "{name}". Allowed: {", ".join(numbers)}.')
        if changed:
            interval = {"young_interval": None} if "young" in changed else {}
            known = replace(known, **changed, **interval, name="", source="", note="")
        return replace(self, body=replace(self.body, material=known))

    def with_grading(self, factor: Callable[[Points], Vector] | None) -> Self:
        """Return the robot with Young's modulus multiplied by a function of rest positions [m], (points, dim).

        The function is evaluated at the center of each element and may return one value for all; None for no grading.
        Raises InputError: a value that is not above 0.
        """
        mesh = self.body.with_elements("linear").mesh
        grading = None if factor is None else Grading.from_function(factor, mesh.nodes[mesh.elements].mean(axis=1))
        return replace(self, body=replace(self.body, grading=grading))

    def __repr__(self) -> str:
        """Return a one-line summary."""
        mesh = self.body.mesh
        parts = f"{plural(len(self.winches), 'winch')}, {plural(len(self.cables), 'cable')}"
        return (
            f"<Robot {self.name!r}: {1e3 * mesh.size:.0f} mm, {plural(len(mesh.nodes), 'node')}, {parts}, "
            f"markers: {', '.join(marker.name for marker in self.markers) or 'none'}, "
            f"poses: {', '.join(self.poses) or 'none'}>"
        )

    def _repr_html_(self) -> str:
        """Robot at rest, for a notebook."""
        return html_repr(repr(self), draw_record("rest", self))

    def _check_kinds(self) -> None:
        """Reject parts of a wrong type."""
        check_type(self.body, Body, "body must be a Body, as that of another robot")
        for what, kind in _PARTS.items():
            check_type(getattr(self, what), (tuple, list), f"{what} must be several, such as () for none")
            for part in getattr(self, what):
                check_type(part, kind, f"{what} must be {getattr(kind, '__name__', 'drive')} records")
        check_drive_limits(self.motor, self.max_tension, self.max_torque)
        check_type(self.poses, Mapping, "poses must be given by name")
        for pose in self.poses.values():
            check_type(pose, PoseTarget, "poses must be Pose records")
        if not isinstance(self.poses, NamedParts):
            object.__setattr__(self, "poses", NamedParts("pose", self.poses))
        check_type(self.contact, (Contact, type(None)), "contact must be a Contact()")
        check_type(self.gravity, (tuple, list, np.ndarray, str, type(None)), "gravity must be m/s^2 along each axis")

    def _check_dimensions(self) -> None:
        dim = self.body.mesh.dim
        for key, point in self._points():
            if len(point) != dim:
                raise InputError(f"{key} has {len(point)} coordinates, but the body has {dim}")

    def _check_face(self) -> None:
        if self.face is None:
            return
        make_member(self, "face", CableSide)
        if self.body.mesh.dim == 3:
            raise InputError("face is only for flat bodies: in space, cables run where their points are; remove it")

    def _points(self) -> Iterable[tuple[str, Point]]:
        for index, pin in enumerate(self.pins):
            yield from ((f"pin[{index}]", point) for point in ((pin.at,) if pin.at is not None else pin.box or ()))
        for index, winch in enumerate(self.winches):
            yield f"winch[{index}].at", winch.at
        for index, cable in enumerate(self.cables):
            yield from ((f"cable[{index}].points[{place}]", point) for place, point in enumerate(cable.points))
        for index, marker in enumerate(self.markers):
            yield f"marker[{index}].at", marker.at
        for index, rod in enumerate(self.rods):
            yield from ((f"rod[{index}].points[{place}]", point) for place, point in enumerate(rod.points))
        for index, load in enumerate(self.loads):
            yield from ((f"load[{index}].at", point) for point in load.body_points)
        for index, sensor in enumerate(self.sensors):
            yield from ((f"sensor[{index}].{key}", point) for key, point in sensor.places)
        for index, pose in enumerate(self.poses.values()):
            yield from ((f"pose[{index}].targets.{name}", point) for name, point in pose.targets.items())

    def _take_pins(self) -> None:
        checked = checked_parts(self.body)
        if self.pins:
            if checked.get("pins") is not self.pins:
                object.__setattr__(self, "pins", take_pins(self.pins, self.body))
                checked["pins"] = self.pins
        elif not any(map(self._carries, self.obstacles)):
            raise InputError(
                "no [[pin]]: the body is unconstrained. Add a pin with at and radius, or gravity and a ground plane "
                "([[obstacle]] with shape = plane)."
            )

    def _carries(self, obstacle: Obstacle) -> bool:
        """Return True if an obstacle is ground on which the robot's weight rests."""
        ground = self.gravity is not None and obstacle.shape is ObstacleShape.PLANE
        return ground and float(np.dot(obstacle.normal or (), self.gravity or ())) < 0

    def _check_markers_and_poses(self) -> None:
        names = [marker.name for marker in self.markers]
        if checked_parts(self.body).get("markers") is not self.markers:
            self._check_inside([(f'marker[{i}].at ("{each.name}")', each.at) for i, each in enumerate(self.markers)])
            checked_parts(self.body)["markers"] = self.markers
        for index, pose in enumerate(self.poses.values()):
            for name in pose.targets:
                if name not in names:
                    key = f"pose[{index}].targets.{name}"
                    raise InputError(f"{key}: unknown marker {quote(name)}. {list_choices('markers', names, name)}")

    def _check_inner_parts(self) -> None:
        mesh, names = self.body.mesh, [marker.name for marker in self.markers]
        check_loads(self.loads, names, mesh, weightless=self.gravity is None)
        check_sheets(self.sheets, mesh)
        controls = [*(f"{winch.name}_mm" for winch in self.winches), *(drive.column[0] for drive in self.drives)]
        places = [part.name for part in (*self.markers, *self.obstacles)]
        tensions = (f"cable_{number}_N" for number in range(1, 1 + len(self.cables)))
        check_sensors(self.sensors, mesh, [*controls, *tensions], places)
        self._check_inside([(key, point) for key, point in self._points() if key.startswith(("load", "rod", "sensor"))])
        check_rods_inside(self.rods, self.body, self._text)

    def load_points(self) -> Points:
        """Point of the body at rest that carries each load [m], (loads, dim)."""
        markers = {marker.name: marker.at for marker in self.markers}
        points = [markers[load.marker] if load.marker is not None else load.at for load in self.loads]
        return np.array(points, dtype=float).reshape(-1, self.body.mesh.dim)

    def load_forces(self) -> Points:
        """Force of each load [N], (loads, dim); 0 for a pressure or a moment."""
        dim = self.body.mesh.dim
        return np.array([load.force_under(self.gravity, dim) for load in self.loads]).reshape(-1, dim)

    def _check_cables(self) -> None:
        named = [(f"winch[{i}].at", each.at) for i, each in enumerate(self.winches) if each.mount is Mount.BODY]
        for index, cable in enumerate(self.cables):
            try:
                winch = self.winch(cable.winch)
            except InputError as error:
                raise InputError(f"cable[{index}].winch: {error}") from None
            self._check_spool(index, cable, winch)
            gap = float(np.linalg.norm(np.subtract(cable.points[0], winch.at)))
            if gap > (0.0 if winch.mount is Mount.WORLD else 2 * max(winch.spool_radius, cable.spool_radius or 0.0)):
                raise InputError(
                    f"cable[{index}].points[0]: a cable begins at its winch, "
                    f'but this is {self._text(gap)} from winch "{winch.name}" at {self._text(winch.at)}'
                )
            first = 1 if winch.mount is Mount.WORLD else 0
            named += [
                (f"cable[{index}].points[{place}]", cable.points[place]) for place in range(first, len(cable.points))
            ]
        self._check_inside(named)

    def _check_spool(self, index: int, cable: Cable, winch: Winch) -> None:
        radius, usual = cable.spool_radius or winch.spool_radius, winch.spool_radius
        if max(radius, usual) > (1 + 1e-9) * self.MAX_RADIUS_RATIO * min(radius, usual):
            raise InputError(
                f"cable[{index}].spool_radius must be from {self._text(usual / self.MAX_RADIUS_RATIO)} to "
                f"{self._text(usual * self.MAX_RADIUS_RATIO)}, at most {self.MAX_RADIUS_RATIO:g} times smaller or "
                f'larger than that of winch "{winch.name}", not {self._text(radius)}'
            )

    def _check_inside(self, named: Sequence[tuple[str, Point]]) -> None:
        """Reject points outside the body; one search for all points is far quicker than one for each."""
        distances = self.body.distances(np.array([point for _, point in named])) if named else ()
        for (key, point), distance in zip(named, distances, strict=True):
            if distance > 0:
                out = f"lies {self._text(float(distance))} outside the body"
                raise InputError(f"{key} = {self._text(point)} {out}; move it inside")

    def _text(self, value: Point | float) -> str:
        """Point or length in the unit of the file, to four digits."""
        scale = float(units.unit_factor(self.length_unit, units.LENGTH))
        if isinstance(value, tuple):
            return "[" + ", ".join(f"{coordinate / scale:.4g}" for coordinate in value) + "]"
        return f"{value / scale:.4g} {self.length_unit}"


def _find_part(kind: str, kinds: str, parts: Iterable[_Part], name: str) -> _Part:
    for part in parts:
        if part.name == name:
            return part
    raise InputError(f'unknown {kind} "{name}". {list_choices(kinds, [part.name for part in parts], name)}')


_PARTS = {
    "pins": Pin,
    "drives": (PinDrive, LoadDrive),
    "winches": Winch,
    "cables": Cable,
    "markers": Marker,
    "obstacles": Obstacle,
    "loads": Load,
    "rods": Rod,
    "sheets": Membrane,
    "sensors": Sensor,
}
