"""How good a mesh is."""

from itertools import combinations

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Elements, Nodes, Points
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


def dihedral_angles(nodes: Nodes, elements: Elements) -> Float[np.ndarray, " elements"]:
    """Smallest angle between two faces of each tetrahedron [degrees]: 70.5 at best, 0 where it is flat or inverted."""
    corners = nodes[elements]
    spans = corners[:, 1:] - corners[:, :1]
    sizes = np.abs(spans).max(axis=(1, 2), initial=0.0)
    upright = np.linalg.det(spans) > 1e-14 * sizes**3  # below that the inverse is only rounding
    inverse = np.linalg.inv(np.where(upright[:, None, None], spans, np.eye(3)))
    normals = np.concatenate([-inverse.sum(axis=2, keepdims=True), inverse], axis=2)
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    cosines = [-(normals[:, :, one] * normals[:, :, two]).sum(axis=1) for one, two in combinations(range(4), 2)]
    angles = np.degrees(np.arccos(np.clip(np.max(cosines, axis=0), -1.0, 1.0)))
    return np.where(upright, angles, 0.0)
