"""`watertight_problems`: whether a slicer will find a body in the triangles that are written."""

import numpy as np
from jaxtyping import Float, Int
from manifold3d import Error
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from hydrostat.fabrication.solids.file_mesh import loose_edges
from hydrostat.fabrication.solids.printed import Printed

_ON_BED = 1e-4
"""How far from the bed the lowest point may be [mm]."""

_CRUMB = 1e-3
"""Volume below which a body of its own is no piece of a part, only a leftover of rounding [mm^3]."""

_CHANGE = 1e-4
"""By how much of itself a volume may change when a part is written."""


def watertight_problems(printed: Printed) -> tuple[str, ...]:
    """A sentence for each thing that is wrong with a part; none if it can be sliced.

    The triangles are those of the files, counted here, whatever the boolean engine says of its own work: each edge is
    used twice, in opposite directions; together they enclose the volume of the solid, in one piece; it stands on the
    bed.
    """
    if printed.solid.status() != Error.NoError:
        return (f"{printed.name}: the solid is no solid ({printed.solid.status().name})",)
    vertices, triangles = printed.written
    if len(triangles) == 0:
        return (f"{printed.name}: the solid is empty",)
    problems = []
    if loose := loose_edges(triangles):
        problems.append(f"{printed.name}: {loose} edges do not have exactly one triangle on either side")
    volume = enclosed(vertices, triangles)
    if not volume > 0:
        problems.append(f"{printed.name}: its triangles enclose no volume, or are inside out")
    elif abs(volume - printed.volume) > _CHANGE * volume:
        problems.append(f"{printed.name}: {printed.volume:.6g} mm^3 became {volume:.6g} mm^3 in its files")
    if (pieces := _pieces(vertices, triangles)) > 1:
        problems.append(f"{printed.name}: falls into {pieces} pieces")
    lowest = float(vertices[:, 2].min())
    if abs(lowest) > _ON_BED:
        problems.append(f"{printed.name}: its lowest point is at z = {lowest:.4f} mm, not on the bed")
    return tuple(problems)


def enclosed(vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]) -> float:
    """Volume within triangles [mm^3] by the divergence theorem; negative if they are inside out."""
    corners = vertices[triangles] - vertices.mean(axis=0)
    return float(_wedges(corners).sum())


def _wedges(corners: Float[np.ndarray, "triangles 3 3"]) -> Float[np.ndarray, " triangles"]:
    """Volumes between each triangle and the origin [mm^3]."""
    return np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6


def _pieces(vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]) -> int:
    """Bodies that share no vertex; hollows within a body are inside out and do not count."""
    count = len(vertices)
    ones, others = triangles.reshape(-1), np.roll(triangles, 1, axis=1).reshape(-1)
    links = coo_matrix((np.ones(len(ones)), (ones, others)), shape=(count, count))
    bodies, body = connected_components(links, directed=False)
    volumes = np.bincount(body[triangles[:, 0]], _wedges(vertices[triangles] - vertices.mean(axis=0)), bodies)
    return int(np.count_nonzero(volumes > _CRUMB))
