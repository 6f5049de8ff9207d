"""`LoopCorner`, `read_loops`, `loops_svg`, `fit_loops`: an outline as few corners, as a person draws it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from shapely import LinearRing, Polygon, distance, get_coordinates
from shapely import points as shapely_points

from hydrostat.errors import InputError
from hydrostat.geometry import Outline, Ring
from hydrostat.units import plural

HANDLE = 0.35
"""Length of the handles of a curve, in distances of its ends: the one that fits circles of four to eight corners best.
The editor on the screen has the same number."""

_STATIONS = np.linspace(0.0, 1.0, 17)[:-1]
_GOOD_FIT, _THIN, _FIRST, _MAX_KNOTS = 0.0045, 0.0003, 6, 200
_SHARP, _WINDOW = np.deg2rad(50.0), 0.004


@dataclass(frozen=True)
class LoopCorner:
    """A corner of a loop."""

    x: float  # to the right [mm]
    y: float  # up [mm]
    smooth: bool = False  # whether the outline runs through it in a curve


Loop = tuple[LoopCorner, ...]  # corners in order, the last joined to the first


def read_loops(raw: Any) -> tuple[Loop, ...]:
    """Loops as a screen sends them: lists of [x, y, smooth] (InputError: they are no such thing, or too many)."""
    try:
        loops = tuple(tuple(LoopCorner(float(x), float(y), bool(smooth)) for x, y, smooth in loop) for loop in raw)
    except (TypeError, ValueError, OverflowError):
        raise InputError("invalid outline data") from None
    most_loops, most_corners = 50, 1000  # so many loops, so many corners in all
    if len(loops) > most_loops or sum(map(len, loops)) > most_corners:
        raise InputError(f"an outline has at most {most_loops} loops and {most_corners} corners")
    furthest = 20_000.0  # no corner is farther from the middle [mm]
    for corner in (corner for loop in loops for corner in loop):
        if not all(isfinite(value) and abs(value) <= furthest for value in (corner.x, corner.y)):
            raise InputError(f"a corner of the outline is farther than {furthest / 1e3:g} m from the middle")
    return loops


def send_loops(loops: Iterable[Loop]) -> list[list[list[Any]]]:
    """Lists that a screen is sent; the other way round than `read_loops`."""
    return [[[corner.x, corner.y, corner.smooth] for corner in loop] for loop in loops]


def handles(loop: Loop) -> tuple[Ring, Ring, Ring]:
    """Start and two handles of each side [mm]; those of a straight side lie on it."""
    places = np.array([(corner.x, corner.y) for corner in loop], dtype=float)
    smooth = np.array([corner.smooth for corner in loop])
    ends = np.roll(places, -1, axis=0)
    chords = np.linalg.norm(ends - places, axis=1, keepdims=True)
    across = ends - np.roll(places, 1, axis=0)
    tangents = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
    along = (ends - places) / np.maximum(chords, 1e-12)
    leaving = np.where(smooth[:, None], tangents, along)
    arriving = np.where(np.roll(smooth, -1)[:, None], np.roll(tangents, -1, axis=0), along)
    return places, places + HANDLE * chords * leaving, ends - HANDLE * chords * arriving


def curve(loop: Loop) -> Ring:
    """Ring along a loop [mm]."""
    starts, first, second = handles(loop)
    ends = np.roll(starts, -1, axis=0)
    s = _STATIONS[None, :, None]
    parts = (starts[:, None], first[:, None], second[:, None], ends[:, None])
    weights = ((1 - s) ** 3, 3 * s * (1 - s) ** 2, 3 * s**2 * (1 - s), s**3)
    dense = sum(weight * part for weight, part in zip(weights, parts, strict=True))
    return np.asarray(dense).reshape(-1, 2)


def outline_of(loops: Sequence[Loop]) -> Outline:
    """The body inside the loops [m]: the largest is its rim, the others are holes.

    Raises:
        OutlineError: they enclose no body, such as when one crosses itself; the message says where.
        InputError: there is no loop, or one has not three corners.
    """
    for loop in loops:
        if len(loop) < 3:
            raise InputError(f"a loop has {plural(len(loop), 'corner')} (minimum 3)")
    return Outline(*_sort_rings([1e-3 * curve(loop) for loop in loops]))


def loops_svg(loops: Sequence[Loop]) -> tuple[bytes, tuple[float, float]]:
    """The loops as SVG in mm, and what of theirs is its upper left corner [mm] (InputError: as for `outline_of`)."""
    rim = 1e3 * outline_of(loops).exterior
    (left, low), (right, top) = rim.min(axis=0), rim.max(axis=0)
    wide, high = right - left, top - low
    corner = np.array([left, top])
    paths = " ".join(_path(loop, corner) for loop in loops)
    text = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide:.3f}mm" height="{high:.3f}mm" '
        f'viewBox="0 0 {wide:.3f} {high:.3f}">\n  <path fill-rule="evenodd" d="{paths}"/>\n</svg>\n'
    )
    return text.encode(), (float(left), float(top))


def fit_loops(outline: Outline) -> tuple[Loop, ...]:
    """Fit loops with the fewest corners that follow an outline to within a share of its size."""
    return tuple(_fit_ring(1e3 * ring, 1e3 * outline.size) for ring in outline.rings)


def _fit_ring(rim: Ring, size: float) -> Loop:
    """Corners where a ring [mm] is followed worst, stretch by stretch, until all of it is followed well."""
    ring = get_coordinates(Polygon(rim).simplify(_THIN * size))[:-1]
    whole, places = LinearRing(ring), shapely_points(ring)
    sharp = _sharp(ring, _WINDOW * size)
    knots = [int(index) for index in np.linspace(0, len(ring), min(_FIRST, len(ring)), endpoint=False)]
    while True:
        loop = tuple(
            LoopCorner(round(float(ring[knot, 0]), 2), round(float(ring[knot, 1]), 2), not sharp[knot])
            for knot in knots
        )
        dense = curve(loop)
        missed = np.asarray(distance(places, LinearRing(dense)))
        missed[knots] = 0.0
        strayed = np.asarray(distance(shapely_points(dense), whole))
        if max(missed.max(), strayed.max()) < _GOOD_FIT * size or len(knots) >= min(_MAX_KNOTS, len(ring)):
            return loop
        stretches = [part[1:] for part in np.split(np.arange(len(ring)), knots[1:])]
        worst = [int(part[missed[part].argmax()]) for part in stretches if len(part)]
        more = {knot for knot in worst if missed[knot] > _GOOD_FIT * size}
        if not more:
            near = int(np.linalg.norm(ring - dense[strayed.argmax()], axis=1).argmin())
            more = {near if near not in knots else _halfway(knots, near, len(ring))}
        knots = sorted({*knots, *more})


def _halfway(knots: list[int], knot: int, count: int) -> int:
    """A point of a ring in the middle of the longer stretch beside a knot."""
    place = knots.index(knot)
    before, after = (knot - knots[place - 1]) % count, (knots[(place + 1) % len(knots)] - knot) % count
    return (knot + after // 2) % count if after >= before else (knot - before // 2) % count


def _sharp(ring: Ring, window: float) -> np.ndarray:
    """Corners of a ring, as a flag for each point: the ring turns there sharply within a window [mm]."""
    sides = np.roll(ring, -1, axis=0) - ring
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(sides, axis=1))])
    closed, total = np.concatenate([ring, ring[:1]]), lengths[-1]

    def at(shift: float) -> Ring:
        stations = (lengths[:-1] + shift) % total
        return np.stack([np.interp(stations, lengths, closed[:, axis]) for axis in (0, 1)], axis=1)

    coming, going = ring - at(-window), at(window) - ring
    turns = np.arctan2(going[:, 1], going[:, 0]) - np.arctan2(coming[:, 1], coming[:, 0])
    return np.abs((turns + np.pi) % (2 * np.pi) - np.pi) > _SHARP


def _sort_rings(rings: list[Ring]) -> tuple[Ring, tuple[Ring, ...]]:
    if not rings:
        raise InputError("no outline yet. Click to set its corners")
    areas = [abs(Polygon(ring).area) if len(ring) > 2 else 0.0 for ring in rings]
    rim = int(np.argmax(areas))
    return rings[rim], tuple(ring for index, ring in enumerate(rings) if index != rim)


def _path(loop: Loop, corner: np.ndarray) -> str:
    """A loop as it stands in an SVG file, from a corner of the page, y down."""
    starts, first, second = (np.array([1.0, -1.0]) * (points - corner) for points in handles(loop))
    ends = np.roll(starts, -1, axis=0)
    parts = [f"M {_pair(starts[0])}"]
    for index in range(len(loop)):
        straight = not (loop[index].smooth or loop[(index + 1) % len(loop)].smooth)
        if straight:
            parts.append(f"L {_pair(ends[index])}")
        else:
            parts.append(f"C {_pair(first[index])} {_pair(second[index])} {_pair(ends[index])}")
    return " ".join([*parts, "Z"])


def _pair(point: np.ndarray) -> str:
    return f"{point[0]:.3f},{point[1]:.3f}"
