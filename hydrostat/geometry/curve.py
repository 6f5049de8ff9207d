"""`Curve`: a closed ring walked by arc length."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Points, Vector

Stations = Float[np.ndarray, " _"]
"""Arc lengths, or values at them."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A closed polyline with a station [same unit as its points] for each place on it.

    Attributes:
        corners: (corners, 2), first point not repeated.
    """

    corners: Points

    @cached_property
    def closed(self) -> Points:
        """The corners with the first one repeated at the end."""
        return np.concatenate([self.corners, self.corners[:1]])

    @cached_property
    def stations(self) -> Vector:
        """Arc length at each point of `closed`."""
        return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self.closed, axis=0), axis=1))])

    @property
    def length(self) -> float:
        """Length all the way round."""
        return float(self.stations[-1])

    def at(self, stations: Vector) -> Points:
        """Places at stations; these may run past either end."""
        wrapped = np.mod(stations, self.length)
        return np.column_stack([np.interp(wrapped, self.stations, self.closed[:, axis]) for axis in range(2)])

    def tangents(self, stations: Vector, reach: float) -> Points:
        """Unit directions at stations, taken across `reach` to either side."""
        chords = self.at(stations + reach) - self.at(stations - reach)
        return chords / np.maximum(np.linalg.norm(chords, axis=1, keepdims=True), 1e-300)

    @cached_property
    def turning(self) -> Vector:
        """Angle turned to the left at each corner [rad], within (-pi, pi]."""
        edges = np.diff(self.closed, axis=0)
        before = np.roll(edges, 1, axis=0)
        cross = before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0]
        return np.arctan2(cross, np.einsum("ij,ij->i", before, edges))

    def turned(self, stations: Vector, reach: float) -> Vector:
        """Angle turned within `reach` to either side of each station [rad]."""
        places, totals = self._unrolled()
        total = np.concatenate([[0.0], totals])
        upper = np.searchsorted(places, stations + reach * (1 + 1e-9), side="right")
        lower = np.searchsorted(places, stations - reach * (1 + 1e-9), side="left")
        return total[upper] - total[lower]

    def _unrolled(self) -> tuple[Vector, Vector]:
        """Stations of the corners three times round, and the angle turned up to each."""
        places = np.concatenate([self.stations[:-1] + turn * self.length for turn in (-1, 0, 1)])
        return places, np.cumsum(np.tile(self.turning, 3))

    def sagitta(self, start: float, end: float) -> float:
        """How far the curve strays from its chord between two stations, start < end."""
        ends = self.at(np.array([start, end]))
        between = np.concatenate([self.stations[:-1] + turn * self.length for turn in (-1, 0, 1)])
        inner = self.at(between[(between > start) & (between < end)]) - ends[0]
        chord = ends[1] - ends[0]
        along = (inner * chord).sum(axis=1)
        fraction = np.clip(along / max(float((chord**2).sum()), 1e-300), 0.0, 1.0)
        return float(np.linalg.norm(inner - fraction[:, None] * chord, axis=1).max(initial=0.0))
