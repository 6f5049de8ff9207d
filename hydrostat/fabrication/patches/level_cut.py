"""`cut_at_zero`: triangles divided along the line where a smooth field vanishes, so that seams are smooth."""

import numpy as np
from jaxtyping import Bool, Float, Int

from hydrostat.fabrication.patches.skin_mesh import SkinMesh

_NEAR = 0.05
"""A line that passes a corner nearer than this share of an edge goes through the corner: no slivers."""


def cut_at_zero(
    mesh: SkinMesh, field: Float[np.ndarray, " vertices"], inside: Bool[np.ndarray, " triangles"]
) -> tuple[SkinMesh, Int[np.ndarray, " parts"], Int[np.ndarray, " parts"]]:
    """Divide triangles along the zero line of a field over part of a mesh.

    Returns:
        The new mesh; of each of its triangles the old one; and 1 above zero, -1 below, 0 outside the part.
    """
    edges = mesh.edges[0]
    touched = np.zeros(len(edges), dtype=bool)
    touched[mesh.edges[1][inside]] = True
    field = _snapped(mesh, field, touched, inside)
    ends = field[edges]
    marked = touched & (ends[:, 0] * ends[:, 1] < 0)
    share = np.zeros(len(edges))
    share[marked] = ends[marked, 0] / (ends[marked, 0] - ends[marked, 1])
    divided, parent = mesh.divided(marked, share)
    heights = np.concatenate([field, np.zeros(int(marked.sum()))])[divided.triangles]
    side = np.sign(heights[np.arange(len(heights)), np.abs(heights).argmax(axis=1)]).astype(np.int64)
    return divided, parent, np.where(inside[parent], side, 0)


def _snapped(
    mesh: SkinMesh,
    field: Float[np.ndarray, " vertices"],
    touched: Bool[np.ndarray, " edges"],
    inside: Bool[np.ndarray, " triangles"],
) -> Float[np.ndarray, " vertices"]:
    """The field with zeros where its zero line passes close to a vertex, but never at all corners of a triangle."""
    edges = mesh.edges[0][touched]
    ends = field[edges]
    crossing = ends[:, 0] * ends[:, 1] < 0
    share = np.abs(ends[crossing]) / np.abs(ends[crossing]).sum(axis=1, keepdims=True)
    field = field.copy()
    least = 1e-9 * max(float(np.abs(field).max()), 1e-300)
    exact = np.where(field == 0, least, field)
    field[edges[crossing][share < _NEAR]] = 0.0
    while True:
        flat = inside & (field[mesh.triangles] == 0).all(axis=1)
        if not flat.any():
            return field
        field[mesh.triangles[flat]] = exact[mesh.triangles[flat]]
