"""`Outline`: the closed boundary of a flat body; `Curve`: a closed ring walked by arc length."""

import re
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from shapely import Polygon, is_ccw
from shapely.validation import explain_validity

from hydrostat.arrays import Float, Points, Vector
from hydrostat.errors import OutlineError

Ring = Float[np.ndarray, "_ 2"]  # corners of a closed polygon [m], first point not repeated


@dataclass(frozen=True, eq=False)
class Outline:
    """One outer ring and any holes, as dense polygons.

    Raises OutlineError: a ring with fewer than three corners or not finite, no area, or rings that cross or touch.
    """

    exterior: Ring  # corners of the outer ring [m], first point not repeated; kept counter-clockwise, however given
    holes: tuple[Ring, ...] = ()  # corners of each hole [m]; kept clockwise, however given

    def __post_init__(self) -> None:
        object.__setattr__(self, "exterior", _ring(self.exterior, counter_clockwise=True))
        object.__setattr__(self, "holes", tuple(_ring(hole, counter_clockwise=False) for hole in self.holes))
        found = fault(self.polygon)
        if found:
            what, (x, y) = found
            raise OutlineError(f"the outline {what} at ({1e3 * x:.4g}, {1e3 * y:.4g}) mm: redraw it there")

    @cached_property
    def polygon(self) -> Polygon:
        """Same shape as a shapely polygon [m]."""
        return Polygon(self.exterior, self.holes)

    @property
    def rings(self) -> tuple[Ring, ...]:
        """Outer ring, then the holes [m]; the body lies to the left of each."""
        return (self.exterior, *self.holes)

    @property
    def area(self) -> float:
        """Area without the holes [m^2]."""
        return float(self.polygon.area)

    @property
    def size(self) -> float:
        """Longest side of the bounding box [m]."""
        return float(np.ptp(self.exterior, axis=0).max())


def fault(polygon: Polygon) -> tuple[str, tuple[float, float]] | None:
    """Describe the fault that keeps a polygon from being a body, and its position; None if there is none."""
    if polygon.is_valid and polygon.area > 0.0:
        return None
    explanation = explain_validity(polygon)
    place = re.search(r"\[(\S+) (\S+)\]", explanation)
    x, y = (place[1], place[2]) if place else polygon.exterior.coords[0][:2]
    point = float(x), float(y)
    crosses_itself = not all(ring.is_simple for ring in (polygon.exterior, *polygon.interiors))
    if not (polygon.convex_hull if crosses_itself else polygon).area > 0.0:
        return "has no area", point
    return ("crosses itself" if crosses_itself else "is crossed or touched by a hole"), point


def _ring(points: Ring, *, counter_clockwise: bool) -> Ring:
    """Read-only copy of a ring with the required orientation and without repeated points."""
    ring = np.array(points, dtype=float)
    if ring.ndim != 2 or ring.shape[1] != 2 or not np.isfinite(ring).all():
        raise OutlineError("an outline needs finite points in the plane, (points, 2)")
    ring = ring[np.any(ring != np.roll(ring, -1, axis=0), axis=1)]
    if len(ring) < 3:
        raise OutlineError(f"an outline needs three different corners at least, this one has {len(ring)}")
    if is_ccw(Polygon(ring).exterior) != counter_clockwise:
        ring = np.ascontiguousarray(ring[::-1])
    ring.setflags(write=False)
    return ring


Stations = Float[np.ndarray, " _"]  # arc lengths, or values at them


@dataclass(frozen=True, eq=False)
class Curve:
    """Closed polyline with a station [same unit as its points] for each place on it."""

    corners: Points  # (corners, 2), first point not repeated

    @cached_property
    def closed_corners(self) -> Points:
        """Corners with the first one repeated at the end."""
        return np.concatenate([self.corners, self.corners[:1]])

    @cached_property
    def stations(self) -> Vector:
        """Arc length at each point of `closed_corners`."""
        return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self.closed_corners, axis=0), axis=1))])

    @property
    def length(self) -> float:
        """Total length of the closed curve."""
        return float(self.stations[-1])

    def at(self, stations: Vector) -> Points:
        """Places at stations; these may run past either end."""
        wrapped = np.mod(stations, self.length)
        return np.column_stack([np.interp(wrapped, self.stations, self.closed_corners[:, axis]) for axis in range(2)])

    def tangents(self, stations: Vector, reach: float) -> Points:
        """Unit directions at stations, taken across `reach` to either side."""
        chords = self.at(stations + reach) - self.at(stations - reach)
        return chords / np.maximum(np.linalg.norm(chords, axis=1, keepdims=True), 1e-300)

    @cached_property
    def turning(self) -> Vector:
        """Angle turned to the left at each corner [rad], within (-pi, pi]."""
        edges = np.diff(self.closed_corners, axis=0)
        before = np.roll(edges, 1, axis=0)
        cross = before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0]
        return np.arctan2(cross, np.einsum("ij,ij->i", before, edges))

    def turning_angles(self, stations: Vector, reach: float) -> Vector:
        """Angle turned within `reach` to either side of each station [rad]."""
        places = self._three_turns
        total = np.concatenate([[0.0], np.cumsum(np.tile(self.turning, 3))])
        upper = np.searchsorted(places, stations + reach * (1 + 1e-9), side="right")
        lower = np.searchsorted(places, stations - reach * (1 + 1e-9), side="left")
        return total[upper] - total[lower]

    @cached_property
    def _three_turns(self) -> Stations:
        """Stations of the corners three times round."""
        return np.concatenate([self.stations[:-1] + turn * self.length for turn in (-1, 0, 1)])

    @cached_property
    def _unrolled_corners(self) -> Points:
        """Corners three times round, each where its station is."""
        return self.at(self._three_turns)

    def sagitta(self, start: float, end: float) -> float:
        """Largest distance of the curve from its chord between two stations, start < end."""
        first, last = np.searchsorted(self._three_turns, start, side="right"), np.searchsorted(self._three_turns, end)
        if first >= last:
            return 0.0
        ends = self.at(np.array([start, end]))
        inner = self._unrolled_corners[first:last] - ends[0]
        chord = ends[1] - ends[0]
        along = (inner * chord).sum(axis=1)
        fraction = np.clip(along / max(float((chord**2).sum()), 1e-300), 0.0, 1.0)
        return float(np.linalg.norm(inner - fraction[:, None] * chord, axis=1).max(initial=0.0))
