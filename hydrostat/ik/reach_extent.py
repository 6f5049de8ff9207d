"""`reach_extent`: extent of the marker workspace in every direction, to first order at one pose."""

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Vector


def reach_extent(moves: Float[np.ndarray, "rows winches"], spans: Vector, *, dim: int, floor: float) -> float:
    """Geometric mean over markers of the mean half-axis of the ellipsoid that a box of contractions brings each to [m].

    For each marker it is the 2 dim-th root of det(J S^2 J^T + floor^2 I), that is, up to a factor, the dim-th root of
    the ellipsoid's volume. So a marker that only goes to and fro along a line counts little, and one that nothing moves
    counts as `floor`.

    Args:
        moves: slopes of the coordinates of the markers by the contractions, marker after marker.
        spans: admissible contraction change of each winch to either side [m].
        dim: coordinates of a marker.
        floor: extent that counts as no reach at all [m], above 0.
    """
    if not moves.size:
        return floor
    scaled = (moves * spans).reshape(-1, dim, moves.shape[1])
    squares = scaled @ scaled.transpose(0, 2, 1) + floor**2 * np.eye(dim)
    return float(np.exp(np.linalg.slogdet(squares)[1].mean() / (2 * dim)))


def usable_spans(
    pulls: Float[np.ndarray, "cables winches"], ranges: Vector, tension: float
) -> Float[np.ndarray, " winches"]:
    """Share of each winch's range that its hardest cable lets it go, to first order [m].

    Args:
        pulls: slopes of the tensions by the contractions [N/m].
        ranges: travel and release of each winch [m].
        tension: maximum cable tension [N].
    """
    hardest = np.abs(pulls).max(axis=0, initial=0.0)
    return np.minimum(ranges, tension / np.maximum(hardest, 1e-12))
