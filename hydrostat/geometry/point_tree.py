"""`build_point_tree`: SciPy's k-d tree, without the import of scipy.spatial."""

from typing import Any

from hydrostat.arrays import Points
from hydrostat.lazy import load_compiled


def build_point_tree(points: Points) -> Any:
    """Build `scipy.spatial.KDTree`, or the compiled class beneath it, which loads 0.1 s sooner."""
    compiled = load_compiled("scipy.spatial._ckdtree")
    if compiled is not None and hasattr(compiled, "cKDTree"):
        return compiled.cKDTree(points, leafsize=_LEAF)
    from scipy.spatial import KDTree

    return KDTree(points, leafsize=_LEAF)


_LEAF = 10
"""Points in a leaf, as in KDTree: the order of pairs depends on it."""
