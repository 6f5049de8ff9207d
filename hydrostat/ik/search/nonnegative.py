"""`solve_nonnegative`, `solve_upper`: small solvers, without the imports of SciPy's packages."""

import numpy as np
from jaxtyping import Float

from hydrostat.lazy import load_compiled


def solve_nonnegative(
    matrix: Float[np.ndarray, "rows size"], right: Float[np.ndarray, " rows"]
) -> Float[np.ndarray, " size"]:
    """Minimize |matrix x - right| with x >= 0 (Lawson and Hanson 1974), as `scipy.optimize.nnls` does.

    Raises:
        ValueError: a number that is not finite.
        RuntimeError: too many iterations.
    """
    matrix, right = np.asarray_chkfinite(matrix, float, "C"), np.asarray_chkfinite(right, float)
    solver = load_compiled("scipy.optimize._slsqplib")
    if solver is not None and hasattr(solver, "nnls"):
        try:
            found, _, code = solver.nnls(matrix, right, 3 * matrix.shape[1])
        except (TypeError, ValueError):  # another version of SciPy
            pass
        else:
            if code == _EXCEEDED:
                raise RuntimeError("Maximum number of iterations reached.")
            return found
    from scipy.optimize import nnls

    return nnls(matrix, right)[0]


def solve_upper(
    triangle: Float[np.ndarray, "size size"], right: Float[np.ndarray, "size *columns"], *, transposed: bool = False
) -> Float[np.ndarray, "size *columns"]:
    """Solve with an upper triangle, or with its transpose.

    NumPy exchanges no rows of an upper triangle, thus its LU factors are the triangle itself. A lower one is upper in
    reverse order.
    """
    if transposed:
        return np.linalg.solve(triangle.T[::-1, ::-1], right[::-1])[::-1]
    return np.linalg.solve(triangle, right)


_EXCEEDED = 3
