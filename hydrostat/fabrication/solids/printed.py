"""`Printed`: a solid that comes from a 3D printer."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int
from manifold3d import Manifold

from hydrostat.fabrication.solids.construct import Construction
from hydrostat.fabrication.solids.file_mesh import FileMesh, file_mesh

PLA = 1.24e-3
"""Density of PLA [g/mm^3]."""

SHELL = 1.2
"""Thickness of the shell that slicers print whole by themselves [mm]: three lines of 0.4 mm."""

INFILL = 0.15
"""Share of what is inside the shell that is plastic, as slicers have it by themselves."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Printed:
    """A solid as it lies on the print bed, in millimetres: z up, its lowest point at z = 0.

    Attributes:
        name: stem of its files, of letters, digits and underscores.
        title: what a person calls it.
        solid: watertight.
        count: how many are needed.
        note: how to print it: which way up, what to mind.
        model: how it is made of shapes, for STEP; None for what is no sum of simple shapes.
    """

    name: str
    title: str
    solid: Manifold
    count: int = 1
    note: str = ""
    model: Construction | None = None

    @property
    def volume(self) -> float:
        """Of one, filled [mm^3]."""
        return float(self.solid.volume())

    @property
    def mass(self) -> float:
        """Of one in PLA [g], estimated: a whole shell under all of its surface, little inside; at most all plastic."""
        shell = min(SHELL * float(self.solid.surface_area()), self.volume)
        return PLA * (shell + INFILL * (self.volume - shell))

    @property
    def size(self) -> tuple[float, float, float]:
        """Sides of its box [mm]."""
        low_x, low_y, low_z, high_x, high_y, high_z = self.solid.bounding_box()
        return high_x - low_x, high_y - low_y, high_z - low_z

    @cached_property
    def mesh(self) -> tuple[Float[np.ndarray, "vertices 3"], Int[np.ndarray, "triangles 3"]]:
        """Its vertices [mm] and triangles, as computed."""
        return triangles_of(self.solid)

    @cached_property
    def written(self) -> FileMesh:
        """Its vertices [mm] and triangles, as every file lists them."""
        return file_mesh(self.solid)


def triangles_of(solid: Manifold) -> tuple[Float[np.ndarray, "vertices 3"], Int[np.ndarray, "triangles 3"]]:
    """Vertices [mm] and triangles of a solid; seen from outside these turn counter-clockwise."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3], dtype=float), np.array(mesh.tri_verts, dtype=np.int64)
