"""Solids that molds are made of: rods, sums of several; in millimeters."""

from collections.abc import Iterable

import numpy as np
from manifold3d import Manifold

from hydrostat.arrays import Float
from hydrostat.fabrication.solids.construct import segments

_TURNS = {
    (0, True): (0.0, 90.0, 0.0),
    (0, False): (0.0, -90.0, 0.0),
    (1, True): (-90.0, 0.0, 0.0),
    (1, False): (90.0, 0.0, 0.0),
    (2, True): (0.0, 0.0, 0.0),
    (2, False): (180.0, 0.0, 0.0),
}


def rod(
    start: Float[np.ndarray, "3"], end: Float[np.ndarray, "3"], radius: float, top: float | None = None
) -> Manifold:
    """A cylinder, or a cone with another radius at its end, between two points along one of the axes [mm]."""
    way = end - start
    axis = int(np.argmax(np.abs(way)))
    last = radius if top is None else top
    upright = Manifold.cylinder(float(np.abs(way[axis])), radius, last, segments(max(radius, last)))
    return upright.rotate(_TURNS[axis, bool(way[axis] > 0)]).translate(tuple(start.tolist()))


def join_solids(solids: Iterable[Manifold]) -> Manifold:
    """Return the union of solids."""
    whole = Manifold()
    for solid in solids:
        whole = whole + solid
    return whole
