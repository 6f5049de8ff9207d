"""`Draft`: a mesh in the making, boundary nodes as stations on their curves, and its constrained Delaunay triangles."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from shapely import Polygon, contains_xy

from hydrostat.arrays import Bool, Elements, Float, Int, Points
from hydrostat.geometry.outline import Curve

Edges = Int[np.ndarray, "_ 2"]  # pairs of point indices


def triangles_inside(points: Points, edges: Edges, polygon: Polygon) -> tuple[Elements, Edges]:
    """Triangulate the inside of a polygon, given its sides, its corners and any points inside it, about one apart.

    Returns positively oriented triangles, and the sides that could not be had (split these).
    """
    from scipy.spatial import Delaunay  # Imported here: not every command needs it.

    triangles = Delaunay(points).simplices.astype(np.int64)
    for start, end in missing(triangles, edges):
        triangles = _with_edge(points, triangles, int(start), int(end))
    doubled = doubled_areas(points, triangles)
    triangles[doubled < 0] = triangles[doubled < 0][:, ::-1]
    middle = points[triangles].mean(axis=1)
    inside = contains_xy(polygon, middle[:, 0], middle[:, 1]) & (np.abs(doubled) > 1e-9)
    return triangles[inside], missing(triangles[inside], edges)


def doubled_areas(points: Points, triangles: Elements) -> np.ndarray:
    """Twice the signed area of each triangle."""
    first, second = (points[triangles[:, corner]] - points[triangles[:, 0]] for corner in (1, 2))
    return first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]


def missing(triangles: Elements, edges: Edges) -> Edges:
    """Edges that no triangle has."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    base = int(max(triangles.max(initial=0), edges.max(initial=0))) + 1
    return edges[~np.isin(_keys(edges, base), _keys(sides, base))]


def _keys(pairs: Edges, base: int) -> np.ndarray:
    """One number for each undirected pair."""
    return pairs.min(axis=1) * base + pairs.max(axis=1)


def _with_edge(points: Points, triangles: Elements, start: int, end: int) -> Elements:
    """Force an edge in: take out what it crosses, fill either side again (Anglada 1997); not where it meets a point."""
    side = _side(points, start, end)
    shared = (triangles == start) | (triangles == end)
    crossing = np.zeros(len(triangles), dtype=bool)
    for first, second in ((0, 1), (1, 2), (2, 0)):
        a, b = triangles[:, first], triangles[:, second]
        apart = side[a] * side[b] < 0.0
        across = _cross(points[b] - points[a], points[start] - points[a])
        across = across * _cross(points[b] - points[a], points[end] - points[a]) < 0.0
        crossing |= apart & across & ~shared[:, first] & ~shared[:, second]
    cavity = {(int(a), int(b)) for t in triangles[crossing] for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))}
    follow = {a: b for a, b in cavity if (b, a) not in cavity}
    left, right = _walk(follow, end, start), _walk(follow, start, end)
    if not left or not right or len(left) + len(right) - 2 != len(follow) + 0:
        return triangles
    filled = [*_fill(points, start, end, left[1:-1]), *_fill(points, end, start, right[1:-1])]
    if len(filled) != int(crossing.sum()):
        return triangles
    return np.concatenate([triangles[~crossing], np.array(filled, dtype=triangles.dtype)])


def _side(points: Points, start: int, end: int) -> np.ndarray:
    """Positive for points to the left of a line through two of them."""
    return _cross(points[end] - points[start], points - points[start])


def _cross(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Cross product in the plane."""
    return first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]


def _walk(follow: dict[int, int], start: int, end: int) -> list[int]:
    """Chain of points from start to end; empty if there is none."""
    chain = [start]
    while chain[-1] != end:
        if chain[-1] not in follow or len(chain) > len(follow):
            return []
        chain.append(follow[chain[-1]])
    return chain


def _fill(points: Points, start: int, end: int, chain: list[int]) -> list[tuple[int, int, int]]:
    """Delaunay triangles between an edge and the chain of points to its left, which runs from end to start."""
    if not chain:
        return []
    best = 0
    for index in range(1, len(chain)):
        if _in_circle(points[[start, end, chain[best]]], points[chain[index]]):
            best = index
    apex = chain[best]
    before, after = _fill(points, apex, end, chain[:best]), _fill(points, start, apex, chain[best + 1 :])
    return [(start, end, apex), *before, *after]


def _in_circle(triangle: Points, point: np.ndarray) -> bool:
    """Return True if a point lies inside the circumcircle of a positively oriented triangle."""
    spans = triangle - point
    return bool(np.linalg.det(np.column_stack([spans, np.einsum("ij,ij->i", spans, spans)])) > 0.0)


@dataclass(frozen=True, eq=False)
class Division:
    """Nodes on one ring of the outline, all lengths in units of the element size."""

    curve: Curve  # the ring
    stations: Float[np.ndarray, " nodes"]  # arc length of each node, increasing
    fixed: Bool[np.ndarray, " nodes"]  # True for a corner node, which must stay

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
        """Largest distance of the ring from each edge."""
        return np.array([self.curve.sagitta(start, end) for start, end in zip(self.stations, self.ends, strict=True)])


@dataclass(frozen=True, eq=False)
class Draft:
    """Divided rings and points inside; the triangles follow from them."""

    divisions: tuple[Division, ...]  # the outer ring, then the holes
    interior: Points  # points inside, (points, 2), in units of the element size

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
        """Sides of the rings."""
        rings = [np.arange(first, last) for first, last in zip(self.starts, self.starts[1:], strict=False)]
        return np.concatenate([np.column_stack([ring, np.roll(ring, -1)]) for ring in rings])

    @cached_property
    def polygon(self) -> Polygon:
        """Body that the boundary nodes span."""
        rings = [part.curve.at(part.stations) for part in self.divisions]
        return Polygon(rings[0], rings[1:])

    @cached_property
    def _triangulation(self) -> tuple[Elements, Edges]:
        return triangles_inside(self.points, self.edges, self.polygon)

    @property
    def triangles(self) -> Elements:
        """Constrained Delaunay triangles."""
        return self._triangulation[0]

    @property
    def missing_sides(self) -> Edges:
        """Sides that no triangle has; they must be split."""
        return self._triangulation[1]

    def place(self, node: int) -> tuple[int, int]:
        """Ring and number on it of a boundary node; ring -1 and number inside for the others."""
        ring = int(np.searchsorted(self.starts, node, side="right")) - 1
        return (ring if ring < len(self.divisions) else -1), node - int(self.starts[ring])

    def with_division(self, ring: int, division: Division) -> "Draft":
        """Draft with one ring divided otherwise."""
        parts = (*self.divisions[:ring], division, *self.divisions[ring + 1 :])
        return Draft(parts, self.interior)
