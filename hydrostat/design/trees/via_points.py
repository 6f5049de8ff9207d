"""`keep_apart`: via points slide along their cables until every one can have a hole of its own."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from hydrostat.design.region import Route

_SAME = 1e-5
"""Points nearer than this [m] share a hole."""

_STEP = 1e-3
"""How finely places along a cable are tried [m]."""


def keep_apart(cables: Sequence[Route], *, gap: float, winch_gap: float) -> list[Route] | None:
    """The cables with their via points moved along them, so that no two points are nearer than `gap`.

    The first points, at the winches, stay; points of other cables keep `winch_gap` from them where they can. Points
    that coincide share a hole and may stay. None where a cable has no room left.
    """
    winches = np.array([cable[0] for cable in cables])
    holes = list(winches)
    moved = []
    for cable in cables:
        placed = [cable[0]]
        foreign = winches[np.linalg.norm(winches - cable[0], axis=1) > _SAME].reshape(-1, winches.shape[1])
        for index in range(1, len(cable)):
            places = _places(cable, index)
            free = (_gaps(places, np.array(holes), shared=index < len(cable) - 1) >= gap) & (
                np.linalg.norm(places - placed[-1], axis=1) >= gap
            )
            roomy = free & (_gaps(places, foreign, shared=False) >= winch_gap)
            chosen = np.flatnonzero(roomy if roomy.any() else free)
            if not len(chosen):
                return None
            placed.append(places[chosen[0]])
        holes += placed[1:]
        moved.append(np.array(placed))
    return moved


def _places(cable: Route, index: int) -> Route:
    """Places for one point along its cable, the nearest first: up to 0.45 of the way to its neighbours."""
    point, back = cable[index], cable[index - 1] - cable[index]
    ways = [back, cable[index + 1] - point] if index < len(cable) - 1 else [back]
    places = [(0.0, point)]
    for way in ways:
        length = float(np.linalg.norm(way))
        places += [(shift, point + way * (shift / length)) for shift in np.arange(_STEP, 0.45 * length, _STEP)]
    return np.array([place for _, place in sorted(places, key=lambda pair: pair[0])])


def _gaps(places: Float[np.ndarray, "places dim"], others: Route, *, shared: bool) -> Float[np.ndarray, " places"]:
    """Distance of each place from the nearest of other points; those on one spot count only where none is shared."""
    away = np.linalg.norm(places[:, None] - others[None], axis=2)
    if shared:
        away = np.where(away < _SAME, np.inf, away)
    return away.min(axis=1, initial=np.inf)
