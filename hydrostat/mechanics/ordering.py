"""In which order to eliminate nodes, so that little fills in.

Nested dissection (George 1973): a set of nodes that separates a body into two halves is eliminated last, each half is
ordered in the same way. A body is cut across a coordinate, at one of a few shares of its nodes; the smallest set of
nodes that touches every cut edge is the separator: a least vertex cover of a bipartite graph, by Koenig's theorem from
a largest matching (Pothen, Simon and Liou 1990). Of all cuts that with the smallest ratio of the separator to the
product of the halves is taken. Small parts are ordered by minimum degree, which counts the separators around them too.

Without coordinates, distances in the graph from a few far-apart nodes serve as such (Harel and Koren 2002).

A graph is (starts, neighbors): those of node i are neighbors[starts[i]:starts[i + 1]], itself left out.
"""

import numpy as np

from hydrostat.arrays import Int
from hydrostat.kernel import native
from hydrostat.lazy import load_compiled

Graph = tuple[np.ndarray, np.ndarray]


def block_graph(indptr: np.ndarray, indices: np.ndarray, dim: int) -> Graph:
    """Graph of the nodes that share an entry of a matrix with `dim` degrees of freedom per node."""
    count = (len(indptr) - 1) // dim
    starts, neighbors = np.zeros(count + 1, np.int64), np.empty(len(indices), np.int64)
    native.block_graph(indptr, indices, dim, starts, neighbors, np.full(count, -1))
    return starts, neighbors[: starts[-1]].copy()


def graph_coordinates(starts: np.ndarray, neighbors: np.ndarray, count: int) -> np.ndarray:
    """Distances in the graph from `count` nodes, each the farthest from those before it, (nodes, count)."""
    nodes = len(starts) - 1
    queue = np.empty(nodes, np.int64)
    distances = np.full((count + 1, nodes), float(nodes))
    native.distances(starts, neighbors, 0, distances[count], queue)
    root = np.argmax(distances[count])
    for column in range(count):
        native.distances(starts, neighbors, root, distances[column], queue)
        root = np.argmax(distances[: column + 1].min(axis=0))
    return distances[:count].T


def nested_dissection(
    starts: np.ndarray, neighbors: np.ndarray, points: np.ndarray, leaf: int, shares: np.ndarray
) -> np.ndarray:
    """Order of elimination, (nodes,): the node to eliminate first, second, ...

    Parts of up to `leaf` nodes are not cut. `shares` are the parts of the nodes that a cut may leave on one side; it
    runs across a coordinate, a column of `points`.
    """
    nodes = len(starts) - 1
    points = np.ascontiguousarray(points.T)
    lines = np.argsort(points, axis=1, kind="stable")
    order, work = np.zeros(nodes, np.int64), np.full((3, nodes), -1)
    sides, todo = np.zeros((3, nodes), np.int64), np.zeros((nodes + 1, 2), np.int64)
    room = np.empty((3, nodes), np.int64)
    native.dissect(starts, neighbors, points, lines, leaf, shares, order, work, sides, todo, room)
    return order


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
