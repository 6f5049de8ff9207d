"""`spread_points`: points all over a surface."""

import numpy as np
from jaxtyping import Float, Int

from hydrostat.geometry.surface import Surface

_PLASTIC = 1.32471795724474602596
"""Its powers spread points evenly over a square (Roberts 2018)."""

MOST = 2_000_000
"""No more points than this, and one for each triangle."""


def covering_points(surface: Surface, spacing: float) -> Float[np.ndarray, "points 3"]:
    """The vertices of a surface, and points spread evenly over its triangles, one for each `spacing` squared [m]."""
    return np.concatenate([surface.vertices[np.unique(surface.triangles)], spread_points(surface, spacing)[0]])


def spread_points(surface: Surface, spacing: float) -> tuple[Float[np.ndarray, "points 3"], Int[np.ndarray, " points"]]:
    """Points spread evenly over the triangles of a surface, one at least on each, and the triangle each is on.

    Args:
        surface: any.
        spacing: about one point for each square of this side [m].
    """
    areas = np.linalg.norm(surface.crosses, axis=1) / 2
    square = max(spacing**2, float(areas.sum()) / MOST)
    counts = np.maximum(np.ceil(areas / square).astype(np.int64), 1)
    owner = np.repeat(np.arange(len(counts)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    one, two = ((0.5 + (1 + number) / _PLASTIC**power) % 1 for power in (1, 2))
    over = one + two > 1
    one, two = np.where(over, 1 - one, one), np.where(over, 1 - two, two)
    weights = np.column_stack([1 - one - two, one, two])
    return np.einsum("pc,pcd->pd", weights, surface.vertices[surface.triangles[owner]]), owner
