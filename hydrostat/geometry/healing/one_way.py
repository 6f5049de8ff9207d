"""Triangles turned one way, so that neighbours run along their common edge in opposite ways."""

import numpy as np
from jaxtyping import Bool, Int


def one_way(
    triangles: Int[np.ndarray, "triangles 3"],
) -> tuple[Int[np.ndarray, "triangles 3"], Bool[np.ndarray, " triangles"]]:
    """Triangles turned one way within each patch, the way of most of them, and which of them were turned for it.

    A patch is what edges with two triangles join.
    """
    import igl

    result, patches = igl.bfs_orient(triangles)
    patch = np.array(patches).astype(np.int64)
    turned = (np.array(result) != triangles).any(axis=1)
    most = 2 * np.bincount(patch, turned) > np.bincount(patch)
    turned ^= most[patch]
    return np.where(turned[:, None], triangles[:, ::-1], triangles), turned
