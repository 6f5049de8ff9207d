"""`Fit`: how well a mesh follows the surface it was made from."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.solid import Solid
from hydrostat.geometry.spread import covering_points
from hydrostat.geometry.surface import Surface

CLOSE = 0.25
"""The boundary of a mesh should be as near to the surface, in element sizes."""


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
        points = covering_points(one.surface, spacing)
        places.append(points)
        distances.append(np.linalg.norm(other.nearest(points)[0] - points, axis=1))
    volume = float(mesh.volumes.sum()) / solid.surface.volume
    return Fit(np.concatenate(places), np.concatenate(distances), volume)
