"""`high_points`: where air stays when a cavity is filled."""

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Vector

_TOP = 0.5
"""What lies less than that below a high point belongs to it [mm]."""


def high_points(
    vertices: Float[np.ndarray, "vertices 3"],
    triangles: Int[np.ndarray, "triangles 3"],
    up: Float[np.ndarray, "3"],
    *,
    rise: float,
) -> Int[np.ndarray, " points"]:
    """Vertices of a cavity's surface that are its local high points, the highest first.

    Only those that rise from the highest pass to a higher one by `rise` [mm] or more, and only ceilings: the top of a
    bump of the mould into the cavity holds no air.
    """
    heights = vertices @ up
    neighbours = _neighbours(len(vertices), triangles)
    summits = [summit for summit, prominence in _summits(heights, neighbours) if prominence >= rise]
    ceilings = _facing(vertices, triangles) @ up > 0
    middles = [_middle(summit, vertices, heights, neighbours) for summit in summits if ceilings[summit]]
    return np.array(middles, dtype=np.int64)


def _summits(heights: Vector, neighbours: list[list[int]]) -> list[tuple[int, float]]:
    """Each local maximum with how far it stands above the highest pass to a higher one, by falling height."""
    order = np.argsort(-heights, kind="stable")
    peak = np.full(len(heights), -1, dtype=np.int64)
    parent = list(range(len(heights)))
    found: list[tuple[int, float]] = []

    def root(vertex: int) -> int:
        while parent[vertex] != vertex:
            parent[vertex] = parent[parent[vertex]]
            vertex = parent[vertex]
        return vertex

    for vertex in order.tolist():
        regions = {root(other) for other in neighbours[vertex] if peak[other] >= 0}
        if not regions:
            peak[vertex] = vertex
            continue
        highest = max(regions, key=lambda region: (heights[peak[region]], -peak[region]))
        peak[vertex] = peak[highest]
        parent[vertex] = highest
        for region in sorted(regions - {highest}):
            found.append((int(peak[region]), float(heights[peak[region]] - heights[vertex])))
            parent[region] = highest
    lasting = {root(vertex) for vertex in range(len(heights)) if peak[vertex] >= 0}
    found += [(int(peak[region]), float(np.ptp(heights))) for region in sorted(lasting)]
    return sorted(found, key=lambda summit: (-heights[summit[0]], summit[0]))


def _middle(summit: int, vertices: np.ndarray, heights: Vector, neighbours: list[list[int]]) -> int:
    """The vertex in the middle of the flat top round a summit."""
    top, waiting = {summit}, [summit]
    while waiting:
        for other in neighbours[waiting.pop()]:
            if other not in top and heights[other] > heights[summit] - _TOP:
                top.add(other)
                waiting.append(other)
    members = np.array(sorted(top))
    return int(members[np.argmin(np.linalg.norm(vertices[members] - vertices[members].mean(axis=0), axis=1))])


def _neighbours(count: int, triangles: Int[np.ndarray, "triangles 3"]) -> list[list[int]]:
    joined: list[list[int]] = [[] for _ in range(count)]
    for one, two, three in triangles.tolist():
        joined[one].append(two)
        joined[two].append(three)
        joined[three].append(one)
    return joined  # of a closed surface each edge is walked both ways, so all neighbours are there


def _facing(vertices: np.ndarray, triangles: np.ndarray) -> Float[np.ndarray, "vertices 3"]:
    """Outward direction at each vertex."""
    corners = vertices[triangles]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = np.zeros(vertices.shape)
    for corner in range(3):
        np.add.at(facing, triangles[:, corner], crosses)
    return facing
