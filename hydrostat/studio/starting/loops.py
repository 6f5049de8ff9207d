"""`Corner`, `read_loops`, `loops_svg`, `fitted`: an outline as few corners, as a person draws it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from shapely import LinearRing, Polygon, get_coordinates

from hydrostat.arrays import Points
from hydrostat.errors import InputError
from hydrostat.geometry.outline import Outline

HANDLE = 0.35
"""Length of the handles of a curve, in distances of its ends: the one that fits circles of four to eight corners best.
The editor on the screen has the same number."""

FURTHEST = 20_000.0
"""No corner is farther from the middle [mm]."""

MOST_LOOPS, MOST_CORNERS = 50, 1000
"""So many loops, so many corners in all."""

_STATIONS = np.linspace(0.0, 1.0, 17)[:-1]
_GOOD_FIT = 0.004
_SHARP = np.deg2rad(50.0)


@dataclass(frozen=True)
class Corner:
    """A corner of a loop.

    Attributes:
        x: to the right [mm].
        y: up [mm].
        smooth: whether the outline runs through it in a curve.
    """

    x: float
    y: float
    smooth: bool = False


Loop = tuple[Corner, ...]
"""Corners in order, the last joined to the first."""


def read_loops(raw: Any) -> tuple[Loop, ...]:
    """Loops as a screen sends them: lists of [x, y, smooth].

    Raises:
        InputError: they are no such thing, or too many.
    """
    try:
        loops = tuple(tuple(Corner(float(x), float(y), bool(smooth)) for x, y, smooth in loop) for loop in raw)
    except (TypeError, ValueError, OverflowError):
        raise InputError("the outline that was sent is not understood") from None
    if len(loops) > MOST_LOOPS or sum(map(len, loops)) > MOST_CORNERS:
        raise InputError(f"an outline has at most {MOST_LOOPS} loops and {MOST_CORNERS} corners")
    for corner in (corner for loop in loops for corner in loop):
        if not all(isfinite(value) and abs(value) <= FURTHEST for value in (corner.x, corner.y)):
            raise InputError(f"a corner of the outline is farther than {FURTHEST / 1e3:g} m from the middle")
    return loops


def send_loops(loops: Iterable[Loop]) -> list[list[list[Any]]]:
    """What a screen is sent; the other way round than `read_loops`."""
    return [[[corner.x, corner.y, corner.smooth] for corner in loop] for loop in loops]


def handles(loop: Loop) -> tuple[Points, Points, Points]:
    """For each side its start and its two handles [mm]; those of a straight side lie on it."""
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


def curve(loop: Loop) -> Points:
    """Points along a loop [mm]."""
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
        InputError: there is no loop.
    """
    return Outline(*_sorted([1e-3 * curve(loop) for loop in loops]))


def loops_svg(loops: Sequence[Loop]) -> tuple[bytes, tuple[float, float]]:
    """The loops as a drawing in millimetres, and what of theirs lies in its upper left corner [mm].

    Raises:
        OutlineError: as for `outline_of`.
        InputError: there is no loop.
    """
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


def fitted(outline: Outline) -> tuple[Loop, ...]:
    """As few corners as follow an outline to a share of its size."""
    return tuple(_fitted(1e3 * ring, 1e3 * outline.size) for ring in outline.rings)


def _fitted(ring: Points, size: float) -> Loop:
    """The coarsest of a few simplifications that is true to the ring [mm]."""
    rim = LinearRing(ring)
    loop: Loop = ()
    for share in (0.04, 0.03, 0.02, 0.015, 0.01, 0.007, 0.005, 0.003, 0.002):
        kept = get_coordinates(Polygon(ring).simplify(share * size))[:-1]
        if len(kept) < 3:
            continue
        for smooth in (np.abs(_turns(kept)) < _SHARP, np.zeros(len(kept), dtype=bool)):
            pairs = zip(kept, smooth, strict=True)
            loop = tuple(Corner(round(float(x), 2), round(float(y), 2), bool(is_smooth)) for (x, y), is_smooth in pairs)
            if rim.hausdorff_distance(LinearRing(curve(loop))) < _GOOD_FIT * size:
                return loop
    return loop


def _turns(ring: Points) -> np.ndarray:
    """By which angle a ring turns at each corner."""
    sides = np.roll(ring, -1, axis=0) - ring
    angles = np.arctan2(sides[:, 1], sides[:, 0])
    return (angles - np.roll(angles, 1) + np.pi) % (2 * np.pi) - np.pi


def _sorted(rings: list[Points]) -> tuple[Points, tuple[Points, ...]]:
    if not rings:
        raise InputError("there is no outline yet; click to set its corners")
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
