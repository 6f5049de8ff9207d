"""Tips of limbs: local maxima of the geodesic distance from where a body is held. `find_limb_tips`, `name_tips`."""

import numpy as np

from hydrostat.arrays import Bool, Int, Points, Vector
from hydrostat.geometry import Mesh

_MIN_PERSISTENCE = 0.15  # share of the longest distance by which a tip rises above the way to a farther one


def measure_geodesics(mesh: Mesh, held: Bool[np.ndarray, " nodes"]) -> tuple[Vector, Int[np.ndarray, " nodes"]]:
    """Geodesic distances of all nodes from those that are held, along edges [m], and the node before each (or < 0).

    Nodes that cannot be reached are at infinity.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra  # Imported here: not every command needs it.

    one, two = mesh.edges.T
    graph = coo_array((mesh.edge_lengths, (one, two)), shape=2 * (len(mesh.nodes),)).tocsr()
    away, before, _ = dijkstra(
        graph, directed=False, indices=np.flatnonzero(held), min_only=True, return_predecessors=True
    )
    return away, before


def find_limb_tips(mesh: Mesh, away: Vector) -> list[int]:
    """Nodes at the tips of limbs, the farthest first, of geodesic distances from where the body is held [m].

    A tip is a local maximum that rises by a seventh of the longest distance, and by two edges, above the way to a
    farther one (topological persistence: Edelsbrunner, Letscher and Zomorodian 2002).
    """
    height = np.where(np.isfinite(away), away, -1.0)
    least = max(_MIN_PERSISTENCE * float(height.max()), 2 * float(mesh.edge_lengths.mean()))
    order = np.argsort(-height, kind="stable")
    rank = np.empty(len(order), int)
    rank[order] = np.arange(len(order))
    neighbors: list[list[int]] = [[] for _ in order]
    for one, two in mesh.edges:
        neighbors[one].append(int(two))
        neighbors[two].append(int(one))
    peaks = np.full(len(order), -1)  # of each node, another node of its hill, nearer to the peak
    tips = [int(order[0])]
    for node in order[height[order] >= 0]:
        higher = {_climb(peaks, other) for other in neighbors[node] if rank[other] < rank[node]}
        hills = sorted(higher, key=rank.__getitem__)
        peaks[node] = hills[0] if hills else node
        for lower in hills[1:]:
            if height[lower] - height[node] >= least:
                tips.append(lower)
            peaks[lower] = hills[0]
    return sorted(tips, key=rank.__getitem__)


def _climb(peaks: Int[np.ndarray, " nodes"], node: int) -> int:
    while peaks[node] != node:
        node = int(peaks[node])
    return node


def name_tips(mesh: Mesh, tips: Points) -> list[str]:
    """Names of tips [m] by their places about the middle of the body, such as "upper left"; one alone is "tip".

    Twins get numbers from the outside, those at the top and the bottom from the left: halves that mirror each other
    have the same numbers. In space the two axes along which the tips are spread most name them.
    """
    if len(tips) == 1:
        return ["tip"]
    middle = (mesh.nodes.min(axis=0) + mesh.nodes.max(axis=0)) / 2
    axes = np.sort(np.argsort(-np.ptp(tips, axis=0), kind="stable")[:2])
    eighths = np.round(np.arctan2(*(tips - middle)[:, axes[::-1]].T) / (np.pi / 4)).astype(int) % 8
    names = np.array(_PLACES, dtype=object)[eighths]
    for name in set(names.tolist()):
        inwards = -1.0 if "right" in name else 1.0
        order = np.lexsort((-tips[:, axes[1]], inwards * tips[:, axes[0]]))
        twins = order[names[order] == name]
        if len(twins) > 1:
            names[twins] = [f"{name} {number}" for number in range(1, len(twins) + 1)]
    return names.tolist()


_PLACES = (  # counterclockwise
    "right",
    "upper right",
    "top",
    "upper left",
    "left",
    "lower left",
    "bottom",
    "lower right",
)
