"""`clearance`: how far points are from the boundary of a mesh."""

from itertools import chain

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Points
from hydrostat.geometry.anchors import nearest_shares
from hydrostat.geometry.mesh import Mesh


def clearance(mesh: Mesh, points: Points) -> Float[np.ndarray, " points"]:
    """Distance of each point from the nearest place of the boundary [m], from inside or outside alike.

    Exact: a facet nearer than the nearest middle of one lies, with its own middle, within that distance and its radius.
    """
    from scipy.spatial import KDTree

    if not len(points):
        return np.zeros(0)
    corners = mesh.nodes[mesh.boundary]
    middles = corners.mean(axis=1)
    largest = np.linalg.norm(corners - middles[:, None], axis=2).max()
    tree = KDTree(middles)
    bound = tree.query(points)[0]
    near = tree.query_ball_point(points, bound * (1 + 1e-9) + largest)
    counts = np.array([len(some) for some in near])
    facets = np.fromiter(chain.from_iterable(near), np.int64, counts.sum())
    asked = np.repeat(points, counts, axis=0)
    places = np.einsum("fc,fcd->fd", nearest_shares(corners[facets], asked), corners[facets])
    distances = np.linalg.norm(places - asked, axis=1)
    return np.minimum.reduceat(distances, np.cumsum(counts) - counts)
