"""Multifrontal factorisation A = L S L^T of a symmetric matrix, S = diag(+-1), without pivoting.

Every supernode has a front (Duff and Reid 1983): a dense matrix of its own columns and the rows below them. It collects
entries of A and what its children hand up (extend-add), eliminates its own columns, and hands the rest to its parent:

    [F11 .  ]   [L11  ] [S1  ] [L11^T L21^T]
    [F21 F22] = [L21 I] [   U] [      I    ]        U = F22 - L21 S1 L21^T

The signs S are those of the pivots; by Sylvester's law there are as many -1 as negative eigenvalues. A few columns at a
time are eliminated by plain loops and applied to the rest by BLAS, which is as fast as LAPACK's Cholesky followed by a
triangular solve, and takes pivots of either sign.

Own columns are kept in L ("panels": columns and rows together, column by column). What is handed up lies on one of two
stacks, in turn with the depth in the tree: then the children of a front are always on top of the other stack.
"""

from typing import NamedTuple, no_type_check

import numpy as np
from numba import njit

from hydrostat.mechanics.blas import (
    Scratch,
    divide_right,
    scratch,
    subtract_plain_product,
    subtract_product,
    subtract_square,
)
from hydrostat.mechanics.symbolic import Tree

BLOCK = 24
"""Columns eliminated together by plain loops, before BLAS applies them to the rest."""

FINE = {"contract", "reassoc", "nsz"}
"""What the compiler may do with sums; NaN and infinity stay what they are."""


class Fronts(NamedTuple):
    """Where everything goes, counted in degrees of freedom. One entry a supernode unless said otherwise.

    Attributes:
        columns, below: size of a front, own columns and rows below them.
        first: first own column.
        panel: where its part of L begins, (supernodes + 1,).
        starts: where its rows begin in `rows`, (supernodes + 1,).
        rows: indices of the rows below every front, one front after the other.
        child, sibling: first child, next child of the same parent; -1 if there is none.
        stack: which of two stacks takes what it hands up.
        offset: where on the stack.
        runs: where its runs begin, (supernodes + 1,).
        run_from, run_to, run_length: rows below that lie together in the parent's front too: their number here, there.
        entries: where its entries of A begin, (supernodes + 1,).
        source, target: place of each entry in the data of A and in the front's panel.
        diagonal: places of the diagonal in the data of A; -1 where it has none, (dofs,).
    """

    columns: np.ndarray
    below: np.ndarray
    first: np.ndarray
    panel: np.ndarray
    starts: np.ndarray
    rows: np.ndarray
    child: np.ndarray
    sibling: np.ndarray
    stack: np.ndarray
    offset: np.ndarray
    runs: np.ndarray
    run_from: np.ndarray
    run_to: np.ndarray
    run_length: np.ndarray
    entries: np.ndarray
    source: np.ndarray
    target: np.ndarray
    diagonal: np.ndarray


def plan(tree: Tree, indptr: np.ndarray, indices: np.ndarray, dim: int) -> tuple[Fronts, np.ndarray, np.ndarray]:
    """The fronts of a tree, the places of the degrees of freedom in the order, and the sizes of the two stacks."""
    columns = np.diff(tree.first) * dim
    below = np.diff(tree.starts) * dim
    panel = np.concatenate([[0], np.cumsum(columns * (columns + below))])
    rows = (tree.rows[:, None] * dim + np.arange(dim)).ravel()
    place = np.empty(len(tree.order) * dim, np.int64)
    place[(tree.order[:, None] * dim + np.arange(dim)).ravel()] = np.arange(len(place))
    child, sibling, stack, offset, sizes = _stacks(tree.parent, below)
    runs, run_from, run_to, run_length = _runs(tree.first * dim, tree.parent, tree.starts * dim, rows)
    entries, source, target, diagonal = _entries(indptr, indices, place, tree.first * dim, tree.starts * dim, rows)
    fronts = Fronts(
        columns=columns,
        below=below,
        first=tree.first[:-1] * dim,
        panel=panel,
        starts=tree.starts * dim,
        rows=rows,
        child=child,
        sibling=sibling,
        stack=stack,
        offset=offset,
        runs=runs,
        run_from=run_from,
        run_to=run_to,
        run_length=run_length,
        entries=entries,
        source=source,
        target=target,
        diagonal=diagonal,
    )
    return fronts, place, sizes


@njit(cache=True)
@no_type_check
def _stacks(parent, below):
    """Children of each supernode, and where on which stack what it hands up will lie."""
    count = len(parent)
    child = np.full(count, -1, np.int64)
    sibling = np.full(count, -1, np.int64)
    stack = np.zeros(count, np.int64)
    for vertex in range(count - 1, -1, -1):
        if parent[vertex] >= 0:
            sibling[vertex] = child[parent[vertex]]
            child[parent[vertex]] = vertex
            stack[vertex] = 1 - stack[parent[vertex]]
    offset = np.zeros(count, np.int64)
    top = np.zeros(2, np.int64)
    most = np.zeros(2, np.int64)
    for vertex in range(count):
        if child[vertex] >= 0:
            top[1 - stack[vertex]] = offset[child[vertex]]
        which = stack[vertex]
        offset[vertex] = top[which]
        top[which] += below[vertex] * below[vertex]
        most[which] = max(most[which], top[which])
    return child, sibling, stack, offset, most


@njit(cache=True)
@no_type_check
def _runs(first, parent, starts, rows):
    """Pieces of the rows below each front that are contiguous in the parent's front; none crosses its own columns."""
    count = len(parent)
    runs = np.zeros(count + 1, np.int64)
    run_from = np.empty(len(rows), np.int64)
    run_to = np.empty(len(rows), np.int64)
    run_length = np.empty(len(rows), np.int64)
    filled = 0
    for which in range(count):
        up = parent[which]
        if up >= 0:
            columns = first[up + 1] - first[up]
            at = starts[up]
            previous = -2
            for position in range(starts[which], starts[which + 1]):
                row = rows[position]
                if row < first[up + 1]:
                    local = row - first[up]
                else:
                    while rows[at] < row:
                        at += 1
                    local = columns + at - starts[up]
                if local == previous + 1 and local != columns:
                    run_length[filled - 1] += 1
                else:
                    run_from[filled] = position - starts[which]
                    run_to[filled] = local
                    run_length[filled] = 1
                    filled += 1
                previous = local
        runs[which + 1] = filled
    return runs, run_from[:filled].copy(), run_to[:filled].copy(), run_length[:filled].copy()


@njit(cache=True)
@no_type_check
def _entries(indptr, indices, place, first, starts, rows):
    """For each front the places of its entries of A in the data and in its panel, and the places of the diagonal."""
    size = len(indptr) - 1
    count = len(first) - 1
    front = np.empty(size, np.int64)
    for which in range(count):
        front[first[which] : first[which + 1]] = which
    undo = np.empty(size, np.int64)
    undo[place] = np.arange(size)
    diagonal = np.full(size, -1, np.int64)
    entries = np.zeros(count + 1, np.int64)
    source = np.empty((len(indices) + size) // 2 + 1, np.int32)
    target = np.empty(len(source), np.int32)
    local = np.empty(size, np.int64)
    filled = 0
    for which in range(count):
        columns = first[which + 1] - first[which]
        height = columns + starts[which + 1] - starts[which]
        for row in range(first[which], first[which + 1]):
            local[row] = row - first[which]
        for position in range(starts[which], starts[which + 1]):
            local[rows[position]] = columns + position - starts[which]
        for column in range(first[which], first[which + 1]):
            old = undo[column]
            for entry in range(indptr[old], indptr[old + 1]):
                row = place[indices[entry]]
                if row == column:
                    diagonal[old] = entry
                if row >= column:
                    source[filled] = entry
                    target[filled] = (column - first[which]) * height + local[row]
                    filled += 1
        entries[which + 1] = filled
    return entries, source[:filled].copy(), target[:filled].copy(), diagonal


@njit(cache=True, fastmath=FINE)
@no_type_check
def factorise_fronts(fronts, data, lower, signs, first_stack, second_stack, spare, call, tiny):
    """Fill L and S; the number of negative pivots, or -1 where a pivot is not above `tiny` x the largest diagonal."""
    largest = 0.0
    for place in fronts.diagonal:
        if place >= 0:
            value = abs(data[place])
            if not value <= largest:
                largest = value
    if not np.isfinite(largest):
        return -1
    least = tiny * largest
    negative = 0
    for which in range(len(fronts.columns)):
        columns, below = fronts.columns[which], fronts.below[which]
        panel = lower[fronts.panel[which] : fronts.panel[which + 1]]
        panel[:] = 0.0
        for entry in range(fronts.entries[which], fronts.entries[which + 1]):
            panel[fronts.target[entry]] = data[fronts.source[entry]]
        mine, theirs = (second_stack, first_stack) if fronts.stack[which] else (first_stack, second_stack)
        update = mine[fronts.offset[which] : fronts.offset[which] + below * below]
        _clear(update, below)
        child = fronts.child[which]
        while child >= 0:
            _extend_add(fronts, child, theirs, panel, columns, columns + below, update, below)
            child = fronts.sibling[child]
        sign = signs[fronts.first[which] : fronts.first[which] + columns]
        count = _eliminate(panel, columns, below, update, sign, spare, call, least)
        if count < 0:
            return -1
        negative += count
    return negative


@njit(cache=True)
@no_type_check
def _clear(update, size):
    """Zero the lower triangle."""
    for column in range(size):
        update[column * size + column : (column + 1) * size] = 0.0


@njit(cache=True, fastmath=FINE)
@no_type_check
def _extend_add(fronts, child, stack, panel, columns, height, update, below):
    """Add what a child hands up to its parent's front, lower triangle only."""
    size = fronts.below[child]
    given = stack[fronts.offset[child] : fronts.offset[child] + size * size]
    low, high = fronts.runs[child], fronts.runs[child + 1]
    for run in range(low, high):
        for step in range(fronts.run_length[run]):
            source = given[(fronts.run_from[run] + step) * size : (fronts.run_from[run] + step + 1) * size]
            column = fronts.run_to[run] + step
            if column < columns:
                target = panel[column * height : (column + 1) * height]
                shift = 0
            else:
                target = update[(column - columns) * below : (column - columns + 1) * below]
                shift = columns
            start = step
            for other in range(run, high):
                here = fronts.run_from[other] + start
                there = fronts.run_to[other] + start - shift
                for position in range(fronts.run_length[other] - start):
                    target[there + position] += source[here + position]
                start = 0


@njit(cache=True, fastmath=FINE)
@no_type_check
def _eliminate(panel, columns, below, update, sign, spare, call, least):
    """Eliminate the own columns of a front; the number of negative pivots, or -1 where one is too small."""
    height = columns + below
    at, handed = panel.ctypes.data, update.ctypes.data
    negative = 0
    for low in range(0, columns, BLOCK):
        high = min(columns, low + BLOCK)
        count = _eliminate_block(panel, height, low, high, sign, least)
        if count < 0:
            return -1
        negative += count
        if high < columns:
            _subtract_signed(panel, height, low, high, high, columns, sign, spare, call, at, 0, height)
    if below > 0:
        if negative == 0:
            subtract_square(call, below, columns, at + 8 * columns, height, handed, below)
        else:
            _subtract_signed(panel, height, 0, columns, columns, height, sign, spare, call, handed, columns, below)
    return negative


@njit(cache=True, fastmath=FINE)
@no_type_check
def _eliminate_block(panel, height, low, high, sign, least):
    """Eliminate columns low to high of a panel, to which all earlier ones have been applied, by plain loops."""
    negative = 0
    for column in range(low, high):
        own = panel[column * height + column : (column + 1) * height]
        size = height - column
        earlier = low
        while earlier + 4 <= column:
            place = earlier * height + column
            one = panel[place : place + size]
            two = panel[place + height : place + height + size]
            three = panel[place + 2 * height : place + 2 * height + size]
            four = panel[place + 3 * height : place + 3 * height + size]
            a, b = sign[earlier] * one[0], sign[earlier + 1] * two[0]
            c, d = sign[earlier + 2] * three[0], sign[earlier + 3] * four[0]
            for row in range(size):
                own[row] -= a * one[row] + b * two[row] + c * three[row] + d * four[row]
            earlier += 4
        while earlier < column:
            one = panel[earlier * height + column : earlier * height + column + size]
            a = sign[earlier] * one[0]
            for row in range(size):
                own[row] -= a * one[row]
            earlier += 1
        pivot = own[0]
        if not (abs(pivot) > least and abs(pivot) < np.inf):
            return -1
        sign[column] = 1.0 if pivot > 0 else -1.0
        negative += pivot < 0
        root = np.sqrt(abs(pivot))
        scale = sign[column] / root
        own[0] = root
        for row in range(1, size):
            own[row] *= scale
    return negative


@njit(cache=True, fastmath=FINE)
@no_type_check
def _subtract_signed(panel, height, low, high, begin, end, sign, spare, call, target, shift, leading):
    """C -= P S P^T, P the columns low to high of a panel, for the columns begin to end of C and the rows below them.

    C is given by its address; its first row and column have the number `shift`.
    """
    at = panel.ctypes.data
    depth = high - low
    for column in range(begin, end, BLOCK):
        width = min(BLOCK, end - column)
        for inner in range(depth):
            for row in range(width):
                spare[inner * width + row] = sign[low + inner] * panel[(low + inner) * height + column + row]
        subtract_product(
            call,
            height - column,
            width,
            depth,
            at + 8 * (low * height + column),
            height,
            spare.ctypes.data,
            width,
            target + 8 * ((column - shift) * leading + column - shift),
            leading,
        )


@njit(cache=True, fastmath=FINE)
@no_type_check
def solve_vector(fronts, lower, signs, values, work):
    """Solve L S L^T x = b in place, in the order of elimination; `work` holds the rows of a front."""
    count = len(fronts.columns)
    for which in range(count):
        columns, below = fronts.columns[which], fronts.below[which]
        panel = lower[fronts.panel[which] : fronts.panel[which + 1]]
        first, start = fronts.first[which], fronts.starts[which]
        _forward(panel, columns, columns + below, values[first : first + columns], work)
        for row in range(below):
            values[fronts.rows[start + row]] -= work[columns + row]
    for row in range(len(values)):
        values[row] *= signs[row]
    for which in range(count - 1, -1, -1):
        columns, below = fronts.columns[which], fronts.below[which]
        panel = lower[fronts.panel[which] : fronts.panel[which + 1]]
        first, start = fronts.first[which], fronts.starts[which]
        for row in range(below):
            work[columns + row] = values[fronts.rows[start + row]]
        _backward(panel, columns, columns + below, values[first : first + columns], work)


@njit(cache=True, fastmath=FINE)
@no_type_check
def _forward(panel, columns, height, own, work):
    """Replace own by L11^-1 own, and `work` below by L21 times that; the rest of `work` is spoilt."""
    for row in range(columns):
        work[row] = -own[row]
    work[columns:height] = 0.0
    column = 0
    while column + 4 <= columns:
        for inner in range(column, column + 4):
            value = -work[inner] / panel[inner * height + inner]
            own[inner] = value
            for row in range(inner + 1, column + 4):
                work[row] += value * panel[inner * height + row]
        place = column * height + column + 4
        size = height - column - 4
        one, two = panel[place : place + size], panel[place + height : place + height + size]
        three, four = panel[place + 2 * height : place + 2 * height + size], panel[place + 3 * height :][:size]
        a, b, c, d = own[column], own[column + 1], own[column + 2], own[column + 3]
        rest = work[column + 4 : height]
        for row in range(size):
            rest[row] += a * one[row] + b * two[row] + c * three[row] + d * four[row]
        column += 4
    for inner in range(column, columns):
        value = -work[inner] / panel[inner * height + inner]
        own[inner] = value
        one = panel[inner * height + inner : (inner + 1) * height]
        rest = work[inner:height]
        for row in range(1, height - inner):
            rest[row] += value * one[row]


@njit(cache=True, fastmath=FINE)
@no_type_check
def _backward(panel, columns, height, own, work):
    """Replace own by L11^-T (own - L21^T work below), in `work` too."""
    column = columns
    while column % 4 != 0:
        column -= 1
        one = panel[column * height + column : (column + 1) * height]
        rest = work[column:height]
        a = 0.0
        for row in range(1, height - column):
            a += one[row] * rest[row]
        own[column] = (own[column] - a) / one[0]
        work[column] = own[column]
    while column > 0:
        column -= 4
        place = column * height + column + 4
        size = height - column - 4
        one, two = panel[place : place + size], panel[place + height : place + height + size]
        three, four = panel[place + 2 * height : place + 2 * height + size], panel[place + 3 * height :][:size]
        rest = work[column + 4 : height]
        a = b = c = d = 0.0
        for row in range(size):
            value = rest[row]
            a += one[row] * value
            b += two[row] * value
            c += three[row] * value
            d += four[row] * value
        own[column] -= a
        own[column + 1] -= b
        own[column + 2] -= c
        own[column + 3] -= d
        for inner in range(column + 3, column - 1, -1):
            value = own[inner]
            for row in range(inner + 1, column + 4):
                value -= panel[inner * height + row] * own[row]
            own[inner] = value / panel[inner * height + inner]
            work[inner] = own[inner]


@njit(cache=True, fastmath=FINE)
@no_type_check
def solve_matrix(fronts, lower, signs, values, work, call):
    """As `solve_vector` for several right-hand sides, (dofs, sides) row by row: transposed, they are Fortran's."""
    count = len(fronts.columns)
    sides = values.shape[1]
    at, other = values.ctypes.data, work.ctypes.data
    for which in range(count):
        columns, below = fronts.columns[which], fronts.below[which]
        place = lower[fronts.panel[which] : fronts.panel[which + 1]].ctypes.data
        first, start, height = fronts.first[which], fronts.starts[which], columns + below
        own = at + 8 * first * sides
        divide_right(call, True, sides, columns, place, height, own, sides)
        if below > 0:
            work[:below] = 0.0
            subtract_product(call, sides, below, columns, own, sides, place + 8 * columns, height, other, sides)
            for row in range(below):
                values[fronts.rows[start + row]] += work[row]
    for row in range(len(values)):
        values[row] *= signs[row]
    for which in range(count - 1, -1, -1):
        columns, below = fronts.columns[which], fronts.below[which]
        place = lower[fronts.panel[which] : fronts.panel[which + 1]].ctypes.data
        first, start, height = fronts.first[which], fronts.starts[which], columns + below
        own = at + 8 * first * sides
        if below > 0:
            for row in range(below):
                work[row] = values[fronts.rows[start + row]]
            subtract_plain_product(call, sides, columns, below, other, sides, place + 8 * columns, height, own, sides)
        divide_right(call, False, sides, columns, place, height, own, sides)


class SupernodalAnalysis:
    """Fronts of a pattern, with the memory that every factorisation works in."""

    def __init__(self, tree: Tree, indptr: np.ndarray, indices: np.ndarray, dim: int) -> None:
        """Fronts of the elimination `tree` of a pattern."""
        self.fronts, self.place, sizes = plan(tree, indptr, indices, dim)
        self.entries = int(self.fronts.panel[-1])
        self.height = int((self.fronts.columns + self.fronts.below).max(initial=1))
        self.call: Scratch = scratch()
        widest = int(self.fronts.columns.max(initial=1))
        self._spare = np.empty(max(widest * max(widest, BLOCK), 1))
        self._stacks = np.empty(int(sizes[0])), np.empty(int(sizes[1]))

    def factorise(self, data: np.ndarray, tiny: float) -> "SupernodalFactors":
        """Factors of the matrix with these values."""
        lower = np.empty(self.entries)
        signs = np.ones(len(self.place))
        negative = factorise_fronts(self.fronts, data, lower, signs, *self._stacks, self._spare, self.call, tiny)
        return SupernodalFactors(self, lower, signs, int(negative))


class SupernodalFactors:
    """L and S of one matrix.

    Attributes:
        singular: whether a pivot was too small.
        negative: number of negative pivots.
    """

    def __init__(self, analysis: SupernodalAnalysis, lower: np.ndarray, signs: np.ndarray, negative: int) -> None:
        """What `factorise_fronts` filled."""
        self.singular = negative < 0
        self.negative = max(negative, 0)
        self._analysis, self._lower, self._signs = analysis, lower, signs

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for one or several right-hand sides."""
        analysis = self._analysis
        values = np.empty(right.shape)
        values[analysis.place] = right
        if right.ndim == 1:
            solve_vector(analysis.fronts, self._lower, self._signs, values, np.empty(analysis.height))
        elif right.shape[1] > 0:
            work = np.empty((analysis.height, right.shape[1]))
            solve_matrix(analysis.fronts, self._lower, self._signs, values, work, analysis.call)
        return values[analysis.place]
