"""Sprue and vents: where foam goes in and air comes out.

In the coordinates of the mold: x across, y upwards as it stands when poured, z along the pull, parted at z = 0.
"""

from dataclasses import dataclass

import numpy as np
from manifold3d import Manifold

from hydrostat.arrays import Float, Vector
from hydrostat.fabrication.moulds.solids import rod
from hydrostat.fabrication.moulds.stance import MIN_TRAP, high_points
from hydrostat.fabrication.solids.printed import triangles_of

NECKS = (12.0, 10.0, 8.0, 6.0, 5.0)
"""Radii of a sprue [mm]: foam that rises is poured quickly, so 10 mm across at least."""

FUNNEL = 8.0  # excess of the funnel's radius over the neck's [mm], if there is room

_SUNK = 2.0
_STEP = 1.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Sprue:
    """The hole to pour into, half in each half."""

    x: float  # x of its axis [mm]
    mouth: float  # height at which it meets the body [mm]
    radius: float  # radius of its neck [mm]
    funnel: float  # radius at the top of the mold [mm]
    solid: Manifold  # all of it, reaching into the body


@dataclass(frozen=True, eq=False, kw_only=True)
class Vent:
    """A hole for air."""

    at: Float[np.ndarray, "3"]  # the high point that it serves [mm]
    upward: bool  # it is a groove in the parting plane; else it leaves through the back of a half
    solid: Manifold  # all of it, reaching into the body


def make_sprue(body: Manifold, *, top: float, room: tuple[float, float], deep: float) -> Sprue | None:
    """The widest sprue over the highest place of the parting plane that is wide enough; None if there is none.

    In the coordinates of the mold [mm]: its funnel ends at the `top` and reaches over the x in `room`; `deep` is the
    way from the parting plane to the nearer back.
    """
    across, tops = roof(body)
    if not len(across):
        return None
    best = float(tops.max())
    behind = 3.0
    necks = [radius for radius in NECKS if radius <= deep - behind] or [NECKS[-1]]
    widest = deep - behind
    drop = 6.0
    for radius in necks:
        window = int(np.ceil(radius / _STEP))
        levels = np.array([tops[max(place - window, 0) : place + window + 1].min() for place in range(len(across))])
        inside = (across - radius >= across[0] - _STEP) & (across + radius <= across[-1] + _STEP)
        levels = np.where(inside, levels, -np.inf)
        if not (levels.max() >= best - drop or radius == necks[-1]) or not np.isfinite(levels.max()):
            continue
        level = float(levels.max())
        flat = np.flatnonzero(levels > level - 0.25)
        x = float(across[flat[len(flat) // 2]])
        return _sprue(x, level, radius, top, room, widest)
    middle = int(np.argmax(tops))
    return _sprue(float(across[middle]), best - NECKS[-1], NECKS[-1], top, room, widest)


def _sprue(x: float, mouth: float, radius: float, top: float, room: tuple[float, float], widest: float) -> Sprue:
    funnel = max(min(radius + FUNNEL, x - room[0], room[1] - x, widest), radius)
    low = mouth - _SUNK
    neck = rod(np.array([x, low, 0.0]), np.array([x, top + 1.0, 0.0]), radius)
    funnel_depth = 12.0
    wide = rod(np.array([x, top - funnel_depth, 0.0]), np.array([x, top, 0.0]), radius, funnel)
    brim = rod(np.array([x, top - 0.01, 0.0]), np.array([x, top + 1.0, 0.0]), funnel)
    return Sprue(x=x, mouth=mouth, radius=radius, funnel=funnel, solid=neck + wide + brim)


def make_vents(cavity: Manifold, sprue: Sprue | None, *, low: float, high: float, top: float) -> tuple[Vent, ...]:
    """A vent at each high point of the cavity that does not lie under the sprue.

    Where the high point is at the parting plane, a groove leads up from it to the `top`; elsewhere a hole leads
    straight out of the back of the half, at z = `low` or `high` [mm], so that the foam in it is drawn out as the half
    comes off.
    """
    vertices, triangles = triangles_of(cavity)
    across, tops = roof(cavity)
    vents = []
    for number in high_points(vertices, triangles, np.array([0.0, 1.0, 0.0]), rise=MIN_TRAP):
        at = vertices[number]
        if sprue is None or not _leaves_by_sprue(at, across, tops, sprue):
            vents.append(_vent(at, across, tops, low=low, high=high, top=top))
    return tuple(vents)


def _leaves_by_sprue(at: Float[np.ndarray, "3"], across: Vector, tops: Vector, sprue: Sprue) -> bool:
    """Return True if air at a high point escapes by the sprue: from below it, or along a roof that hardly dips."""
    if np.hypot(at[0] - sprue.x, at[2]) < sprue.radius and at[1] > sprue.mouth - _SUNK:
        return True
    first, last = sorted((at[0], sprue.x))
    between = tops[(across >= first - _STEP) & (across <= last + _STEP)]
    return len(between) > 0 and bool(np.abs(between - at[1]).max() <= MIN_TRAP)


def _vent(at: np.ndarray, across: Vector, tops: Vector, *, low: float, high: float, top: float) -> Vent:
    near = float(np.interp(at[0], across, tops, left=-np.inf, right=-np.inf)) if len(across) else -np.inf
    vent = 1.5  # radius of a vent [mm]: a printer does not close it, foam does
    if abs(at[1] - near) <= MIN_TRAP:
        start = np.array([at[0], near - vent, 0.0])
        return Vent(at=at, upward=True, solid=rod(start, np.array([at[0], top + 1.0, 0.0]), vent))
    side = 1.0 if at[2] > 0 else -1.0
    back = high + 1.0 if side > 0 else low - 1.0
    level = at[1] - vent + MIN_TRAP / 4
    start = np.array([at[0], level, at[2] - side * vent])
    return Vent(at=at, upward=False, solid=rod(start, np.array([at[0], level, back]), vent))


def roof(body: Manifold) -> tuple[Vector, Vector]:
    """The highest y of a body in the parting plane [mm], at x a millimeter apart; places without body are left out."""
    edges = [np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in body.slice(0.0).to_polygons()]
    if not edges:
        return np.empty(0), np.empty(0)
    starts, ends = np.moveaxis(np.concatenate(edges).astype(float), 1, 0)
    across = np.arange(starts[:, 0].min() + _STEP / 2, starts[:, 0].max(), _STEP)
    tops = np.array([_highest(x, starts, ends) for x in across])
    there = np.isfinite(tops)
    return across[there], tops[there]


def _highest(x: float, starts: Float[np.ndarray, "edges 2"], ends: Float[np.ndarray, "edges 2"]) -> float:
    crossing = (starts[:, 0] <= x) != (ends[:, 0] <= x)
    start, end = starts[crossing], ends[crossing]
    if not len(start):
        return -np.inf
    return float((start[:, 1] + (x - start[:, 0]) / (end[:, 0] - start[:, 0]) * (end[:, 1] - start[:, 1])).max())
