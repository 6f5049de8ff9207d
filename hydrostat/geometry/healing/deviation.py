"""How far a healed surface is from what it was made of."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from hydrostat.geometry.healing.sides import sides_of
from hydrostat.geometry.spread import spread_points
from hydrostat.geometry.surface import Surface


@dataclass(frozen=True, eq=False)
class Deviation:
    """Distances between two surfaces.

    Attributes:
        largest: between what the surfaces have in common, from each to the other [m]; not of what is patched or
            lost, nor where the first lies inside the second.
        patched: share of the second surface's area that is far from the first, as over its holes.
        lost: triangles of the first of which most lies outside the second and far from it.
    """

    largest: float
    patched: float
    lost: Int[np.ndarray, " lost"]


def deviation(before: Surface, after: Surface, near: float) -> Deviation:
    """How far a closed surface is from what it was made of.

    Args:
        before: as it was, with holes and overlaps.
        after: closed.
        near: what is farther away than this is patched, lost or inside [m].
    """
    import igl

    squared, nearest, _ = igl.point_mesh_squared_distance(after.vertices, before.vertices, before.triangles)
    distance = np.sqrt(np.array(squared))
    areas = np.linalg.norm(after.crosses, axis=1)
    patched = float(areas[(distance > near)[after.triangles].all(axis=1)].sum() / areas.sum())
    distance[(distance > near) | _at_rim(before)[np.array(nearest)]] = 0.0
    points, owner = spread_points(before, near)  # all over long triangles, not at their corners only
    back = np.sqrt(np.array(igl.point_mesh_squared_distance(points, after.vertices, after.triangles)[0]))
    some = np.flatnonzero(back > 0.05 * near)
    winding = np.array(igl.fast_winding_number(after.vertices, after.triangles, points[some]))
    back[some[winding >= 0.5]] = 0.0
    far = back > near
    count = len(before.triangles)
    lost = 2 * np.bincount(owner[far], minlength=count) > np.bincount(owner, minlength=count)
    back[far & lost[owner]] = 0.0
    return Deviation(float(max(distance.max(), back.max())), patched, np.flatnonzero(lost))


def _at_rim(surface: Surface) -> Bool[np.ndarray, " triangles"]:
    """Triangles with a corner at an open edge: what is nearest to them may lie over a hole."""
    sides = sides_of(surface.triangles)
    rim = np.zeros(len(surface.vertices), dtype=bool)
    rim[sides.ends[sides.open]] = True
    return np.asarray(rim[surface.triangles].any(axis=1))
