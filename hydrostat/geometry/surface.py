"""`Surface`: triangles in space, as a scan or a CAD model gives them, or as they are after healing."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from jaxtyping import Bool, Float, Int

from hydrostat.errors import SurfaceError


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles in space; nothing is promised of how they meet, only that their numbers are numbers.

    Attributes:
        vertices: places [m], (vertices, 3); kept as a read-only copy.
        triangles: indices of three vertices each, (triangles, 3); seen from outside they turn counter-clockwise.

    Raises:
        SurfaceError: wrong shapes, no triangle, coordinates that are not finite, or indices out of range.
    """

    vertices: Float[np.ndarray, "vertices 3"]
    triangles: Int[np.ndarray, "triangles 3"]

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, dtype=float, order="C")
        triangles = np.array(self.triangles, dtype=np.int64, order="C")
        if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
            raise SurfaceError("a surface needs finite vertices in space, (vertices, 3)")
        if triangles.ndim != 2 or triangles.shape[1] != 3 or not len(triangles):
            raise SurfaceError("a surface needs triangles, (triangles, 3), at least one")
        if triangles.min() < 0 or triangles.max() >= len(vertices):
            raise SurfaceError("the surface names a vertex that it does not have")
        vertices.setflags(write=False)
        triangles.setflags(write=False)
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "triangles", triangles)

    @cached_property
    def box(self) -> Float[np.ndarray, "2 3"]:
        """Lowest and highest coordinates of what the triangles use [m]."""
        corners = self.vertices[np.unique(self.triangles)]
        return np.array([corners.min(axis=0), corners.max(axis=0)])

    @property
    def size(self) -> float:
        """Longest side of the bounding box [m]."""
        return float(np.ptp(self.box, axis=0).max())

    @cached_property
    def crosses(self) -> Float[np.ndarray, "triangles 3"]:
        """Cross product of two sides of each triangle [m^2]: its normal, outward, twice as long as its area."""
        one, two, three = (self.vertices[corner] for corner in self.triangles.T)
        return np.cross(two - one, three - one)

    def part(self, chosen: Bool[np.ndarray, " triangles"] | Int[np.ndarray, " some"]) -> Self:
        """Some of its triangles, by a mask or by number, with the vertices that they use."""
        used, triangles = np.unique(self.triangles[chosen], return_inverse=True)
        return type(self)(self.vertices[used], triangles.reshape(-1, 3))

    @property
    def area(self) -> float:
        """Area of all triangles [m^2]."""
        return float(np.linalg.norm(self.crosses, axis=1).sum() / 2)

    @property
    def volume(self) -> float:
        """Volume enclosed [m^3] if the surface is closed, negative if it is inside out; else without meaning."""
        middle = self.box.mean(axis=0)  # near the surface, for rounding
        return float(np.einsum("td,td->", self.vertices[self.triangles[:, 0]] - middle, self.crosses) / 6)
