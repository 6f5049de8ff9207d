"""How good a mesh is."""

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Elements, Points
from hydrostat.errors import InputError
from hydrostat.geometry.mesh import Mesh


def smallest_angle(mesh: Mesh) -> float:
    """Smallest angle of any triangle [degrees]; 60 at best.

    Raises:
        InputError: the mesh is not flat.
    """
    if mesh.dim != 2:
        raise InputError(f"angles are those of a flat mesh, this one has dimension {mesh.dim}")
    return float(angles(mesh.nodes, mesh.elements).min())


def angles(points: Points, triangles: Elements) -> Float[np.ndarray, " triangles"]:
    """Smallest angle of each triangle [degrees]."""
    corners = points[triangles]
    sides = np.sort(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2), axis=1)
    cosine = (sides[:, 1] ** 2 + sides[:, 2] ** 2 - sides[:, 0] ** 2) / (2.0 * sides[:, 1] * sides[:, 2])
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
