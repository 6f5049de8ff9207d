"""`Fit`: how well a mesh follows the surface it was made from."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.solid import Solid
from hydrostat.geometry.surface import Surface

CLOSE = 0.25
"""The boundary of a mesh should be as near to the surface, in element sizes."""

_PLASTIC = 1.32471795724474602596
"""Its powers spread points evenly over a square (Roberts 2018)."""


@dataclass(frozen=True, eq=False)
class Fit:
    """How far apart a surface and the boundary of a mesh are.

    Attributes:
        places: points of both, those of the mesh first [m].
        distances: of each point from the other surface [m].
        volume: enclosed by the mesh, as a fraction of what the surface encloses.
    """

    places: Points
    distances: Vector
    volume: float

    @property
    def largest(self) -> float:
        """The largest distance, either way [m]."""
        return float(self.distances.max())


def fit(mesh: Mesh, solid: Solid, spacing: float) -> Fit:
    """Compare a mesh of tetrahedra with a solid, at points not farther apart than about `spacing` [m]."""
    outer = Solid(Surface(mesh.nodes, mesh.boundary))
    places, distances = [], []
    for one, other in ((outer, solid), (solid, outer)):
        points = spread_points(one.surface, spacing)
        places.append(points)
        distances.append(np.linalg.norm(other.nearest(points)[0] - points, axis=1))
    volume = float(mesh.volumes.sum()) / solid.surface.volume
    return Fit(np.concatenate(places), np.concatenate(distances), volume)


def spread_points(surface: Surface, spacing: float) -> Points:
    """The vertices of a surface, and points spread evenly over its triangles, one for each `spacing` squared [m]."""
    areas = np.linalg.norm(surface.crosses, axis=1) / 2
    counts = np.ceil(areas / spacing**2).astype(int)
    owner = np.repeat(np.arange(len(counts)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    one, two = ((0.5 + (1 + number) / _PLASTIC**power) % 1 for power in (1, 2))
    over = one + two > 1
    one, two = np.where(over, 1 - one, one), np.where(over, 1 - two, two)
    weights = np.column_stack([1 - one - two, one, two])
    inner = np.einsum("pc,pcd->pd", weights, surface.vertices[surface.triangles[owner]])
    return np.concatenate([surface.vertices[np.unique(surface.triangles)], inner])
