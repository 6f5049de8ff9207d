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

from hydrostat.kernel import INNER, LONG, njit
from hydrostat.mechanics.blas import divide_right, subtract_plain_product, subtract_product, subtract_square

BLOCK = 24
"""Columns eliminated together by plain loops, before BLAS applies them to the rest."""

WHOLE, LOWER, UPPER = range(3)
"""What of A^-1 is applied: all of it, L^-1, or L^-T S."""

FINE = {"contract", "reassoc", "nsz"}
"""What the compiler may do with sums; NaN and infinity stay what they are."""

COLUMNS, BELOW, FIRST, PANEL, STARTS, CHILD, SIBLING, STACK, OFFSET, RUNS, ENTRIES = range(11)
"""Columns of `Fronts.table`."""


class Fronts(NamedTuple):
    """Where everything goes, counted in degrees of freedom. Few arrays, for each costs time to compile.

    Attributes:
        table: a row for every supernode and one more, (supernodes + 1, 11):
            COLUMNS, BELOW: size of a front, own columns and rows below them;
            FIRST: first own column;
            PANEL: where its part of L begins;
            STARTS: where its rows begin in `rows`;
            CHILD, SIBLING: first child, next child of the same parent; -1 if there is none;
            STACK: which of two stacks takes what it hands up;
            OFFSET: where on the stack;
            RUNS, ENTRIES: where its runs and its entries of A begin.
        rows: indices of the rows below every front, one front after the other.
        runs: rows below that lie together in the parent's front too: their number here, there, how many, (runs, 3).
        entries: place of each entry in the data of A and in the front's panel, (entries, 2).
        diagonal: places of the diagonal in the data of A; -1 where it has none, (dofs,).
    """

    table: np.ndarray
    rows: np.ndarray
    runs: np.ndarray
    entries: np.ndarray
    diagonal: np.ndarray


@njit(fastmath=FINE, **LONG)
@no_type_check
def factorise_fronts(fronts, data, lower, signs, first_stack, second_stack, spare, call, tiny):
    """Fill L and S; the number of negative pivots, or -1 where a pivot is not above `tiny` x the largest diagonal."""
    table, entries = fronts.table, fronts.entries
    largest = 0.0
    for place in fronts.diagonal:
        if place >= 0:
            value = abs(data[place])
            if not value <= largest:
                largest = value
    if not largest < np.inf:
        return -1
    least = tiny * largest
    negative = 0
    for which in range(len(table) - 1):
        columns, below = table[which, COLUMNS], table[which, BELOW]
        panel = lower[table[which, PANEL] : table[which + 1, PANEL]]
        for place in range(len(panel)):
            panel[place] = 0.0
        for entry in range(table[which, ENTRIES], table[which + 1, ENTRIES]):
            panel[entries[entry, 1]] = data[entries[entry, 0]]
        mine, theirs = (second_stack, first_stack) if table[which, STACK] else (first_stack, second_stack)
        update = mine[table[which, OFFSET] : table[which, OFFSET] + below * below]
        for column in range(below):
            for place in range(column * below + column, (column + 1) * below):
                update[place] = 0.0
        child = table[which, CHILD]
        while child >= 0:
            _extend_add(table, fronts.runs, child, theirs, panel, columns, columns + below, update, below)
            child = table[child, SIBLING]
        sign = signs[table[which, FIRST] : table[which, FIRST] + columns]
        count = _eliminate(panel, columns, below, update, sign, spare, call, least)
        if count < 0:
            return -1
        negative += count
    return negative


@njit(fastmath=FINE, **INNER)
@no_type_check
def _extend_add(table, runs, child, stack, panel, columns, height, update, below):
    """Add what a child hands up to its parent's front, lower triangle only."""
    size = table[child, BELOW]
    given = stack[table[child, OFFSET] : table[child, OFFSET] + size * size]
    low, high = table[child, RUNS], table[child + 1, RUNS]
    for run in range(low, high):
        for step in range(runs[run, 2]):
            source = given[(runs[run, 0] + step) * size : (runs[run, 0] + step + 1) * size]
            column = runs[run, 1] + step
            if column < columns:
                target = panel[column * height : (column + 1) * height]
                shift = 0
            else:
                target = update[(column - columns) * below : (column - columns + 1) * below]
                shift = columns
            start = step
            for other in range(run, high):
                here = runs[other, 0] + start
                there = runs[other, 1] + start - shift
                for position in range(runs[other, 2] - start):
                    target[there + position] += source[here + position]
                start = 0


@njit(fastmath=FINE, **INNER)
@no_type_check
def _eliminate(panel, columns, below, update, sign, spare, call, least):
    """Eliminate the own columns of a front; the number of negative pivots, or -1 where one is too small."""
    height = columns + below
    at, handed = np.int64(panel.ctypes.data), np.int64(update.ctypes.data)
    negative = zero = np.int64(0)
    for low in range(0, columns, BLOCK):
        high = min(columns, low + BLOCK)
        count = _eliminate_block(panel, height, low, high, sign, least)
        if count < 0:
            return -1
        negative += count
        if high < columns:
            _subtract_signed(panel, height, low, high, high, columns, sign, spare, call, at, zero, height)
    if below > 0:
        if negative == 0:
            subtract_square(call, below, columns, at + 8 * columns, height, handed, below)
        else:
            _subtract_signed(panel, height, zero, columns, columns, height, sign, spare, call, handed, columns, below)
    return negative


@njit(fastmath=FINE, **INNER)
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


@njit(fastmath=FINE, **INNER)
@no_type_check
def _subtract_signed(panel, height, low, high, begin, end, sign, spare, call, target, shift, leading):
    """C -= P S P^T, P the columns low to high of a panel, for the columns begin to end of C and the rows below them.

    C is given by its address; its first row and column have the number `shift`.
    """
    at, place = np.int64(panel.ctypes.data), np.int64(spare.ctypes.data)
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
            place,
            width,
            target + 8 * ((column - shift) * leading + column - shift),
            leading,
        )


@njit(fastmath=FINE, **LONG)
@no_type_check
def solve_vector(fronts, lower, signs, values, work, way):
    """Solve L S L^T x = b in place, in the order of elimination, or half of it; `work` holds the rows of a front."""
    table, rows = fronts.table, fronts.rows
    for which in range(len(table) - 1 if way != UPPER else 0):
        columns, below = table[which, COLUMNS], table[which, BELOW]
        panel = lower[table[which, PANEL] : table[which + 1, PANEL]]
        first, start = table[which, FIRST], table[which, STARTS]
        _forward(panel, columns, columns + below, values[first : first + columns], work)
        for row in range(below):
            values[rows[start + row]] -= work[columns + row]
    if way != LOWER:
        for row in range(len(values)):
            values[row] *= signs[row]
    for which in range(len(table) - 2 if way != LOWER else -1, -1, -1):
        columns, below = table[which, COLUMNS], table[which, BELOW]
        panel = lower[table[which, PANEL] : table[which + 1, PANEL]]
        first, start = table[which, FIRST], table[which, STARTS]
        for row in range(below):
            work[columns + row] = values[rows[start + row]]
        _backward(panel, columns, columns + below, values[first : first + columns], work)


@njit(fastmath=FINE, **INNER)
@no_type_check
def _forward(panel, columns, height, own, work):
    """Replace own by L11^-1 own, and `work` below by L21 times that; the rest of `work` is spoilt."""
    for row in range(columns):
        work[row] = -own[row]
    for row in range(columns, height):
        work[row] = 0.0
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


@njit(fastmath=FINE, **INNER)
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


@njit(fastmath=FINE, **LONG)
@no_type_check
def solve_matrix(fronts, lower, signs, values, work, call, way):
    """Solve for several right-hand sides, (dofs, sides) row by row: transposed, they are Fortran's."""
    table, rows = fronts.table, fronts.rows
    sides = values.shape[1]
    at, other, panels = np.int64(values.ctypes.data), np.int64(work.ctypes.data), np.int64(lower.ctypes.data)
    yes = np.int64(1)
    for which in range(len(table) - 1 if way != UPPER else 0):
        columns, below = table[which, COLUMNS], table[which, BELOW]
        place = panels + 8 * table[which, PANEL]
        first, start, height = table[which, FIRST], table[which, STARTS], columns + below
        own = at + 8 * first * sides
        divide_right(call, yes, sides, columns, place, height, own, sides)
        if below > 0:
            for row in range(below):
                for side in range(sides):
                    work[row, side] = 0.0
            subtract_product(call, sides, below, columns, own, sides, place + 8 * columns, height, other, sides)
            for row in range(below):
                for side in range(sides):
                    values[rows[start + row], side] += work[row, side]
    if way != LOWER:
        for row in range(len(values)):
            for side in range(sides):
                values[row, side] *= signs[row]
    for which in range(len(table) - 2 if way != LOWER else -1, -1, -1):
        columns, below = table[which, COLUMNS], table[which, BELOW]
        place = panels + 8 * table[which, PANEL]
        first, start, height = table[which, FIRST], table[which, STARTS], columns + below
        own = at + 8 * first * sides
        if below > 0:
            for row in range(below):
                for side in range(sides):
                    work[row, side] = values[rows[start + row], side]
            subtract_plain_product(call, sides, columns, below, other, sides, place + 8 * columns, height, own, sides)
        divide_right(call, 1 - yes, sides, columns, place, height, own, sides)
