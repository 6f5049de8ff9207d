"""`order_by_minimum_degree`: SuperLU's order of elimination, without the import of all of SciPy's sparse algebra."""

import numpy as np

from hydrostat.arrays import Int
from hydrostat.lazy import load_compiled


def order_by_minimum_degree(
    starts: Int[np.ndarray, " _"], neighbors: Int[np.ndarray, " _"]
) -> Int[np.ndarray, " nodes"]:
    """SuperLU's multiple minimum degree (Liu 1985), by an incomplete factorization that drops nearly all it finds."""
    nodes, degrees = len(starts) - 1, np.diff(starts)
    rows = np.concatenate([neighbors, np.arange(nodes)])
    columns = np.concatenate([np.repeat(np.arange(nodes), degrees), np.arange(nodes)])
    data = np.concatenate([np.full(len(neighbors), -1.0), degrees + 1.0])
    sorting = np.lexsort((rows, columns))
    data, rows = data[sorting], rows[sorting].astype(np.intc)
    indptr = np.append(0, np.cumsum(degrees + 1)).astype(np.intc)
    superlu = load_compiled("scipy.sparse.linalg._dsolve._superlu")
    if superlu is not None:
        options = {"ILU_DropTol": 1e9, "ILU_FillFactor": 1, "ColPerm": "MMD_AT_PLUS_A"}
        try:
            factors = superlu.gstrf(
                nodes, len(data), data, rows, indptr, csc_construct_func=None, ilu=True, options=options
            )
            return np.argsort(factors.perm_c)
        except (AttributeError, TypeError, ValueError):  # another version of SciPy
            pass
    return _order_by_scipy(data, rows, indptr)


def _order_by_scipy(data: np.ndarray, rows: np.ndarray, indptr: np.ndarray) -> Int[np.ndarray, " nodes"]:
    """Return the same order by SciPy's public function."""
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import spilu

    graph = csc_array((data, rows, indptr), shape=(len(indptr) - 1,) * 2)
    return np.argsort(spilu(graph, drop_tol=1e9, fill_factor=1, permc_spec="MMD_AT_PLUS_A").perm_c)
