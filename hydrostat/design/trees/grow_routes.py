"""`grow_routes`, `keep_apart`: from strong muscle fibres to the routes that cables can take (R39, R40, Fig 3.9c)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Vector
from hydrostat.design.polyline import Route, resample
from hydrostat.design.region import Region

FibreEnds = Float[np.ndarray, "fibres 2 dim"]


@dataclass(frozen=True, kw_only=True)
class GrowthLimits:
    """When a fibre may be joined to a route."""

    distance: float  # largest gap to bridge [m]
    steps: int  # most fibres joined
    turn: float  # sharpest turn [degrees]
    spacing: float  # length of a mesh edge [m]; fibres nearer than 0.6 of it to a route belong to it


def strongest(tensions: Vector, count: int, *, weakest: float = 0.02) -> Int[np.ndarray, " candidates"]:
    """Indices of the `count` fibres of largest tension, above a fraction of the largest, strongest first (R39)."""
    order = np.argsort(-tensions, kind="stable")[:count]
    return order[tensions[order] > weakest * tensions.max(initial=0.0)]


def grow_routes(ends: FibreEnds, tensions: Vector, limits: GrowthLimits) -> list[Route]:
    """Routes through candidate fibres, each begun at the largest tension left (R40).

    At either end of a route the nearest candidate is joined that is close enough, turns little and does not lead
    back; of equally near ones the stronger. Fibres along a finished route are used up.
    """
    free = np.ones(len(ends), dtype=bool)
    routes = []
    for seed in np.argsort(-tensions, kind="stable"):
        if not free[seed]:
            continue
        route = [ends[seed, 0], ends[seed, 1]]
        free[seed] = False
        for _ in range(limits.steps):
            if not _extend(route, ends, tensions, free, limits):
                break
        free &= ~_along(ends, np.array(route), 0.6 * limits.spacing)
        if len(route) > 2:
            routes.append(np.array(route))
    return routes


def _extend(
    route: list[Vector], ends: FibreEnds, tensions: Vector, free: Bool[np.ndarray, " fibres"], limits: GrowthLimits
) -> bool:
    """Join the best free fibre to one of the two ends of a route; False if none fits."""
    best: tuple[float, float] | None = None
    found = (0, 0, False)
    bound = np.cos(np.radians(limits.turn))
    for at_start in (False, True):
        tip, before = (route[0], route[1]) if at_start else (route[-1], route[-2])
        for side in (0, 1):
            close = np.flatnonzero(free & _is_close(ends[:, side], tip, limits.distance))
            if not len(close):
                continue
            near, far = ends[close, side], ends[close, 1 - side]
            gaps = np.linalg.norm(near - tip, axis=1)
            fits = gaps <= limits.distance
            fits &= _cosines(tip - before, far - tip) >= bound
            fits &= _cosines(tip - before, far - near) >= bound
            fits &= ~_near_points(far, np.array(route), 0.5 * limits.spacing)
            for index in np.flatnonzero(fits):
                fibre = int(close[index])
                key = (round(gaps[index] / limits.spacing, 1), -tensions[fibre])
                if best is None or key < best:
                    best, found = key, (fibre, side, at_start)
    if best is None:
        return False
    fibre, side, at_start = found
    near, far = ends[fibre, side], ends[fibre, 1 - side]
    tip = route[0] if at_start else route[-1]
    added = [far] if np.linalg.norm(near - tip) < 0.1 * limits.spacing else [near, far]
    route[:] = added[::-1] + route if at_start else route + added
    free[fibre] = False
    return True


def _is_close(spots: Float[np.ndarray, "fibres dim"], tip: Vector, reach: float) -> Bool[np.ndarray, " fibres"]:
    """Return True for points within a distance, or beyond it by rounding alone."""
    squares = sum((spots[:, axis] - tip[axis]) ** 2 for axis in range(len(tip)))
    return np.asarray(squares <= (reach * (1 + 1e-9)) ** 2)


def _cosines(first: Float[np.ndarray, "*rows dim"], second: Float[np.ndarray, "fibres dim"]) -> Vector:
    """Cosine of the angle between vectors, row by row."""
    first, second = np.broadcast_arrays(first, second)
    norms = np.linalg.norm(first, axis=-1) * np.linalg.norm(second, axis=-1)
    return (first * second).sum(axis=-1) / np.maximum(norms, 1e-300)


def _near_points(spots: Float[np.ndarray, "spots dim"], route: Route, reach: float) -> Bool[np.ndarray, " spots"]:
    return np.linalg.norm(spots[:, None] - route[None], axis=2).min(axis=1) < reach


def _along(ends: FibreEnds, route: Route, reach: float) -> Bool[np.ndarray, " fibres"]:
    """Fibres that lie wholly within `reach` of a route."""
    starts, spans = route[:-1], np.diff(route, axis=0)
    offsets = ends[:, :, None, :] - starts
    along = np.einsum("feSd,Sd->feS", offsets, spans) / (spans**2).sum(axis=1)
    feet = starts + np.clip(along, 0.0, 1.0)[..., None] * spans
    return (np.linalg.norm(ends[:, :, None, :] - feet, axis=3).min(axis=2) <= reach).all(axis=1)


def lay_route(route: Route, region: Region, spacing: float) -> Route | None:
    """A route as a cable can run: in the clearance, smoothed, a via point about every `spacing`; None if it cannot."""
    smooth = resample(region.push_inside(route), spacing / 4)
    for _ in range(6):
        smooth[1:-1] = 0.25 * smooth[:-2] + 0.5 * smooth[1:-1] + 0.25 * smooth[2:]
    laid = region.push_inside(resample(region.push_inside(smooth), spacing))
    return laid if len(laid) >= 2 and region.holds(laid) else None


_HOLE_TOLERANCE = 1e-5  # points nearer than this [m] share a hole
_STEP = 1e-3  # how finely places along a cable are tried [m]


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
        foreign = winches[np.linalg.norm(winches - cable[0], axis=1) > _HOLE_TOLERANCE].reshape(-1, winches.shape[1])
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
    """Places for one point along its cable, the nearest first: up to 0.45 of the way to its neighbors."""
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
        away = np.where(away < _HOLE_TOLERANCE, np.inf, away)
    return away.min(axis=1, initial=np.inf)
