"""`front_and_back`: the first cut of a toy maker: along the silhouette, as seen along the thin direction."""

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import splu

from hydrostat.fabrication.patches.level_cut import cut_at_zero
from hydrostat.fabrication.patches.skin_mesh import SkinMesh

_SMOOTH = 0.02
"""How far the normals are smoothed before the silhouette is drawn, as a share of the body's diagonal."""

_ALONG_AXIS = 0.94
"""A direction so near to an axis (its cosine) is the axis: 20 degrees."""


def thin_direction(mesh: SkinMesh) -> Float[np.ndarray, " 3"]:
    """The direction towards which, there and back, most of the skin looks; the axis where it is near one."""
    areas = np.maximum(mesh.areas, 1e-300)[:, None]
    normals = mesh.crosses / (2 * areas)
    direction = np.linalg.eigh((normals * areas).T @ normals)[1][:, -1]
    main = int(np.abs(direction).argmax())
    if abs(direction[main]) > _ALONG_AXIS:
        direction = np.eye(3)[main]
    return direction * np.sign(direction[main])


def front_and_back(mesh: SkinMesh) -> SkinMesh:
    """The mesh in two discs: patch 0 looks against the thin direction (the front), patch 1 along it."""
    direction = thin_direction(mesh)
    field = _smoothed(mesh, _looks(mesh, direction))
    cut, _, side = cut_at_zero(mesh, field, np.ones(len(mesh.triangles), dtype=bool))
    return cut.labelled(two_discs(cut, side))


def two_discs(mesh: SkinMesh, side: Int[np.ndarray, " triangles"]) -> Int[np.ndarray, " triangles"]:
    """0 below and 1 above, islands given to what is round them, so that both are in one piece.

    On a closed surface without holes through it, a piece whose rest is one piece too is a disc.
    """
    above = _largest(mesh, (side > 0).astype(np.int64), 1)
    return 1 - _largest(mesh, 1 - above, 1)


def _largest(mesh: SkinMesh, label: Int[np.ndarray, " triangles"], value: int) -> Int[np.ndarray, " triangles"]:
    """1 in the largest piece with that label, else 0."""
    pieces = mesh.pieces(label)
    areas = np.bincount(pieces, mesh.areas * (label == value))
    return (pieces == int(areas.argmax())).astype(np.int64)


def _looks(mesh: SkinMesh, direction: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " vertices"]:
    """How far the skin at each vertex looks along a direction: 1 along it, -1 against it."""
    normals = np.zeros_like(mesh.vertices)
    for corner in range(3):
        np.add.at(normals, mesh.triangles[:, corner], mesh.crosses)
    return (normals @ direction) / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)


def _smoothed(mesh: SkinMesh, values: Float[np.ndarray, " vertices"]) -> Float[np.ndarray, " vertices"]:
    """One implicit step of diffusion over the skin."""
    import igl

    reach = _SMOOTH * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    spread = csc_array(igl.intrinsic_delaunay_cotmatrix(mesh.vertices, mesh.triangles)[0])
    mass = np.bincount(mesh.triangles.ravel(), np.repeat(mesh.areas / 3, 3), len(mesh.vertices))
    return splu(csc_array(diags_array(mass) - reach**2 * spread)).solve(mass * values)
