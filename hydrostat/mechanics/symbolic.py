"""Symbolic factorization, from the sparsity pattern alone: elimination tree, supernodes, fronts.

The elimination tree (Liu 1990) says which column first needs which: the parent of a node is the first of its neighbors
to be eliminated after it, fill-in counted. Nodes in a chain whose columns have the same rows are a supernode,
eliminated together in one dense front. Larger fronts run faster, so a supernode is merged into its parent, zeros and
all, where a model of time says that this pays (relaxed supernodes: Ashcraft and Grimes 1989).

Everything here counts nodes, that is blocks of `dim` degrees of freedom.
"""

from typing import NamedTuple

import numpy as np

from hydrostat.kernel import native

RATE = 30e9
RAMP = 12.0
"""A model of time [s]: of a front; of an entry of L; of an entry handed on to the parent; of an operation of a large
front, whose rate is halved where a front has only RAMP columns. Set on one machine (docs/decisions/0007)."""


class EliminationTree(NamedTuple):
    """Supernodes in the order of their elimination, children before parents.

    Attributes:
        order: nodes in the order of their elimination.
        first: position of the first node of each supernode, followed by the number of nodes, (supernodes + 1,).
        parent: parent of each supernode; -1 for a root.
        starts: start of the rows of each supernode, (supernodes + 1,).
        rows: positions of the nodes below each supernode, in rising order.
        seconds: modeled time of a factorization [s].
    """

    order: np.ndarray
    first: np.ndarray
    parent: np.ndarray
    starts: np.ndarray
    rows: np.ndarray
    seconds: float


def front_seconds(columns: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Modelled time of fronts with that many columns and rows (columns included), in degrees of freedom."""
    below = rows - columns
    operations = columns * (columns * columns / 3.0 + columns * below + below * 1.0 * below)
    rate = RATE * columns / (columns + RAMP)
    front = 1.5e-6
    entry = 0.6e-9
    update = 0.8e-9
    return front + entry * columns * rows + 0.5 * update * below * below + operations / rate


def supernodes(starts: np.ndarray, neighbors: np.ndarray, order: np.ndarray, dim: int) -> EliminationTree:
    """Supernodes of eliminating a graph in a given order."""
    order = order[_postorder(_elimination(starts, neighbors, order))]
    parent = _elimination(starts, neighbors, order)
    count = np.ones(len(order), np.int64)
    native.column_counts(starts, neighbors, order, _inverse(order), parent, count, np.full(len(order), -1))
    head = _merge_supernodes(_fundamental(parent, count), parent, count, dim)
    return _collect_tree(starts, neighbors, order, parent, count, head, dim)


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
    """Place of each node in an order."""
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    return place


def _elimination(starts: np.ndarray, neighbors: np.ndarray, order: np.ndarray) -> np.ndarray:
    """Elimination tree: parent of each place in the order; -1 at a root."""
    parent, ancestor = np.full(len(order), -1), np.full(len(order), -1)
    native.elimination_tree(starts, neighbors, order, _inverse(order), parent, ancestor)
    return parent


def _postorder(parent: np.ndarray) -> np.ndarray:
    """Vertices of a forest, children before parents, each subtree in one piece."""
    child, sibling = children(parent)
    result, stack = np.empty(len(parent), np.int64), np.empty(len(parent), np.int64)
    native.postorder(parent, child, sibling, result, stack)
    return result


def _fundamental(parent: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Last node of the supernode of each node: chains without a branch whose columns have the same rows."""
    nodes = np.arange(len(parent))
    only = np.bincount(parent[parent >= 0], minlength=len(parent)) == 1
    last = np.ones(len(parent), bool)
    last[:-1] = ~((parent[:-1] == nodes[1:]) & only[1:] & (count[:-1] == count[1:] + 1))
    heads = nodes[last]
    return heads[np.searchsorted(heads, nodes)]


def _merge_supernodes(head: np.ndarray, parent: np.ndarray, count: np.ndarray, dim: int) -> np.ndarray:
    """`head` after merging supernodes into their parents where it saves modeled time. A head is its highest node."""
    nodes = np.arange(len(head))
    above = np.where((head == nodes) & (parent >= 0), head[parent], -1)
    into = nodes.copy()
    native.merge(*children(above), np.bincount(head, minlength=len(head)), count, into, dim)
    return into[head]


def _collect_tree(
    starts: np.ndarray,
    neighbors: np.ndarray,
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
    walk = _postorder(above)
    rank = np.append(_inverse(walk), -1)
    up = rank[above[walk]]
    which = rank[number[head]]
    order = order[np.argsort(which, kind="stable")]
    first = np.append(0, np.cumsum(np.bincount(which, minlength=len(tops))))
    begins = np.append(0, np.cumsum(count[tops[walk]] - 1))
    rows = np.empty(begins[-1], np.int64)
    native.rows(starts, neighbors, order, _inverse(order), first, *children(up), begins, rows, np.full(len(order), -1))
    owner = np.repeat(np.arange(len(tops)), np.diff(begins)) * len(order)
    rows = np.sort(owner + rows) - owner
    columns = dim * np.diff(first)
    seconds = front_seconds(columns, columns + dim * np.diff(begins)).sum()
    return EliminationTree(order, first, up, begins, rows, float(seconds))
