"""`least_squares`: the least of a sum of squares under linear limits."""

import numpy as np
from jaxtyping import Float
from scipy.linalg import solve_triangular
from scipy.optimize import nnls

Matrix = Float[np.ndarray, "rows size"]


def least_squares(
    matrix: Matrix,
    right: Float[np.ndarray, " rows"],
    limits: Float[np.ndarray, "limits size"],
    room: Float[np.ndarray, " limits"],
) -> Float[np.ndarray, " size"] | None:
    """The x that minimises |matrix x - right| with limits x <= room; None if nothing is within the limits.

    By a QR factorisation it becomes the problem of the least distance, and that one of nonnegative least squares
    (Lawson and Hanson 1974, chapter 23). `matrix` must have full column rank.
    """
    if not matrix.shape[1]:
        return np.zeros(0)
    q, r = np.linalg.qr(matrix)
    aim = q.T @ right
    rows = solve_triangular(r, limits.T, trans=1).T
    nearest = _least_distance(rows, room - rows @ aim)
    return None if nearest is None else solve_triangular(r, aim + nearest)


def _least_distance(
    rows: Float[np.ndarray, "limits size"], room: Float[np.ndarray, " limits"]
) -> Float[np.ndarray, " size"] | None:
    """The shortest z with rows z <= room."""
    lengths = np.linalg.norm(rows, axis=1)
    some = lengths > 0
    if (room[~some] < 0).any():
        return None
    rows, room = rows[some] / lengths[some, None], room[some] / lengths[some]
    far = -room.min(initial=0.0)
    if far <= 0.0:
        return np.zeros(rows.shape[1])
    stacked = np.vstack([-rows.T, -room / far])
    pushes, _ = nnls(stacked, np.eye(len(stacked))[-1])
    left = stacked @ pushes
    left[-1] -= 1.0
    if -left[-1] < _INCONSISTENT:
        return None
    return -far * left[:-1] / left[-1]


_INCONSISTENT = 1e-12
"""The left-over of the nonnegative problem is 1 / (1 + |z|^2); below this no z is within the limits."""
