"""What a factorisation will look like, from the pattern alone: elimination tree, supernodes, fronts.

The elimination tree (Liu 1990) says which column first needs which: the parent of a node is the first of its neighbours
to be eliminated after it, fill-in counted. Nodes in a chain whose columns have the same rows are a supernode,
eliminated together in one dense front. Larger fronts run faster, so a supernode is merged into its parent, zeros and
all, where a model of time says that this pays (relaxed supernodes: Ashcraft and Grimes 1989).

Everything here counts nodes, that is blocks of `dim` degrees of freedom.
"""

from typing import NamedTuple, no_type_check

import numpy as np
from numba import njit

FRONT = 1.5e-6
ENTRY = 0.6e-9
UPDATE = 0.8e-9
RATE = 30e9
RAMP = 12.0
"""A model of time [s]: of a front; of an entry of L; of an entry handed on to the parent; of an operation of a large
front, whose rate is halved where a front has only RAMP columns. Set on one machine (docs/decisions/0007)."""


class Tree(NamedTuple):
    """Supernodes in the order of their elimination, children before parents.

    Attributes:
        order: nodes in the order of their elimination.
        first: place of the first node of each supernode, and the number of nodes, (supernodes + 1,).
        parent: of each supernode; -1 at a root.
        starts: where the rows of each supernode begin, (supernodes + 1,).
        rows: places of the nodes below each supernode, in rising order.
        seconds: modelled time of a factorisation.
    """

    order: np.ndarray
    first: np.ndarray
    parent: np.ndarray
    starts: np.ndarray
    rows: np.ndarray
    seconds: float


@njit(cache=True)
@no_type_check
def front_seconds(columns, rows):
    """Modelled time of a front with that many columns and rows (columns included), in degrees of freedom."""
    below = rows - columns
    operations = columns * (columns * columns / 3.0 + columns * below + below * float(below))
    return (
        FRONT + ENTRY * columns * rows + 0.5 * UPDATE * below * below + operations / (RATE * columns / (columns + RAMP))
    )


@njit(cache=True)
@no_type_check
def supernodes(starts, neighbours, order, dim):
    """The `Tree` of eliminating a graph in a given order, as a tuple."""
    order = order[_postorder(_elimination_tree(starts, neighbours, order))]
    parent = _elimination_tree(starts, neighbours, order)
    count = _column_counts(starts, neighbours, order, parent)
    head = _fundamental(parent, count)
    head = _merged(head, parent, count, dim)
    return _collect(starts, neighbours, order, parent, count, head, dim)


@njit(cache=True)
@no_type_check
def _elimination_tree(starts, neighbours, order):
    """Parent of each place in the order; -1 at a root. `ancestor` shortens the paths."""
    nodes = len(order)
    place = np.empty(nodes, np.int64)
    place[order] = np.arange(nodes)
    parent = np.full(nodes, -1, np.int64)
    ancestor = np.full(nodes, -1, np.int64)
    for column in range(nodes):
        for entry in range(starts[order[column]], starts[order[column] + 1]):
            row = place[neighbours[entry]]
            while row >= 0 and row < column:
                following = ancestor[row]
                ancestor[row] = column
                if following < 0:
                    parent[row] = column
                row = following
    return parent


@njit(cache=True)
@no_type_check
def _postorder(parent):
    """Vertices of a forest, children before parents, each subtree in one piece."""
    size = len(parent)
    child, sibling = _children(parent)
    result = np.empty(size, np.int64)
    stack = np.empty(size, np.int64)
    filled = 0
    for root in range(size):
        if parent[root] >= 0:
            continue
        stack[0] = root
        depth = 1
        while depth > 0:
            vertex = stack[depth - 1]
            if child[vertex] >= 0:
                stack[depth] = child[vertex]
                child[vertex] = sibling[child[vertex]]
                depth += 1
            else:
                result[filled] = vertex
                filled += 1
                depth -= 1
    return result


@njit(cache=True)
@no_type_check
def _children(parent):
    """First child of each vertex and next sibling of each child, rising; -1 where there is none."""
    child = np.full(len(parent), -1, np.int64)
    sibling = np.full(len(parent), -1, np.int64)
    for vertex in range(len(parent) - 1, -1, -1):
        if parent[vertex] >= 0:
            sibling[vertex] = child[parent[vertex]]
            child[parent[vertex]] = vertex
    return child, sibling


@njit(cache=True)
@no_type_check
def _column_counts(starts, neighbours, order, parent):
    """Entries of each column of L, the diagonal included: a row of L is a subtree from the row's entries upwards."""
    nodes = len(order)
    place = np.empty(nodes, np.int64)
    place[order] = np.arange(nodes)
    count = np.ones(nodes, np.int64)
    seen = np.full(nodes, -1, np.int64)
    for row in range(nodes):
        seen[row] = row
        for entry in range(starts[order[row]], starts[order[row] + 1]):
            column = place[neighbours[entry]]
            while column < row and seen[column] != row:
                seen[column] = row
                count[column] += 1
                column = parent[column]
    return count


@njit(cache=True)
@no_type_check
def _fundamental(parent, count):
    """The last node of the supernode of each node: chains without a branch whose columns have the same rows."""
    nodes = len(parent)
    children = np.zeros(nodes, np.int64)
    for node in range(nodes):
        if parent[node] >= 0:
            children[parent[node]] += 1
    head = np.arange(nodes)
    for node in range(nodes - 2, -1, -1):
        if parent[node] == node + 1 and children[node + 1] == 1 and count[node] == count[node + 1] + 1:
            head[node] = head[node + 1]
    return head


@njit(cache=True)
@no_type_check
def _merged(head, parent, count, dim):
    """`head` after merging supernodes into their parents where it saves modelled time. A head is its highest node."""
    nodes = len(head)
    columns = np.zeros(nodes, np.int64)
    for node in range(nodes):
        columns[head[node]] += 1
    above = np.full(nodes, -1, np.int64)
    for node in range(nodes):
        if head[node] == node and parent[node] >= 0:
            above[node] = head[parent[node]]
    child, sibling = _children(above)
    into = np.arange(nodes)
    for top in range(nodes):
        if head[top] != top:
            continue
        own = count[top] - 1
        vertex = child[top]
        while vertex >= 0:
            low = columns[vertex] + count[vertex] - 1
            apart = front_seconds(dim * columns[vertex], dim * low)
            apart += front_seconds(dim * columns[top], dim * (columns[top] + own))
            both = columns[top] + columns[vertex]
            if front_seconds(dim * both, dim * (both + own)) < apart:
                columns[top] = both
                into[vertex] = top
            vertex = sibling[vertex]
    for node in range(nodes - 1, -1, -1):
        into[node] = into[into[node]] if into[node] != node else node
    return into[head]


@njit(cache=True)
@no_type_check
def _collect(starts, neighbours, order, parent, count, head, dim):
    """Number the supernodes given by their heads in postorder, and list their rows."""
    nodes = len(order)
    above = np.full(nodes, -2, np.int64)
    for node in range(nodes):
        if head[node] == node:
            above[node] = head[parent[node]] if parent[node] >= 0 else -1
    tops = np.flatnonzero(above > -2)
    number = np.full(nodes, -1, np.int64)
    number[tops] = np.arange(len(tops))
    total = len(tops)
    lifted = np.full(total, -1, np.int64)
    for which in range(total):
        if above[tops[which]] >= 0:
            lifted[which] = number[above[tops[which]]]
    walk = _postorder(lifted)
    rank = np.empty(total, np.int64)
    rank[walk] = np.arange(total)
    up = np.full(total, -1, np.int64)
    for which in range(total):
        if lifted[walk[which]] >= 0:
            up[which] = rank[lifted[walk[which]]]
    first = np.zeros(total + 1, np.int64)
    for node in range(nodes):
        first[rank[number[head[node]]] + 1] += 1
    first = np.cumsum(first)
    fill = first.copy()
    moved = np.empty(nodes, np.int64)
    for node in range(nodes):
        which = rank[number[head[node]]]
        moved[fill[which]] = order[node]
        fill[which] += 1
    begins = np.zeros(total + 1, np.int64)
    for which in range(total):
        begins[which + 1] = begins[which] + count[tops[walk[which]]] - 1
    rows = _rows(starts, neighbours, moved, first, up, begins)
    seconds = 0.0
    for which in range(total):
        columns = first[which + 1] - first[which]
        seconds += front_seconds(dim * columns, dim * (columns + begins[which + 1] - begins[which]))
    return moved, first, up, begins, rows, seconds


@njit(cache=True)
@no_type_check
def _rows(starts, neighbours, order, first, parent, begins):
    """Rows below each supernode: of its nodes' neighbours and of its children, those after its last node."""
    nodes = len(order)
    place = np.empty(nodes, np.int64)
    place[order] = np.arange(nodes)
    child, sibling = _children(parent)
    rows = np.empty(begins[-1], np.int64)
    seen = np.full(nodes, -1, np.int64)
    for which in range(len(parent)):
        end = first[which + 1]
        at = begins[which]
        for column in range(first[which], end):
            for entry in range(starts[order[column]], starts[order[column] + 1]):
                row = place[neighbours[entry]]
                if row >= end and seen[row] != which:
                    seen[row] = which
                    rows[at] = row
                    at += 1
        below = child[which]
        while below >= 0:
            for position in range(begins[below], begins[below + 1]):
                row = rows[position]
                if row >= end and seen[row] != which:
                    seen[row] = which
                    rows[at] = row
                    at += 1
            below = sibling[below]
        rows[begins[which] : begins[which + 1]].sort()
    return rows
