"""Edges of tetrahedra: found, numbered, divided."""

from itertools import combinations

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Elements

PAIRS = tuple(combinations(range(4), 2))
"""The edges of a tetrahedron, by the places of their ends."""

Edges = Int[np.ndarray, "_ 2"]
"""Pairs of nodes, the lower first."""

Numbers = Int[np.ndarray, " _"]
"""Numbers of edges, nodes or elements."""

Places = Float[np.ndarray, "_ 3"]
"""Nodes [m], of whatever number beside others."""

Tetrahedra = Int[np.ndarray, "_ 4"]
"""Nodes of each tetrahedron, of whatever number beside others."""


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
