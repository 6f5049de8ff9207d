"""`largest_distance`: how far two poses of one body are apart."""

import numpy as np

from hydrostat.arrays import Nodes


def largest_distance(one: Nodes, other: Nodes) -> float:
    """Largest distance of a node between two poses [m]."""
    return float(np.linalg.norm(one - other, axis=1).max())
