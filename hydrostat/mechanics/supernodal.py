"""Supernodal factors by multifrontal factorization A = L S L^T of a symmetric matrix, S = diag(+-1), without pivoting.

Every supernode has a front (Duff and Reid 1983): a dense matrix of its own columns and the rows below them. It collects
entries of A and what its children hand up (extend-add), eliminates its own columns, and hands the rest to its parent:

    [F11 .  ]   [L11  ] [S1  ] [L11^T L21^T]
    [F21 F22] = [L21 I] [   U] [      I    ]        U = F22 - L21 S1 L21^T

The signs S are those of the pivots; by Sylvester's law there are as many -1 as negative eigenvalues. A few columns at a
time are eliminated and applied to the rest by products of its own (native/fronts.hpp); pivots may be of either sign.

Own columns are kept in L ("panels": columns and rows together, column by column). What is handed up lies on one of two
stacks, in turn with the depth in the tree: then the children of a front are always on top of the other stack.
"""

import threading
from typing import Any, NamedTuple

import numpy as np

from hydrostat.kernel import THREADS, native
from hydrostat.mechanics.symbolic import EliminationTree, children

WHOLE, LOWER, UPPER = range(3)
"""Part of A^-1 that is applied: all of it, L^-1, or L^-T S."""

COLUMNS, BELOW, FIRST, PANEL, STARTS, CHILD, SIBLING, STACK, OFFSET, RUNS, ENTRIES = range(11)
"""Columns of `Fronts.table`."""


class Fronts(NamedTuple):
    """Memory layout of all fronts, counted in degrees of freedom. The table has a row for each front.

    Attributes:
        table: a row for every supernode and one more, (supernodes + 1, 11):
            COLUMNS, BELOW: size of a front, own columns and rows below them;
            FIRST: first own column;
            PANEL: start of its part of L;
            STARTS: start of its rows in `rows`;
            CHILD, SIBLING: first child, next child of the same parent; -1 if there is none;
            STACK: number of the stack, of two, that takes its contribution to the parent;
            OFFSET: start of this contribution on the stack;
            RUNS, ENTRIES: start of its runs and of its entries of A.
        rows: indices of the rows below every front, one front after the other.
        runs: rows below that are contiguous in the parent's front too: first row here, first there, count, (runs, 3).
        entries: place of each entry in the data of A and in the front's panel, (entries, 2).
        diagonal: places of the diagonal in the data of A; -1 for a missing entry, (dofs,).
    """

    table: np.ndarray
    rows: np.ndarray
    runs: np.ndarray
    entries: np.ndarray
    diagonal: np.ndarray


PADDING = 8
"""Numbers behind the end of an array that the compiled core may read."""

SPARE_ARRAYS = 4
"""So many arrays of factors are kept for each body, for those to come; fresh pages take half as long as factors."""


THREADED_SECONDS = 0.2
"""Modelled time of a factorization [s] from which on several threads share it."""


def plan(
    tree: EliminationTree, indptr: np.ndarray, indices: np.ndarray, dim: int
) -> tuple[Fronts, np.ndarray, np.ndarray]:
    """Fronts of a tree, the places of the degrees of freedom in the order, and the sizes of the two stacks."""
    place = np.empty(len(tree.order) * dim, np.int64)
    place[(tree.order[:, None] * dim + np.arange(dim)).ravel()] = np.arange(len(place))
    rows = (tree.rows[:, None] * dim + np.arange(dim)).ravel()
    table = np.zeros((len(tree.parent) + 1, 11), np.int64)
    table[:, FIRST], table[:, STARTS] = tree.first * dim, tree.starts * dim
    table[:-1, COLUMNS], table[:-1, BELOW] = np.diff(table[:, FIRST]), np.diff(table[:, STARTS])
    table[1:, PANEL] = np.cumsum(table[:-1, COLUMNS] * (table[:-1, COLUMNS] + table[:-1, BELOW]))
    table[:-1, CHILD], table[:-1, SIBLING] = children(tree.parent)
    sizes = np.zeros(2, np.int64)
    runs = np.empty((len(rows), 3), np.int64)
    entries = np.empty(((len(indices) + len(place)) // 2 + 1, 2), np.int32)
    diagonal, local = np.full(len(place), -1), np.empty(len(place), np.int64)
    native.stacks(table, tree.parent, np.zeros(2, np.int64), sizes)
    native.runs(table, tree.parent, rows, runs)
    native.entries(table, rows, indptr, indices, place, np.argsort(place), local, entries, diagonal)
    runs, entries = runs[: table[-1, RUNS]].copy(), entries[: table[-1, ENTRIES]].copy()
    return Fronts(table, rows, runs, entries, diagonal), place, sizes


class _Workspace(threading.local):
    """Memory that factorizations work in, for each thread its own; it is not sent to other processes."""

    def __init__(self, spare: int, stacks: tuple[int, int]) -> None:
        self.sizes = spare, stacks
        self.spare = np.empty(spare)
        self.stacks = np.empty(stacks[0] + PADDING), np.empty(stacks[1] + PADDING)

    def __reduce__(self) -> tuple:
        return _Workspace, self.sizes


class _IdleArrays:
    """Memory of factors that are no more; it is not sent to other processes."""

    def __init__(self) -> None:
        self._arrays: list[np.ndarray] = []

    def take(self, size: int) -> np.ndarray:
        """Return an uninitialized array of this size."""
        try:  # one step that threads cannot share
            return self._arrays.pop()
        except IndexError:
            return np.empty(size)

    def give(self, array: np.ndarray) -> None:
        """Keep an array that nobody else uses, if there is room."""
        idle_size = 75_000_000  # Numbers in all arrays that are kept so for one body (600 MB)
        if len(self._arrays) < SPARE_ARRAYS and (len(self._arrays) + 1) * len(array) <= idle_size:
            self._arrays.append(array)

    def __reduce__(self) -> tuple:
        return _IdleArrays, ()


class SupernodalAnalysis:
    """Fronts of a pattern; threads may share it."""

    def __init__(self, tree: EliminationTree, indptr: np.ndarray, indices: np.ndarray, dim: int) -> None:
        """Fronts of the elimination `tree` of a pattern."""
        self.fronts, self.place, sizes = plan(tree, indptr, indices, dim)
        self.seconds = tree.seconds
        table = self.fronts.table
        self.entries = int(table[-1, PANEL])
        self.height = int((table[:, COLUMNS] + table[:, BELOW]).max(initial=1))
        widest = int(table[:, COLUMNS].max(initial=1))
        self.idle = _IdleArrays()
        block = 8  # Most columns that are eliminated together, before a product applies them to the rest
        self.workspace = _Workspace(max(widest * block, 1), (int(sizes[0]), int(sizes[1])))

    def factorize(self, data: np.ndarray, tiny: float) -> "SupernodalFactors":
        """Factors of the matrix with these values."""
        signs = np.ones(len(self.place))
        work = self.workspace
        lower = self.idle.take(self.entries + PADDING)
        if THREADS > 1 and self.seconds >= THREADED_SECONDS:
            widest = len(work.spare)
            negative = native.factorise_together(*self.fronts, data, lower, signs, widest, tiny, THREADS)
        else:
            negative = native.factorise(*self.fronts, data, lower, signs, *work.stacks, work.spare, tiny)
        return SupernodalFactors(self, lower, signs, int(negative))


class SupernodalFactors:
    """L and S of one matrix.

    Attributes:
        singular: True if a pivot was too small.
        negative: number of negative pivots.
    """

    def __init__(self, analysis: SupernodalAnalysis, lower: np.ndarray, signs: np.ndarray, negative: int) -> None:
        """Numbers that a factorization filled."""
        self.singular = negative < 0
        self.negative = max(negative, 0)
        self._analysis, self._lower, self._signs = analysis, lower, signs
        self._owns = True

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_owns": False}  # a copy may share its arrays with others

    def __copy__(self) -> "SupernodalFactors":
        self._owns = False
        other = object.__new__(SupernodalFactors)
        other.__dict__.update(self.__dict__)
        return other

    def __del__(self) -> None:
        if getattr(self, "_owns", False):
            self._analysis.idle.give(self._lower)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for one or several right-hand sides."""
        return self._apply(right, WHOLE)

    def reduce(self, right: np.ndarray) -> np.ndarray:
        """Forward half of a solve: L^-1 right, in the order of elimination."""
        return self._apply(right, LOWER)

    def inner(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        """a^T A^-1 b from the forward halves of a and b."""
        if self.negative == 0:
            return one.T @ other
        return (one.T * self._signs) @ other

    def expand(self, reduced: np.ndarray) -> np.ndarray:
        """Solution from its forward half, or from a sum of such: L^-T S reduced."""
        return self._apply(reduced, UPPER)

    def _apply(self, right: np.ndarray, way: int) -> np.ndarray:
        analysis = self._analysis
        given = np.ascontiguousarray(right, dtype=float).reshape(len(right), -1)
        found = np.empty(given.shape)
        places = analysis.fronts.table, analysis.fronts.rows, analysis.place
        native.solve(*places, self._lower, self._signs, given, found, way, analysis.height)
        return found.reshape(right.shape)
