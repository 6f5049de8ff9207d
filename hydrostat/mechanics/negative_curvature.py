"""`find_negative_curvature`: along which an equilibrium that is no minimum is left."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.mechanics.stiffness import Stiffness


def find_negative_curvature(stiffness: Stiffness, size: int) -> Vector | None:
    """Find a mode of negative curvature, largest entry 1: that of the most negative eigenvalue of H^-1, by Lanczos.

    None if Lanczos does not arrive.
    """
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh  # Imported here: seldom needed.

    inverse = LinearOperator((size, size), matvec=stiffness.solve, dtype=float)  # pyright: ignore[reportCallIssue]
    start = np.random.default_rng(0).standard_normal(size)
    try:
        mode = eigsh(inverse, k=1, which="SA", v0=start, tol=1e-3)[1][:, 0]  # pyright: ignore[reportArgumentType]
    except ArpackError:
        return None
    return mode / np.abs(mode).max()
