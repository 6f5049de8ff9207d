"""Delaunay triangles inside a polygon whose edges all appear."""

import numpy as np
from jaxtyping import Int
from scipy.spatial import Delaunay
from shapely import Polygon, contains_xy

from hydrostat.arrays import Elements, Points

Edges = Int[np.ndarray, "_ 2"]
"""Pairs of point indices."""


def triangles_inside(points: Points, edges: Edges, polygon: Polygon) -> tuple[Elements, Edges]:
    """Triangulate the inside of a polygon.

    Args:
        points: corners of the polygon and any points inside it, about one apart.
        edges: the sides of the polygon.
        polygon: the same polygon.

    Returns:
        Positively oriented triangles, and the sides that could not be had (split these).
    """
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
    """The edges that no triangle has."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    base = int(max(triangles.max(initial=0), edges.max(initial=0))) + 1
    return edges[~np.isin(_keys(edges, base), _keys(sides, base))]


def _keys(pairs: Edges, base: int) -> np.ndarray:
    """One number for each undirected pair."""
    return pairs.min(axis=1) * base + pairs.max(axis=1)


def _with_edge(points: Points, triangles: Elements, start: int, end: int) -> Elements:
    """Force an edge in: take out the triangles it crosses and fill either side again (Anglada 1997).

    Returns the triangles unchanged where the edge runs through a point.
    """
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
    """The chain of points from start to end; empty if there is none."""
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
    """Whether a point lies inside the circle of a positively oriented triangle."""
    spans = triangle - point
    return bool(np.linalg.det(np.column_stack([spans, np.einsum("ij,ij->i", spans, spans)])) > 0.0)
