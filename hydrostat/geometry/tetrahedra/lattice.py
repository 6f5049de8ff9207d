"""Tetrahedra of a body-centred cubic lattice that bodies are cut from: made, turned, their edges found and halved."""

from collections.abc import Callable
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float, Int

from hydrostat.arrays import Elements, Nodes, Points


def signed_volumes(nodes: Nodes, elements: Elements) -> Float[np.ndarray, " elements"]:
    """Volume of each tetrahedron [m^3], negative where it is inside out."""
    first, *others = (nodes[corner] for corner in elements.T)
    one, two, three = (other - first for other in others)
    return np.einsum("ed,ed->e", np.cross(one, two), three) / 6


def turned_outward(nodes: Nodes, elements: Elements) -> Elements:
    """The same tetrahedra, two corners exchanged where one was inside out."""
    return np.where((signed_volumes(nodes, elements) < 0)[:, None], elements[:, [1, 0, 2, 3]], elements)


Wanted = Callable[[Points], Bool[np.ndarray, " points"]]  # which of many points [m] to keep

MEAN_EDGE = (6 + 8 * np.sqrt(0.75)) / 14
"""Mean length of its edges, in sides of its cells: each node has 6 of one side, and 8 of half a diagonal."""


def lattice(box: Float[np.ndarray, "2 3"], cell: float, wanted: Wanted | None = None) -> tuple[Nodes, Elements]:
    """Nodes [m] and tetrahedra of a lattice of cells [m] that covers a box with a cell to spare, centred on it.

    Its tetrahedra are all alike, with dihedral angles of 60 and 90 degrees: each edge of a face between two cells makes
    one with the middles of both (Labelle and Shewchuk 2007). Only those with a cell that is `wanted`, by its middle
    [m], are made.
    """
    cells = np.ceil(np.ptp(box, axis=0) / cell).astype(int) + 3
    low = box.mean(axis=0) - 0.5 * cells * cell
    corners = np.stack(np.meshgrid(*[np.arange(count + 1) for count in cells], indexing="ij"), axis=-1)
    middles = np.stack(np.meshgrid(*[np.arange(count) + 0.5 for count in cells], indexing="ij"), axis=-1)
    nodes = np.concatenate([corners.reshape(-1, 3), middles.reshape(-1, 3)]) * cell + low
    corner = np.arange(np.prod(cells + 1)).reshape(cells + 1)
    middle = corner.size + np.arange(np.prod(cells)).reshape(cells)
    kept = np.ones(middle.size, dtype=bool) if wanted is None else wanted(nodes[corner.size :])
    kept = kept.reshape(cells)
    elements = []
    for axis in range(3):
        before, after = np.moveaxis(middle, axis, 0)[:-1], np.moveaxis(middle, axis, 0)[1:]
        here = np.moveaxis(kept, axis, 0)[:-1] | np.moveaxis(kept, axis, 0)[1:]
        face = np.moveaxis(corner, axis, 0)[1:-1]
        ring = [face[:, :-1, :-1], face[:, 1:, :-1], face[:, 1:, 1:], face[:, :-1, 1:]]
        for one, two in zip(ring, ring[1:] + ring[:1], strict=True):
            elements.append(np.column_stack([before[here], after[here], one[here], two[here]]))
    return nodes, turned_outward(nodes, np.concatenate(elements))


PAIRS = tuple(combinations(range(4), 2))  # the edges of a tetrahedron, by the places of their ends
Edges = Int[np.ndarray, "_ 2"]  # pairs of nodes, the lower first
Numbers = Int[np.ndarray, " _"]  # numbers of edges, nodes or elements
Places = Float[np.ndarray, "_ 3"]  # nodes [m], of whatever number beside others
Tetrahedra = Int[np.ndarray, "_ 4"]  # nodes of each tetrahedron, of whatever number beside others


def edges_of(elements: Elements) -> tuple[Edges, Int[np.ndarray, "elements 6"]]:
    """Every edge once, sorted, and which six each tetrahedron has."""
    pairs = np.sort(np.stack([elements[:, list(pair)] for pair in PAIRS], axis=1), axis=2)
    count = int(elements.max(initial=0)) + 1
    keys, which = np.unique(pairs[..., 0] * count + pairs[..., 1], return_inverse=True)
    return np.column_stack([keys // count, keys % count]), which.reshape(len(elements), 6)


def find_edges(every: Edges, some: Edges) -> Numbers:
    """Numbers of some edges among all, which are sorted."""
    count = int(every.max(initial=0)) + 1
    return np.searchsorted(every[:, 0] * count + every[:, 1], some[:, 0] * count + some[:, 1])


def halves(elements: Tetrahedra, edges: Edges, middles: Numbers) -> Tetrahedra:
    """Two tetrahedra for each, whose edge gets a node in its middle: first those with the edge's second end."""
    return np.concatenate([np.where(elements == edges[:, end, None], middles[:, None], elements) for end in (0, 1)])


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
