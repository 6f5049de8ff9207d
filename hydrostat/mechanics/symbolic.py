"""What a factorisation will look like, from the pattern alone: elimination tree, supernodes, fronts.

The elimination tree (Liu 1990) says which column first needs which: the parent of a node is the first of its neighbours
to be eliminated after it, fill-in counted. Nodes in a chain whose columns have the same rows are a supernode,
eliminated together in one dense front. Larger fronts run faster, so a supernode is merged into its parent, zeros and
all, where a model of time says that this pays (relaxed supernodes: Ashcraft and Grimes 1989).

Everything here counts nodes, that is blocks of `dim` degrees of freedom.
"""

from typing import NamedTuple, no_type_check

import numpy as np

from hydrostat.kernel import INNER, Kernel, njit

FRONT = 1.5e-6
ENTRY = 0.6e-9
UPDATE = 0.8e-9
RATE = 30e9
RAMP = 12.0
"""A model of time [s]: of a front; of an entry of L; of an entry handed on to the parent; of an operation of a large
front, whose rate is halved where a front has only RAMP columns. Set on one machine (docs/decisions/0007)."""


class EliminationTree(NamedTuple):
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


@no_type_check
def front_seconds(columns, rows):
    """Modelled time of fronts with that many columns and rows (columns included), in degrees of freedom."""
    below = rows - columns
    operations = columns * (columns * columns / 3.0 + columns * below + below * 1.0 * below)
    rate = RATE * columns / (columns + RAMP)
    return FRONT + ENTRY * columns * rows + 0.5 * UPDATE * below * below + operations / rate


_front_seconds = njit(**INNER)(front_seconds)


def supernodes(starts: np.ndarray, neighbours: np.ndarray, order: np.ndarray, dim: int) -> EliminationTree:
    """The supernodes of eliminating a graph in a given order."""
    order = order[_postordered(_elimination(starts, neighbours, order))]
    parent = _elimination(starts, neighbours, order)
    count = np.ones(len(order), np.int64)
    _column_counts(starts, neighbours, order, _inverse(order), parent, count, np.full(len(order), -1))
    head = _merged(_fundamental(parent, count), parent, count, dim)
    return _collected(starts, neighbours, order, parent, count, head, dim)


def children(parent: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First child of each vertex of a forest and next sibling of each child, rising; -1 where there is none."""
    child, sibling = np.full(len(parent), -1), np.full(len(parent), -1)
    order = np.argsort(parent, kind="stable")
    order = order[parent[order] >= 0]
    same = parent[order[1:]] == parent[order[:-1]]
    sibling[order[:-1][same]] = order[1:][same]
    first = order[np.append(True, ~same)[: len(order)]]
    child[parent[first]] = first
    return child, sibling


def _inverse(order: np.ndarray) -> np.ndarray:
    """The place of each node in an order."""
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    return place


def _elimination(starts: np.ndarray, neighbours: np.ndarray, order: np.ndarray) -> np.ndarray:
    """The elimination tree: parent of each place in the order; -1 at a root."""
    parent, ancestor = np.full(len(order), -1), np.full(len(order), -1)
    _elimination_tree(starts, neighbours, order, _inverse(order), parent, ancestor)
    return parent


@Kernel
@no_type_check
def _elimination_tree(starts, neighbours, order, place, parent, ancestor):
    """Fill `parent`; `ancestor` shortens the paths. Both are -1 before."""
    for column in range(len(order)):
        for entry in range(starts[order[column]], starts[order[column] + 1]):
            row = place[neighbours[entry]]
            while row >= 0 and row < column:
                following = ancestor[row]
                ancestor[row] = column
                if following < 0:
                    parent[row] = column
                row = following


def _postordered(parent: np.ndarray) -> np.ndarray:
    """Vertices of a forest, children before parents, each subtree in one piece."""
    child, sibling = children(parent)
    result, stack = np.empty(len(parent), np.int64), np.empty(len(parent), np.int64)
    _postorder(parent, child, sibling, result, stack)
    return result


@Kernel
@no_type_check
def _postorder(parent, child, sibling, result, stack):
    """Fill `result`, and spoil `child`."""
    filled = 0
    for root in range(len(parent)):
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


@Kernel
@no_type_check
def _column_counts(starts, neighbours, order, place, parent, count, seen):
    """Entries of each column of L, the diagonal included: a row of L is a subtree from the row's entries upwards.

    `count` is 1 and `seen` -1 before.
    """
    for row in range(len(order)):
        seen[row] = row
        for entry in range(starts[order[row]], starts[order[row] + 1]):
            column = place[neighbours[entry]]
            while column < row and seen[column] != row:
                seen[column] = row
                count[column] += 1
                column = parent[column]


def _fundamental(parent: np.ndarray, count: np.ndarray) -> np.ndarray:
    """The last node of the supernode of each node: chains without a branch whose columns have the same rows."""
    nodes = np.arange(len(parent))
    only = np.bincount(parent[parent >= 0], minlength=len(parent)) == 1
    last = np.ones(len(parent), bool)
    last[:-1] = ~((parent[:-1] == nodes[1:]) & only[1:] & (count[:-1] == count[1:] + 1))
    heads = nodes[last]
    return heads[np.searchsorted(heads, nodes)]


def _merged(head: np.ndarray, parent: np.ndarray, count: np.ndarray, dim: int) -> np.ndarray:
    """`head` after merging supernodes into their parents where it saves modelled time. A head is its highest node."""
    nodes = np.arange(len(head))
    above = np.where((head == nodes) & (parent >= 0), head[parent], -1)
    into = nodes.copy()
    _merge(*children(above), np.bincount(head, minlength=len(head)), count, into, dim)
    return into[head]


@Kernel
@no_type_check
def _merge(child, sibling, columns, count, into, dim):
    """Fill in which supernode each is merged into, itself at first; `columns` are those of heads, 0 of other nodes."""
    nodes = len(into)
    for top in range(nodes):
        vertex = child[top]
        while vertex >= 0:
            own = dim * (count[top] - 1)
            two = dim * columns[vertex]
            one = dim * columns[top]
            apart = _front_seconds(two, two + dim * (count[vertex] - 1)) + _front_seconds(one, one + own)
            if _front_seconds(one + two, one + two + own) < apart:
                columns[top] += columns[vertex]
                into[vertex] = top
            vertex = sibling[vertex]
    for node in range(nodes - 1, -1, -1):
        into[node] = into[into[node]]


def _collected(
    starts: np.ndarray,
    neighbours: np.ndarray,
    order: np.ndarray,
    parent: np.ndarray,
    count: np.ndarray,
    head: np.ndarray,
    dim: int,
) -> EliminationTree:
    """Number the supernodes given by their heads in postorder, and list their rows."""
    tops = np.flatnonzero(head == np.arange(len(head)))
    number = np.full(len(head) + 1, -1)  # the last for the parent -1 of a root
    number[tops] = np.arange(len(tops))
    above = number[np.where(parent[tops] >= 0, head[parent[tops]], -1)]
    walk = _postordered(above)
    rank = np.append(_inverse(walk), -1)
    up = rank[above[walk]]
    which = rank[number[head]]
    order = order[np.argsort(which, kind="stable")]
    first = np.append(0, np.cumsum(np.bincount(which, minlength=len(tops))))
    begins = np.append(0, np.cumsum(count[tops[walk]] - 1))
    rows = np.empty(begins[-1], np.int64)
    _rows(starts, neighbours, order, _inverse(order), first, *children(up), begins, rows, np.full(len(order), -1))
    owner = np.repeat(np.arange(len(tops)), np.diff(begins)) * len(order)
    rows = np.sort(owner + rows) - owner
    columns = dim * np.diff(first)
    seconds = front_seconds(columns, columns + dim * np.diff(begins)).sum()
    return EliminationTree(order, first, up, begins, rows, float(seconds))


@Kernel
@no_type_check
def _rows(starts, neighbours, order, place, first, child, sibling, begins, rows, seen):
    """Rows below each supernode: of its nodes' neighbours and of its children, those after its last node.

    `seen` is -1 before.
    """
    for which in range(len(child)):
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
