"""Multifrontal factorisation A = L S L^T of a symmetric matrix, S = diag(+-1), without pivoting.

Every supernode has a front (Duff and Reid 1983): a dense matrix of its own columns and the rows below them. It collects
entries of A and what its children hand up (extend-add), eliminates its own columns, and hands the rest to its parent:

    [F11 .  ]   [L11  ] [S1  ] [L11^T L21^T]
    [F21 F22] = [L21 I] [   U] [      I    ]        U = F22 - L21 S1 L21^T

The signs S are those of the pivots; by Sylvester's law there are as many -1 as negative eigenvalues. A few columns at a
time are eliminated and applied to the rest by products of its own (native/fronts.hpp); pivots may be of either sign.

Own columns are kept in L ("panels": columns and rows together, column by column). What is handed up lies on one of two
stacks, in turn with the depth in the tree: then the children of a front are always on top of the other stack.
"""

from typing import NamedTuple

import numpy as np

BLOCK = 8
"""Most columns that are eliminated together, before a product applies them to the rest."""

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
