"""`stuff`: tetrahedra cut from a lattice so that their outer faces follow the surface of a solid.

Isosurface stuffing (Labelle and Shewchuk 2007): where an edge of the lattice leaves the solid there is a cut; a node
that is near to a cut moves onto it; then the tetrahedra are cut. Ours differs in two things. Edges that leave the solid
and come back, as between two fingers, are divided first, so that what lies apart stays apart. And the sides of a prism
are divided by the order of the nodes, as the shapes are improved afterwards (`improve.py`).
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float, Int

from hydrostat.arrays import Elements, Nodes, Vector
from hydrostat.geometry.orient import turned_outward
from hydrostat.geometry.solid import Solid

PAIRS = tuple(combinations(range(4), 2))
"""The edges of a tetrahedron, by the places of their ends."""

Edges = Int[np.ndarray, "edges 2"]

_NEAR_LONG, _NEAR_SHORT = 0.24999, 0.41189
"""A cut this near to a node, in lengths of the edge, draws the node onto it: on sides of cells and on half diagonals
(Labelle and Shewchuk 2007, table 1)."""

_STATIONS = (0.25, 0.5, 0.75)
"""Where an edge is looked at for a gap or a thin wall, in its length."""


@dataclass(frozen=True, eq=False)
class _Draft:
    """Tetrahedra about a solid and the distance of their nodes from its surface [m], negative inside."""

    nodes: Nodes
    elements: Elements
    distances: Vector


def stuff(solid: Solid, nodes: Nodes, elements: Elements, *, cell: float) -> tuple[Nodes, Elements]:
    """What a solid takes of a lattice whose cells have a side [m]; nodes [m] and elements."""
    near = solid.distances(nodes)
    kept = (near[elements] < cell).any(axis=1)
    draft = _compact(_Draft(nodes, elements[kept], near))
    draft = _divided(solid, draft)
    return _cut(*_snapped(solid, draft, cell))


def edges_of(elements: Elements) -> tuple[Edges, Int[np.ndarray, "elements 6"]]:
    """Every edge once, lower node first, and which six each tetrahedron has."""
    pairs = np.sort(np.stack([elements[:, list(pair)] for pair in PAIRS], axis=1), axis=2)
    count = int(elements.max()) + 1
    keys, which = np.unique(pairs[..., 0] * count + pairs[..., 1], return_inverse=True)
    return np.column_stack([keys // count, keys % count]), which.reshape(len(elements), 6)


def _compact(draft: _Draft) -> _Draft:
    used, elements = np.unique(draft.elements, return_inverse=True)
    return _Draft(draft.nodes[used], elements.reshape(-1, 4), draft.distances[used])


def _divided(solid: Solid, draft: _Draft) -> _Draft:
    """Divide edges that leave the solid and come back, or that pass through a thin wall of it."""
    edges, _ = edges_of(draft.elements)
    ends = draft.nodes[edges]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    signs = draft.distances[edges] < 0
    twice = (signs[:, 0] == signs[:, 1]) & (np.abs(draft.distances[edges]).sum(axis=1) < lengths)
    edges, ends, inside = edges[twice], ends[twice], signs[twice, 0]
    if not len(edges):
        return draft
    places = np.stack([(1 - share) * ends[:, 0] + share * ends[:, 1] for share in _STATIONS], axis=1)
    depths = solid.distances(places.reshape(-1, 3)).reshape(-1, len(_STATIONS))
    beyond = np.where(inside[:, None], depths, -depths)
    best = np.argmax(beyond, axis=1)
    rows = np.arange(len(edges))
    crossed = beyond[rows, best] > 0
    rows, best = rows[crossed], best[crossed]
    return _with_nodes(draft, edges[rows], places[rows, best], depths[rows, best])


def _with_nodes(draft: _Draft, edges: Edges, places: Nodes, depths: Vector) -> _Draft:
    """Divide edges at places, in rounds in which no tetrahedron has two of them."""
    elements, count = draft.elements, len(draft.nodes)
    nodes, distances = np.concatenate([draft.nodes, places]), np.concatenate([draft.distances, depths])
    todo = np.arange(len(edges))
    while len(todo):
        every, which = edges_of(elements)
        number = _find(every, edges[todo], len(nodes))
        rank = np.full(len(every), -1)
        rank[number] = len(todo) - np.arange(len(todo))
        first = rank[which].max(axis=1)
        wins = np.ones(len(todo) + 1, dtype=bool)
        beaten = (rank[which] >= 0) & (rank[which] < first[:, None])
        wins[rank[which][beaten]] = False
        chosen = first >= 0
        chosen[chosen] &= wins[first[chosen]]
        new = count + todo[len(todo) - first[chosen]]
        elements = np.concatenate([elements[~chosen], _halves(elements[chosen], edges[new - count], new)])
        todo = todo[~wins[len(todo) - np.arange(len(todo))]]
    return _Draft(nodes, elements, distances)


def _find(every: Edges, some: Edges, count: int) -> Int[np.ndarray, " some"]:
    """Numbers of some edges among all, which are sorted."""
    return np.searchsorted(every[:, 0] * count + every[:, 1], some[:, 0] * count + some[:, 1])


def _halves(elements: Elements, edges: Edges, new: Int[np.ndarray, " elements"]) -> Elements:
    """Two tetrahedra for each whose edge gets a new node."""
    return np.concatenate([np.where(elements == edges[:, end, None], new[:, None], elements) for end in (0, 1)])


def _snapped(
    solid: Solid, draft: _Draft, cell: float
) -> tuple[Nodes, Elements, Int[np.ndarray, " nodes"], Edges, Nodes]:
    """Nodes with the side they are on (-1 in, 0 on the surface, 1 out), edges that are cut and where.

    A node near to a cut moves onto the nearest, and its own cuts are gone.
    """
    edges, _ = edges_of(draft.elements)
    sides = np.where(draft.distances < 0, -1, 1)
    edges = edges[sides[edges[:, 0]] != sides[edges[:, 1]]]
    shares = _crossings(solid, draft, edges)
    ends = draft.nodes[edges]
    cuts = ends[:, 0] + shares[:, None] * (ends[:, 1] - ends[:, 0])
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    near = np.where(lengths > 0.93 * cell, _NEAR_LONG, _NEAR_SHORT)
    nodes = draft.nodes.copy()
    owner = np.concatenate([edges[:, 0], edges[:, 1]])
    away = np.concatenate([shares, 1 - shares])
    which = np.tile(np.arange(len(edges)), 2)
    close = away < np.tile(near, 2)
    order = np.lexsort((which[close], (away * np.tile(lengths, 2))[close], owner[close]))
    movers, first = np.unique(owner[close][order], return_index=True)
    nodes[movers] = cuts[which[close][order][first]]
    sides[movers] = 0
    left = (sides[edges] != 0).all(axis=1)
    return nodes, draft.elements, sides, edges[left], cuts[left]


def _crossings(solid: Solid, draft: _Draft, edges: Edges) -> Float[np.ndarray, " edges"]:
    """Share of each edge where it passes the surface, by the Illinois method, to a thousandth."""
    low, high = draft.nodes[edges[:, 0]], draft.nodes[edges[:, 1]]
    left, right = np.zeros(len(edges)), np.ones(len(edges))
    at_left, at_right = draft.distances[edges[:, 0]], draft.distances[edges[:, 1]]
    share = np.full(len(edges), 0.5)
    for _ in range(5):
        share = left + (right - left) * np.clip(at_left / (at_left - at_right), 0.02, 0.98)
        value = solid.distances(low + share[:, None] * (high - low))
        same = (value < 0) == (at_left < 0)
        left, right = np.where(same, share, left), np.where(same, right, share)
        at_left, at_right = np.where(same, value, 0.5 * at_left), np.where(same, 0.5 * at_right, value)
    return share


def _cut(
    nodes: Nodes, elements: Elements, sides: Int[np.ndarray, " nodes"], edges: Edges, cuts: Nodes
) -> tuple[Nodes, Elements]:
    """The parts of all tetrahedra inside: whole ones, corners, wedges."""
    count = len(nodes)
    keys = edges[:, 0] * count + edges[:, 1]

    def cut(inner: Int[np.ndarray, " some"], outer: Int[np.ndarray, " some"]) -> Int[np.ndarray, " some"]:
        """The node of the cut between two nodes; a node that is on the surface is its own."""
        low, high = np.minimum(inner, outer), np.maximum(inner, outer)
        found = count + np.searchsorted(keys, low * count + high)
        return np.where(sides[outer] == 0, outer, found)

    order = np.argsort(sides[elements] * (count + 1.0) * 2 + elements, axis=1)
    elements = np.take_along_axis(elements, order, axis=1)
    inside = (sides[elements] < 0).sum(axis=1)
    outside = (sides[elements] > 0).sum(axis=1)
    parts = [elements[(inside > 0) & (outside == 0)]]
    a, b, c, d = elements[(inside == 1) & (outside > 0)].T
    parts.append(np.column_stack([a, cut(a, b), cut(a, c), cut(a, d)]))
    a, b, c, d = elements[(inside == 2) & (outside > 0)].T
    parts += _wedge(np.concatenate([nodes, cuts]), a, cut(a, c), cut(a, d), b, cut(b, c), cut(b, d))
    a, b, c, d = elements[(inside == 3) & (outside > 0)].T
    lower, upper, top = cut(a, d), cut(b, d), cut(c, d)
    parts += [np.column_stack(part) for part in ((a, b, c, top), (a, b, upper, top), (a, lower, upper, top))]
    filled, places = np.concatenate(parts), np.concatenate([nodes, cuts])
    filled = filled[_different(filled)]
    return places, turned_outward(places, filled)


def _wedge(nodes: Nodes, a: np.ndarray, ac: np.ndarray, ad: np.ndarray, b: np.ndarray, bc: np.ndarray, bd: np.ndarray):  # noqa: E501
    """Three tetrahedra of a prism with an inner edge a-b; its outer side is divided along its shorter diagonal."""
    parts = [np.column_stack([a, b, bc, bd])]
    first = np.linalg.norm(nodes[ac] - nodes[bd], axis=1) <= np.linalg.norm(nodes[ad] - nodes[bc], axis=1)
    parts.append(np.where(first[:, None], np.column_stack([a, ac, ad, bd]), np.column_stack([a, ac, ad, bc])))
    parts.append(np.where(first[:, None], np.column_stack([a, ac, bc, bd]), np.column_stack([a, ad, bc, bd])))
    return parts


def _different(elements: Elements) -> Bool[np.ndarray, " elements"]:
    """Which tetrahedra have four different corners."""
    ordered = np.sort(elements, axis=1)
    return (ordered[:, 1:] != ordered[:, :-1]).all(axis=1)
