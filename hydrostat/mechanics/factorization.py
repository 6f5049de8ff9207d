"""`SymbolicFactorization` and `Factorization`: a symmetric sparse matrix ready to be solved with.

A finite element matrix has one pattern and is factorized thousands of times. So all that follows from the pattern is
done once, by the `SymbolicFactorization`:

1. An order of the nodes in which little fills in, the cheaper of nested dissection (George 1973; `ordering`) and
   SuperLU's minimum degree, by a model of time.
2. The elimination tree (Liu 1990), supernodes, and how much they are merged (`symbolic`).
3. The place of every number (`supernodal.plan`).

A `Factorization` is then one call of compiled code: the multifrontal method (Duff and Reid 1983; `fronts`). There
is no pivoting: an indefinite matrix may lose digits, and one that meets a tiny pivot is called singular. That suits
Newton, which wants to know whether a matrix is definite, and solves mostly with those that are.

SuperLU does the same from outside: slower, and independent. Figures: docs/decisions/0007-factorization.md.
"""

from typing import TYPE_CHECKING, Literal, Protocol, runtime_checkable

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Vector
from hydrostat.mechanics import ordering, symbolic
from hydrostat.mechanics.ordering import order_by_minimum_degree
from hydrostat.mechanics.supernodal import SupernodalAnalysis

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Backend = Literal["auto", "supernodal", "superlu"]

PIVOT_TOLERANCE = 1e-13
"""A pivot not above this share of the largest diagonal entry counts as 0."""


SHARES = np.array([0.4, 0.5, 0.6])
"""Fractions of the nodes on one side at which nested dissection tries to cut."""

DISTANCES = 3
"""Number of graph distances that serve as coordinates, in addition to the points if there are any."""

ORDERING = 12e-6
"""Modelled time to find an elimination order [s], per node."""

FACTORIZATIONS = 200
"""So many factorizations of one pattern are counted on."""


@runtime_checkable
class Factors(Protocol):
    """Contract of the factors that a back end computes for one matrix."""

    negative: int
    singular: bool

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for one or several right-hand sides."""
        ...

    def reduce(self, right: np.ndarray) -> np.ndarray:
        """Forward half of a solve."""
        ...

    def inner(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        """a^T A^-1 b from the forward halves of a and b."""
        ...

    def expand(self, reduced: np.ndarray) -> np.ndarray:
        """Solution from its forward half, or from a sum of such."""
        ...


class SymbolicFactorization:
    """Symbolic analysis shared by the factorizations of all matrices with one sparsity pattern.

    Threads may share it.

    Attributes:
        backend: name of the back end that factorizes, "supernodal" or "superlu".
        tree: supernodal elimination tree; only with the supernodal back end.
        found: modeled time [s] of a factorization of the pattern for which this order was found.
    """

    def __init__(
        self,
        indptr: Int[np.ndarray, " _"],
        indices: Int[np.ndarray, " _"],
        *,
        dim: int,
        points: Nodes | None = None,
        like: "SymbolicFactorization | None" = None,
        uses: int = FACTORIZATIONS,
        backend: Backend = "auto",
    ) -> None:
        """Analyze the pattern of a symmetric matrix.

        Args:
            indptr: start of each column, (dofs + 1,), as in `csc_array`.
            indices: rows of the entries, rising in each column; both triangles.
            dim: degrees of freedom of a node, side by side.
            points: positions of the nodes, (nodes, any dimension).
            like: analysis of a pattern with fewer entries; its order is taken where a better one would not pay.
            uses: expected number of factorizations, by which that order competes with a new one.
            backend: who factorizes.

        Raises:
            ValueError: `dim` does not divide the degrees of freedom, or there are more or fewer points than nodes.
        """
        size = len(indptr) - 1
        if size % dim or (points is not None and len(points) * dim != size):
            count = "no" if points is None else len(points)
            raise ValueError(f"{size} degrees of freedom, {dim} a node, do not go with {count} points")
        self.backend = "supernodal" if backend == "auto" else backend
        indptr, indices = (np.require(array, np.int32, ["C", "W"]) for array in (indptr, indices))
        self._indptr, self._indices, self._size = indptr, indices, size
        if self.backend == "supernodal":
            known = None if like is None or like.backend != self.backend else (like.tree, like.found, uses)
            self.tree, self.found = _cheapest_tree(indptr, indices, dim, points, known)
            self._supernodal = SupernodalAnalysis(self.tree, indptr, indices, dim)

    def factorize(self, data: Vector) -> "Factorization":
        """Factorize the matrix with these values, in the order of `indices`."""
        if self.backend == "supernodal":
            return Factorization(self._supernodal.factorize(np.require(data, float, ["C", "W"]), PIVOT_TOLERANCE))
        from scipy.sparse import csc_array

        matrix = csc_array((data, self._indices, self._indptr), shape=(self._size, self._size))
        return Factorization(SuperLUFactors(matrix))


class Factorization:
    """Factorization A = L S L^T with S = diag(+-1), or an equivalent one.

    Attributes:
        negative: number of negative pivots, which is the number of negative eigenvalues.
        singular: True if a pivot was 0, too small or not finite; then `solve` must not be called.
    """

    def __init__(self, factors: Factors) -> None:
        """Wrap the factors that a back end computed for a matrix."""
        self._factors = factors
        self.negative = self._factors.negative
        self.singular = self._factors.singular

    @property
    def definite(self) -> bool:
        """True if the matrix is positive definite."""
        return not self.singular and self.negative == 0

    def solve(self, right: Float[np.ndarray, "dofs *columns"]) -> Float[np.ndarray, "dofs *columns"]:
        """Solution of matrix @ x = right, for one or several right-hand sides."""
        return self._factors.solve(right)

    def reduce(self, right: Float[np.ndarray, "dofs *columns"]) -> np.ndarray:
        """Forward half of a solve, (dofs, columns), in an order and scale of its own; it is linear in `right`."""
        return self._factors.reduce(right)

    def inner(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        """a^T matrix^-1 b from the forward halves of a and b."""
        return self._factors.inner(one, other)

    def expand(self, reduced: np.ndarray) -> Float[np.ndarray, "dofs *columns"]:
        """Solution of matrix @ x = right from the forward half of `right`, or from a sum of such."""
        return self._factors.expand(reduced)


def factorize(matrix: "csc_array") -> Factorization:
    """Factorize one symmetric matrix whose pattern is not used again."""
    return Factorization(SuperLUFactors(matrix))


class SuperLUFactors:
    """LU without row exchanges of a symmetric matrix.

    Attributes:
        singular: True if the factorization broke down or exchanged rows.
        negative: number of negative pivots.
    """

    def __init__(self, matrix: "csc_array") -> None:
        """Factorize a symmetric matrix."""
        from scipy.sparse.linalg import splu

        self.singular, self.negative = True, 0
        diagonal = np.abs(matrix.diagonal())
        if not np.isfinite(matrix.data).all():
            return
        try:
            self._lu = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except RuntimeError:
            return
        pivots = self._lu.U.diagonal()
        unpivoted = bool((self._lu.perm_r == self._lu.perm_c).all())
        large = np.isfinite(pivots) & (np.abs(pivots) > PIVOT_TOLERANCE * diagonal.max(initial=0.0))
        self.singular = not (unpivoted and bool(large.all()))
        self.negative = 0 if self.singular else int((pivots < 0).sum())

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for one or several right-hand sides."""
        return self._lu.solve(np.ascontiguousarray(right))

    def reduce(self, right: np.ndarray) -> np.ndarray:
        """Right-hand sides themselves: SuperLU solves no half that is symmetric."""
        return right

    def inner(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        """a^T A^-1 b."""
        return one.T @ self.solve(other)

    def expand(self, reduced: np.ndarray) -> np.ndarray:
        """Solution for the vectors that were given to `reduce`."""
        return self.solve(reduced)


def _cheapest_tree(
    indptr: np.ndarray,
    indices: np.ndarray,
    dim: int,
    points: Nodes | None,
    known: tuple[symbolic.EliminationTree, float, int] | None,
) -> tuple[symbolic.EliminationTree, float]:
    """Return the supernodes of the best known elimination order, or of a given order if a search would not pay.

    With the modeled time of a factorization for which the order was found [s].
    """
    starts, neighbors = ordering.block_graph(indptr, indices, dim)
    if known is not None:
        tree, (_, found, uses) = symbolic.supernodes(starts, neighbors, known[0].order, dim), known
        if uses * (tree.seconds - found) <= ORDERING * len(tree.order):
            return tree, found
    orders = [order_by_minimum_degree(starts, neighbors)]
    if known is None or known[2] >= FACTORIZATIONS:  # else it takes longer than it saves
        distances = ordering.graph_coordinates(starts, neighbors, DISTANCES)
        coordinates = distances if points is None else np.hstack([points, distances])
        leaf = 64  # Parts of so many nodes are ordered by minimum degree
        orders.insert(0, ordering.nested_dissection(starts, neighbors, coordinates, leaf, SHARES))
    trees = [symbolic.supernodes(starts, neighbors, order, dim) for order in orders]
    best = min(trees, key=lambda tree: tree.seconds)
    return best, best.seconds
