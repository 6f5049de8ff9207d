"""Parts described by how they are made of simple shapes, so that one description gives both triangles and true STEP.

    plate = Box((40, 30, 3)) - Cylinder(3, 1.7).move(20, 15, 0)

`solid_of` makes triangles of a construction; `step.py` makes a model of true cylinders and planes. All in millimeters.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import singledispatch

import numpy as np
from manifold3d import CrossSection, Manifold

Corner = tuple[float, float]  # a corner of a profile [mm]

Sides = tuple[float, float, float]  # lengths along three axes [mm]


@dataclass(frozen=True, kw_only=True)
class Cuboid:
    """Two corners of a box along the axes [mm]."""

    low: Sides  # the least
    high: Sides  # the largest

    @property
    def size(self) -> Sides:
        """Sides of the box [mm]."""
        (a, b, c), (x, y, z) = self.low, self.high
        return x - a, y - b, z - c


class Construction:
    """Anything made of shapes; `+` joins, `-` takes away, `&` keeps what both have."""

    def __add__(self, other: "Construction") -> "Union":
        return Union(self, other)

    def __sub__(self, other: "Construction") -> "Difference":
        return Difference(self, other)

    def __and__(self, other: "Construction") -> "Intersection":
        return Intersection(self, other)

    def move(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> "Moved":
        """Return the shape moved by an offset [mm]."""
        return Moved(self, (x, y, z))

    def rotate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> "Turned":
        """Return the shape rotated about the fixed x axis, then y, then z [degrees]."""
        return Turned(self, (x, y, z))


@dataclass(frozen=True)
class Box(Construction):
    """A box with a corner at the origin, sides along the axes [mm]."""

    size: tuple[float, float, float]


@dataclass(frozen=True)
class Cylinder(Construction):
    """A cylinder, or a cone with another radius at the top, on the z axis, from z = 0 upwards [mm]."""

    height: float
    radius: float
    top: float | None = None


@dataclass(frozen=True)
class Prism(Construction):
    """A polygon, counter-clockwise, raised from z = 0 [mm] (ValueError: it runs clockwise, or encloses nothing)."""

    profile: tuple[Corner, ...]
    height: float

    def __post_init__(self) -> None:
        _check_turns(self.profile)


@dataclass(frozen=True)
class Revolve(Construction):
    """A polygon of (radius, height) corners, counter-clockwise, turned once round the z axis [mm].

    Raises ValueError: the corners turn clockwise, enclose nothing, or are beyond the axis.
    """

    profile: tuple[Corner, ...]

    def __post_init__(self) -> None:
        _check_turns(self.profile)
        if min(radius for radius, _ in self.profile) < 0:
            raise ValueError("a corner of a turning is beyond its axis: no radius may be below 0")


@dataclass(frozen=True)
class Union(Construction):
    """Union: what either has."""

    one: Construction
    other: Construction


@dataclass(frozen=True)
class Difference(Construction):
    """Difference: what the first has and the other has not."""

    one: Construction
    other: Construction


@dataclass(frozen=True)
class Intersection(Construction):
    """Intersection: what both have."""

    one: Construction
    other: Construction


@dataclass(frozen=True)
class Moved(Construction):
    """A shape, shifted [mm]."""

    shape: Construction
    by: tuple[float, float, float]


@dataclass(frozen=True)
class Turned(Construction):
    """A shape, turned about the x axis, then y, then z of space [degrees]."""

    shape: Construction
    by: tuple[float, float, float]


def _check_turns(profile: tuple[Corner, ...]) -> None:
    """Refuse what is empty as triangles but a body as STEP."""
    following = (*profile[1:], *profile[:1])
    area = sum(x * next_y - next_x * y for (x, y), (next_x, next_y) in zip(profile, following, strict=True)) / 2
    if not area > 0:
        raise ValueError(f"the corners of a profile must turn counter-clockwise; theirs enclose {area:g} mm^2")


def segments(radius: float) -> int:
    """Sides of a polygon for a circle [mm] that is nowhere further than 0.02 mm from it; a multiple of 8."""
    sag = 0.02  # maximum error of a round side [mm]
    half_angle = np.arccos(max(1 - sag / max(radius, 1e-9), 0.0))
    return int(8 * np.ceil(max(np.pi / half_angle, 16.0) / 8))


def sides_text(sides: Iterable[float]) -> str:
    """Sides of a box [mm] in words, such as "12 x 3 x 4"."""
    return " x ".join(f"{side:.0f}" for side in sides)


@singledispatch
def solid_of(construction: Construction) -> Manifold:
    """The triangles of a construction, their corners on the true round: a shaft is at most 0.02 mm too thin."""
    raise TypeError(f"no solid is known for {type(construction).__name__}")


@solid_of.register
def _(shape: Box) -> Manifold:
    return Manifold.cube(shape.size)


@solid_of.register
def _(shape: Cylinder) -> Manifold:
    top = shape.radius if shape.top is None else shape.top
    return Manifold.cylinder(shape.height, shape.radius, top, segments(max(shape.radius, top)))


@solid_of.register
def _(shape: Prism) -> Manifold:
    return Manifold.extrude(CrossSection([np.array(shape.profile)]), shape.height)


@solid_of.register
def _(shape: Revolve) -> Manifold:
    widest = max(radius for radius, _ in shape.profile)
    return Manifold.revolve(CrossSection([np.array(shape.profile)]), segments(widest))


@solid_of.register
def _(shape: Union) -> Manifold:
    return solid_of(shape.one) + solid_of(shape.other)


@solid_of.register
def _(shape: Difference) -> Manifold:
    return solid_of(shape.one) - solid_of(shape.other)


@solid_of.register
def _(shape: Intersection) -> Manifold:
    return solid_of(shape.one) ^ solid_of(shape.other)


@solid_of.register
def _(shape: Moved) -> Manifold:
    return solid_of(shape.shape).translate(shape.by)


@solid_of.register
def _(shape: Turned) -> Manifold:
    return solid_of(shape.shape).rotate(shape.by)
