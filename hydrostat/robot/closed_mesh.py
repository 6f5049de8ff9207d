"""`ClosedMesh`: rigid object of any shape, from a file."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.errors import InputError
from hydrostat.geometry import Shell, Surface, read_surface

MOST_TRIANGLES = 20_000
"""No thing may have more."""


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
        centre = volumes @ sums / (4 * volume)
        products = np.einsum("t,tci,tcj->ij", volumes, corners, corners) + np.einsum("t,ti,tj->ij", volumes, sums, sums)
        return volume, middle + centre, products / (20 * volume) - np.outer(centre, centre)


def closed_mesh(content: bytes, file: str, *, unit: float = 1e-3) -> ClosedMesh:
    """Read an object from a surface file whose coordinates are in `unit` metres.

    Raises:
        InputError: no surface, an open one, one that is inside out or runs through itself, or too many triangles.
    """
    from hydrostat.geometry import crossing_pairs  # only here: a robot without such a thing starts sooner

    surface = read_surface(content, name=file, unit=unit)
    if len(surface.triangles) > MOST_TRIANGLES:
        count = len(surface.triangles)
        raise InputError(f"{file}: has {count} triangles, an obstacle at most {MOST_TRIANGLES}; simplify the surface")
    merged, numbers = np.unique(surface.vertices, axis=0, return_inverse=True)
    triangles = numbers.reshape(-1)[surface.triangles]
    whole = Surface(merged, triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)])
    if not Shell(whole.vertices, whole.triangles).is_closed:
        raise InputError(f"{file}: is not closed, or its triangles do not all turn the same way; mend it first")
    if whole.volume <= 0:
        raise InputError(f"{file}: is inside out; turn its triangles round")
    crossing = crossing_pairs(whole)
    if len(crossing):
        spot = ", ".join(f"{1e3 * x:.1f}" for x in whole.vertices[whole.triangles[crossing[0, 0]]].mean(axis=0))
        raise InputError(f"{file}: runs through itself, for instance at ({spot}) mm; mend it first")
    return ClosedMesh(file=file, content=content, surface=whole)
