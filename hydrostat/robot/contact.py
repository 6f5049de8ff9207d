"""`Contact` and `Obstacle`: contact of a body with itself and with objects next to it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.errors import InputError
from hydrostat.geometry import DistanceField, Mesh, Shell, Surface, locate, read_surface
from hydrostat.given import Point, check_name, check_number, check_point, check_positive


@dataclass(frozen=True)
class ClosedMesh:
    """Closed surface in space and the file that it came from.

    Attributes:
        file: name of the file.
        content: bytes of the file.
        surface: surface as read; objects with equal files are equal.
    """

    file: str
    content: bytes = field(repr=False)
    surface: Surface = field(repr=False, compare=False)

    @cached_property
    def shell(self) -> Shell:
        """Surface for distance queries."""
        return Shell(self.surface.vertices, self.surface.triangles)

    def with_transform(self, turn: Points, shift: Vector) -> "ClosedMesh":
        """Return the same object with every point x at turn x + shift [m]."""
        surface = Surface(self.surface.vertices @ turn.T + shift, self.surface.triangles)
        return replace(self, surface=surface)

    def masses(self) -> tuple[float, Vector, Points]:
        """Volume [m^3], center [m], and mean products of the coordinates of the interior about its center [m^2]."""
        middle = self.surface.box.mean(axis=0)
        corners = self.surface.vertices[self.surface.triangles] - middle
        volumes = np.linalg.det(corners) / 6
        sums = corners.sum(axis=1)
        volume = float(volumes.sum())
        center = volumes @ sums / (4 * volume)
        products = np.einsum("t,tci,tcj->ij", volumes, corners, corners) + np.einsum("t,ti,tj->ij", volumes, sums, sums)
        return volume, middle + center, products / (20 * volume) - np.outer(center, center)


def closed_mesh(content: bytes, file: str, *, unit: float = 1e-3) -> ClosedMesh:
    """Read an object from a surface file whose coordinates are in `unit` meters.

    Raises:
        InputError: no surface, an open one, one that is inside out or runs through itself, or too many triangles.
    """
    from hydrostat.geometry import crossing_pairs  # only here: a robot without one starts sooner

    surface = read_surface(content, name=file, unit=unit)
    most_triangles = 20_000  # No obstacle may have more
    if len(surface.triangles) > most_triangles:
        count = len(surface.triangles)
        raise InputError(f"{file}: has {count} triangles, an obstacle at most {most_triangles}; simplify the surface")
    merged, numbers = np.unique(surface.vertices, axis=0, return_inverse=True)
    triangles = numbers.reshape(-1)[surface.triangles]
    whole = Surface(merged, triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)])
    if not Shell(whole.vertices, whole.triangles).is_closed:
        raise InputError(f"{file}: is not closed, or its triangles do not all turn the same way; repair it first")
    if whole.volume <= 0:
        raise InputError(f"{file}: is inside out; turn its triangles round")
    crossing = crossing_pairs(whole)
    if len(crossing):
        spot = ", ".join(f"{1e3 * x:.1f}" for x in whole.vertices[whole.triangles[crossing[0, 0]]].mean(axis=0))
        raise InputError(f"{file}: runs through itself, for instance at ({spot}) mm; repair it first")
    return ClosedMesh(file=file, content=content, surface=whole)


DISTANCE = 0.005
"""Parts begin to feel one another at this share of the size of the body, where nothing else is said."""


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Self-contact and obstacle contact by a barrier potential.

    Attributes:
        distance: distance at which contact forces start [m]; None: 1/200 of the size of the body.
        friction: Coulomb friction coefficient between parts of the body, and between it and obstacles that state none.

    Raises:
        InputError: a distance or a friction coefficient out of range.
    """

    distance: float | None = None
    friction: float = 0.0

    def __post_init__(self) -> None:
        if self.distance is not None:
            check_positive("distance", self.distance, "m")
        check_friction(self.friction)


def check_friction(friction: float) -> None:
    """Check a coefficient of friction (InputError: it is not from 0 to 3)."""
    check_number("friction", friction, "")
    most_friction = 3.0  # No coefficient of friction is larger
    if not 0 <= friction <= most_friction:
        raise InputError(f"friction must be from 0 to {most_friction:g}, not {friction:g}: rubber has about 1")


class ObstacleShape(StrEnum):
    """Shape of an obstacle."""

    PLANE = "plane"  # all behind `at`, against `normal`
    SPHERE = "sphere"  # about `at`; a disc in the plane
    CAPSULE = "capsule"  # all within `radius` of the way from `at` to `to`
    CYLINDER = "cylinder"  # the same with flat ends; in space only
    BOX = "box"  # with `at` and `to` as opposite corners
    MESH = "mesh"  # what a closed surface from a file encloses, moved by `at`; in space only


@dataclass(frozen=True, kw_only=True)
class Obstacle:
    """Rigid object next to the body: static, free to move if it has a mass, or moving along a path in time.

    Attributes:
        name: name of the obstacle.
        shape: shape of the obstacle.
        at: point of a plane, center of a sphere, one end of a capsule or cylinder, one corner of a box [m].
        to: other end or corner [m]; only for shapes that have one.
        radius: radius of a sphere, capsule or cylinder [m].
        normal: outward normal of a plane, of any length.
        friction: Coulomb friction coefficient; None: that of the body's contact.
        mesh: closed surface, moved by `at`.
        mass: mass of an object that moves under forces [kg], evenly distributed; None: it is static.
        path: keyframes: times [s] and the position of `at` then [m]. The motion starts at `at`, is linear between
            keyframes without rotation, and ends at the last one. Only dynamics uses the path; in statics the obstacle
            does not move.

    Raises:
        InputError: a missing key, a key that its shape does not have, or a wrong value.
    """

    name: str
    shape: ObstacleShape | str
    at: Point
    to: Point | None = None
    radius: float | None = None
    normal: Point | None = None
    friction: float | None = None
    mass: float | None = None
    path: tuple[tuple[float, Point], ...] = ()
    mesh: ClosedMesh | None = None

    def __post_init__(self) -> None:
        check_name(self.name)
        kinds = [str(shape) for shape in ObstacleShape]
        if self.shape not in kinds:
            raise InputError(f'unknown shape "{self.shape}". Allowed: {", ".join(kinds)}.')
        object.__setattr__(self, "shape", ObstacleShape(self.shape))
        needed = _NEEDED[ObstacleShape(self.shape)]
        for key in ("to", "radius", "normal", "mesh"):
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
        self._check_motion()
        if self.normal is not None and not any(self.normal):
            raise InputError("normal must not be 0 along every axis")
        if self.to is not None and (
            self.at == self.to or (self.shape is ObstacleShape.BOX and 0 in np.subtract(self.at, self.to))
        ):
            raise InputError("at and to leave nothing between them; move one of them")
        if self.shape in (ObstacleShape.CYLINDER, ObstacleShape.MESH) and len(self.at) == 2:
            raise InputError(f"a flat body meets no {self.shape}; use a sphere, which is a disc in the plane, or a box")

    def _check_motion(self) -> None:
        if self.friction is not None:
            check_friction(self.friction)
        if self.mass is not None:
            check_positive("mass", self.mass, "kg")
            if self.shape is ObstacleShape.PLANE:
                raise InputError("a plane has no end, so no mass; remove mass, and it stands still")
            if self.path:
                raise InputError("an object with a mass goes where it is pushed, not along a path; remove mass or path")
        before = 0.0
        for instant, place in self.path:
            if not before < instant < np.inf:
                raise InputError(f"path: its times must rise from above 0 s; {instant:g} s comes after {before:g} s")
            check_point("path", place)
            if len(place) != len(self.at):
                raise InputError(f"path: a place has {len(place)} entries, at has {len(self.at)}; give as many")
            before = instant

    def spine(self) -> Points:
        """Points inside the obstacle [m], (points, dim): along the line from `at` to `to`; none for a plane."""
        at = np.array(self.at)
        if self.shape == ObstacleShape.PLANE:
            return np.zeros((0, len(at)))
        spine = 41  # Points along an obstacle that are looked for in the body
        if self.mesh is not None:
            corners = self.mesh.surface.vertices
            return at + corners[:: max(1, len(corners) // spine)]
        return at + np.linspace(0, 1, spine)[:, None] * ((self.to or self.at) - at)

    def field(self) -> DistanceField:
        """Distance field of the obstacle."""
        return _FIELDS[ObstacleShape(self.shape)](self)

    def shift(self, instant: float) -> Vector:
        """Return the displacement along its path at a time of a motion [m]."""
        times = [0.0, *(time for time, _ in self.path)]
        places = np.array([self.at, *(place for _, place in self.path)])
        return np.array([np.interp(instant, times, column) for column in places.T]) - self.at

    def frame(self) -> tuple[Vector, Points]:
        """Center [m] and axes, one row each; the first is the longitudinal axis of a long obstacle."""
        at, dim = np.array(self.at), len(self.at)
        if self.mesh is not None:
            _, middle, products = self.mesh.masses()
            axes = np.linalg.eigh(products)[1].T[::-1]
            return at + middle, axes * np.sign(np.linalg.det(axes))
        if self.to is None:
            return at, np.eye(dim)
        span = np.array(self.to) - at
        if self.shape is ObstacleShape.BOX:
            return at + 0.5 * span, np.eye(dim)
        axes = np.linalg.svd(span[None])[2]
        axes[0] = span / np.linalg.norm(span)
        return at + 0.5 * span, axes

    def to_own_frame(self) -> "Obstacle":
        """Return the same obstacle in its own frame."""
        place, axes = self.frame()
        at, to = (
            None if end is None else tuple((axes @ (np.array(end) - place)).tolist()) for end in (self.at, self.to)
        )
        if self.mesh is not None:
            shift = axes @ (np.array(self.at) - place)
            return replace(self, at=(0.0,) * len(self.at), mesh=self.mesh.with_transform(axes, shift))
        return replace(self, at=at or (), to=to)

    def with_frame(self, place: Vector, axes: Points) -> "Obstacle":
        """Return the same obstacle with its center at a position [m] and these axes; a box stays axis-aligned."""
        middle, before = self.frame()
        turn = np.eye(len(self.at)) if self.shape is ObstacleShape.BOX else axes.T @ before
        if self.mesh is not None:
            shift = np.array(self.at)
            mesh = self.mesh.with_transform(turn, turn @ (shift - middle) + place)
            return replace(self, at=(0.0,) * len(self.at), mesh=mesh)
        at, to = (
            None if end is None else tuple((place + turn @ (np.array(end) - middle)).tolist())
            for end in (self.at, self.to)
        )
        return replace(self, at=at or (), to=to)

    def second_moments(self) -> Vector:
        """Mean squares of the coordinates of its mass along its axes [m^2]."""
        return _MOMENTS[ObstacleShape(self.shape)](self)


_NEEDED = {
    ObstacleShape.PLANE: ("normal",),
    ObstacleShape.SPHERE: ("radius",),
    ObstacleShape.CAPSULE: ("to", "radius"),
    ObstacleShape.CYLINDER: ("to", "radius"),
    ObstacleShape.BOX: ("to",),
    ObstacleShape.MESH: ("mesh",),
}
_FIELDS: dict[ObstacleShape, Callable[[Obstacle], DistanceField]] = {
    ObstacleShape.PLANE: lambda one: DistanceField.plane(np.array(one.at), np.array(one.normal)),
    ObstacleShape.SPHERE: lambda one: DistanceField.sphere(np.array(one.at), one.radius or 0.0),
    ObstacleShape.CAPSULE: lambda one: DistanceField.capsule(np.array(one.at), np.array(one.to), one.radius or 0.0),
    ObstacleShape.CYLINDER: lambda one: DistanceField.cylinder(np.array(one.at), np.array(one.to), one.radius or 0.0),
    ObstacleShape.BOX: lambda one: DistanceField.box(np.array(one.at), np.array(one.to)),
    ObstacleShape.MESH: lambda one: _mesh_at(one).shell.field(),
}


def _mesh_at(one: Obstacle) -> ClosedMesh:
    assert one.mesh is not None
    return one.mesh.with_transform(np.eye(3), np.array(one.at))


def _mesh_moments(one: Obstacle) -> Vector:
    assert one.mesh is not None
    return np.linalg.eigvalsh(one.mesh.masses()[2])[::-1]


def _box_moments(box: Obstacle) -> Vector:
    return np.subtract(box.to or (), box.at) ** 2 / 12


def _round_moments(sphere: Obstacle) -> Vector:
    dim = len(sphere.at)
    return np.full(dim, (sphere.radius or 0.0) ** 2 / (dim + 2))


def _rod_moments(rod: Obstacle) -> Vector:
    """Second moments per mass of a cylinder or a capsule: its straight part and its two round ends [m^2]."""
    dim, r, h = len(rod.at), rod.radius or 0.0, float(np.linalg.norm(np.subtract(rod.to or (), rod.at)))
    straight = np.array([h**2 / 12, *([r**2 / 3] if dim == 2 else [r**2 / 4] * 2)])
    if rod.shape is ObstacleShape.CYLINDER:
        return straight
    out = 4 * r / (3 * np.pi) if dim == 2 else 3 * r / 8  # middle of a half disc, of half a ball
    ends = np.full(dim, r**2 / (dim + 2))
    ends[0] += h**2 / 4 + h * out
    middle = 2 * h if dim == 2 else np.pi * h  # times r^(dim - 1), as the next
    round_ = np.pi * r if dim == 2 else 4 / 3 * np.pi * r
    return (middle * straight + round_ * ends) / (middle + round_)


_MOMENTS: dict[ObstacleShape, Callable[[Obstacle], Vector]] = {
    ObstacleShape.SPHERE: _round_moments,
    ObstacleShape.CAPSULE: _rod_moments,
    ObstacleShape.CYLINDER: _rod_moments,
    ObstacleShape.BOX: _box_moments,
    ObstacleShape.MESH: _mesh_moments,
}


def edge_points(mesh: Mesh, count: int) -> Points:
    """Points inside each edge of the boundary [m], evenly spaced; with a count of 1 its middle, where obstacles act."""
    ends = mesh.boundary
    if mesh.dim == 3:  # two triangles share an edge
        ends = np.unique(np.sort(ends[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    one, two = mesh.nodes[ends[:, 0]], mesh.nodes[ends[:, 1]]
    return np.concatenate([(1 - share) * one + share * two for share in np.arange(1, count + 1) / (count + 1)])


def check_obstacles(obstacles: Iterable[Obstacle], mesh: Mesh, distance: float) -> None:
    """Reject obstacles that do not fit a body or stand in it, and a large distance of contact [m] (InputError)."""
    if distance > 0.1 * mesh.size:
        raise InputError(
            f"contact.distance of {1e3 * distance:.4g} mm is large beside a body of {1e3 * mesh.size:.4g} mm; "
            f"it is usually {DISTANCE:.1%} of that"
        )
    skin = np.concatenate([mesh.nodes[np.unique(mesh.boundary)], edge_points(mesh, 1)])
    for index, obstacle in enumerate(obstacles):
        if len(obstacle.at) != mesh.dim:
            raise InputError(f"obstacle[{index}].at has {len(obstacle.at)} entries, but the body has {mesh.dim} axes")
        gaps = obstacle.field()(skin).values
        if locate(mesh, obstacle.spine()).inside.any():
            raise InputError(f'obstacle[{index}]: "{obstacle.name}" stands in the body at rest; move it out')
        if not gaps.min() > 0:
            place = ", ".join(f"{1e3 * value:.4g}" for value in skin[int(np.argmin(gaps))])
            raise InputError(
                f'obstacle[{index}]: the body at rest stands in "{obstacle.name}", {-1e3 * gaps.min():.3g} mm '
                f"deep at ({place}) mm; move it away"
            )
