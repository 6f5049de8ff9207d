"""`Draft`: a mesh in the making, boundary nodes as stations on their curves."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int
from shapely import Polygon

from hydrostat.arrays import Elements, Points
from hydrostat.geometry.curve import Curve
from hydrostat.geometry.triangles.delaunay import Edges, triangles_inside


@dataclass(frozen=True, eq=False)
class Division:
    """The nodes on one ring of the outline, all lengths in units of the element size.

    Attributes:
        curve: the ring.
        stations: arc length of each node, increasing.
        fixed: whether a node is a true corner, which must stay.
    """

    curve: Curve
    stations: Float[np.ndarray, " nodes"]
    fixed: Bool[np.ndarray, " nodes"]

    @property
    def ends(self) -> Float[np.ndarray, " nodes"]:
        """Station at which the edge that begins at each node ends."""
        return np.append(self.stations[1:], self.stations[0] + self.curve.length)

    def split(self, edge: int) -> "Division":
        """Halve an edge at the middle of its arc."""
        station = 0.5 * (self.stations[edge] + self.ends[edge])
        stations = np.mod(np.append(self.stations, station), self.curve.length)
        fixed = np.append(self.fixed, False)
        order = np.argsort(stations, kind="stable")
        return Division(self.curve, stations[order], fixed[order])

    def without(self, node: int) -> "Division":
        """Leave out a node."""
        return Division(self.curve, np.delete(self.stations, node), np.delete(self.fixed, node))

    def sagitta(self) -> Float[np.ndarray, " nodes"]:
        """How far the ring strays from each edge."""
        return np.array([self.curve.sagitta(start, end) for start, end in zip(self.stations, self.ends, strict=True)])


@dataclass(frozen=True, eq=False)
class Draft:
    """Divided rings and points inside; the triangles follow from them.

    Attributes:
        divisions: the outer ring, then the holes.
        interior: points inside, (points, 2), in units of the element size.
    """

    divisions: tuple[Division, ...]
    interior: Points

    @cached_property
    def points(self) -> Points:
        """All nodes: ring by ring, then the inside."""
        return np.concatenate([*(part.curve.at(part.stations) for part in self.divisions), self.interior])

    @cached_property
    def starts(self) -> Int[np.ndarray, " rings"]:
        """Number of the first node of each ring, and of the inside."""
        return np.concatenate([[0], np.cumsum([len(part.stations) for part in self.divisions])])

    @cached_property
    def edges(self) -> Edges:
        """The sides of the rings."""
        rings = [np.arange(first, last) for first, last in zip(self.starts, self.starts[1:], strict=False)]
        return np.concatenate([np.column_stack([ring, np.roll(ring, -1)]) for ring in rings])

    @cached_property
    def polygon(self) -> Polygon:
        """The body that the boundary nodes span."""
        rings = [part.curve.at(part.stations) for part in self.divisions]
        return Polygon(rings[0], rings[1:])

    @cached_property
    def _triangulated(self) -> tuple[Elements, Edges]:
        return triangles_inside(self.points, self.edges, self.polygon)

    @property
    def triangles(self) -> Elements:
        """Constrained Delaunay triangles."""
        return self._triangulated[0]

    @property
    def lost(self) -> Edges:
        """Sides that no triangle has; they must be split."""
        return self._triangulated[1]

    def place(self, node: int) -> tuple[int, int]:
        """Ring and number on it of a boundary node; ring -1 and number inside for the others."""
        ring = int(np.searchsorted(self.starts, node, side="right")) - 1
        return (ring if ring < len(self.divisions) else -1), node - int(self.starts[ring])

    def with_division(self, ring: int, division: Division) -> "Draft":
        """The draft with one ring divided otherwise."""
        parts = (*self.divisions[:ring], division, *self.divisions[ring + 1 :])
        return Draft(parts, self.interior)
