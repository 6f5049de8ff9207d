"""`Factorisation`: a symmetric sparse matrix ready to be solved with."""

import numpy as np
from jaxtyping import Float
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu


class Factorisation:
    """LU without pivoting of a symmetric matrix; the signs of its pivots are those of the eigenvalues.

    Attributes:
        definite: whether the matrix is positive definite.
        singular: whether the factorisation broke down; then `solve` must not be called.
    """

    def __init__(self, matrix: csc_array) -> None:
        """Factorise a symmetric matrix."""
        self.definite = False
        self.singular = True
        try:
            self._lu = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except RuntimeError:
            return
        pivots = self._lu.U.diagonal()
        self.singular = not bool(np.isfinite(pivots).all() and (pivots != 0).all())
        unpivoted = bool((self._lu.perm_r == self._lu.perm_c).all())
        self.definite = not self.singular and unpivoted and bool((pivots > 0).all())

    def solve(self, right: Float[np.ndarray, "dofs *columns"]) -> Float[np.ndarray, "dofs *columns"]:
        """Solution of matrix @ x = right, for one or several right-hand sides."""
        return self._lu.solve(np.ascontiguousarray(right))
