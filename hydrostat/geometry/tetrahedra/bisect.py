"""`bisect`: finer tetrahedra in some places, by halving longest edges (Rivara 1984)."""

import numpy as np
from jaxtyping import Bool, Int

from hydrostat.arrays import Elements, Nodes
from hydrostat.geometry.tetrahedra.edges import Edges, Places, Tetrahedra, edges_of, find_edges, halves


def bisect(nodes: Nodes, elements: Elements, chosen: Bool[np.ndarray, " elements"]) -> tuple[Places, Tetrahedra]:
    """Divide chosen tetrahedra at the middle of their longest edges, and whatever shares these edges.

    An edge is divided only while it is the longest of all tetrahedra that have it, so others with longer edges are
    divided first. On the body-centred cubic lattice this leaves four shapes of tetrahedra, the lattice's own and
    three more, however often it is done; no angle gets below 45 degrees.
    """
    every, which = edges_of(elements)
    marked = np.zeros(len(every), dtype=bool)
    marked[_longest(nodes, every, which)[chosen]] = True
    todo = every[marked]
    while len(todo):
        every, which = edges_of(elements)
        longest = _longest(nodes, every, which)
        marked = np.zeros(len(every), dtype=bool)
        marked[find_edges(every, todo)] = True
        _close(marked, which, longest)
        ready = marked.copy()
        ready[which[marked[which] & (which != longest[:, None])]] = False
        new = np.full(len(every), -1)
        new[ready] = len(nodes) + np.arange(ready.sum())
        nodes = np.concatenate([nodes, nodes[every[ready]].mean(axis=1)])
        split = ready[longest]
        edges, middles = every[longest[split]], new[longest[split]]
        elements = np.concatenate([elements[~split], halves(elements[split], edges, middles)])
        todo = every[marked & ~ready]
    return nodes, elements


def _longest(nodes: Nodes, every: Edges, which: Int[np.ndarray, "elements 6"]) -> Int[np.ndarray, " elements"]:
    """The longest edge of each tetrahedron; of equals, the same for all that have them."""
    lengths = np.linalg.norm(nodes[every[:, 1]] - nodes[every[:, 0]], axis=1)
    order = np.lexsort((np.arange(len(every)), np.round(lengths / lengths.max(), 9)))
    rank = np.empty(len(every), dtype=np.int64)
    rank[order] = np.arange(len(every))
    return np.take_along_axis(which, np.argmax(rank[which], axis=1)[:, None], axis=1)[:, 0]


def _close(
    marked: Bool[np.ndarray, " edges"], which: Int[np.ndarray, "elements 6"], longest: Int[np.ndarray, " elements"]
) -> None:
    """Mark the longest edge wherever any is marked, until nothing is added."""
    while True:
        more = longest[marked[which].any(axis=1)]
        if marked[more].all():
            return
        marked[more] = True
