"""`stuff`: tetrahedra cut from a lattice so that their outer faces follow the surface of a solid.

Isosurface stuffing (Labelle and Shewchuk 2007): where an edge of the lattice leaves the solid there is a cut; a node
that is near to a cut moves onto it; then the tetrahedra are cut. Unlike there, the sides of a prism are divided by the
order of the nodes, and one nearness does for all edges: the shapes are improved afterwards (`improve.py`).
"""

from collections.abc import Callable
from itertools import combinations

import numpy as np

from hydrostat.arrays import Bool, Elements, Float, Int, Nodes, Points, Vector
from hydrostat.geometry.surface import Solid


def signed_volumes(nodes: Nodes, elements: Elements) -> Float[np.ndarray, " elements"]:
    """Volume of each tetrahedron [m^3], negative where it is inside out."""
    first, *others = (nodes[corner] for corner in elements.T)
    one, two, three = (other - first for other in others)
    return np.einsum("ed,ed->e", np.cross(one, two), three) / 6


def turned_outward(nodes: Nodes, elements: Elements) -> Elements:
    """Return the same tetrahedra, two corners exchanged where one was inside out."""
    return np.where((signed_volumes(nodes, elements) < 0)[:, None], elements[:, [1, 0, 2, 3]], elements)


Wanted = Callable[[Points], Bool[np.ndarray, " points"]]  # which of many points [m] to keep

MEAN_EDGE = (6 + 8 * np.sqrt(0.75)) / 14
"""Mean length of its edges, in sides of its cells: each node has 6 of one side, and 8 of half a diagonal."""


def lattice(box: Float[np.ndarray, "2 3"], cell: float, wanted: Wanted | None = None) -> tuple[Nodes, Elements]:
    """Nodes [m] and tetrahedra of a lattice of cells [m] that covers a box with a cell to spare, centered on it.

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
    """Two tetrahedra for each, cut at the middle of an edge: first those with the edge's second end."""
    return np.concatenate([np.where(elements == edges[:, end, None], middles[:, None], elements) for end in (0, 1)])


def bisect(nodes: Nodes, elements: Elements, chosen: Bool[np.ndarray, " elements"]) -> tuple[Places, Tetrahedra]:
    """Divide chosen tetrahedra at the middle of their longest edges, and whatever shares these edges.

    An edge is divided only while it is the longest of all tetrahedra that have it, so others with longer edges are
    divided first. On the body-centered cubic lattice this leaves four shapes of tetrahedra, the lattice's own and
    three more, however often it is done; no angle gets below 45 degrees.
    """
    todo: Edges | None = None
    while todo is None or len(todo):
        every, which = edges_of(elements)
        longest = _longest(nodes, every, which)
        marked = np.zeros(len(every), dtype=bool)
        marked[longest[chosen] if todo is None else find_edges(every, todo)] = True
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
    """Longest edge of each tetrahedron; of equals, the same for all that have them."""
    lengths = np.linalg.norm(nodes[every[:, 1]] - nodes[every[:, 0]], axis=1)
    order = np.argsort(np.round(lengths / lengths.max(), 9), kind="stable")
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


def stuff(solid: Solid, nodes: Nodes, elements: Elements, distances: Vector) -> tuple[Places, Tetrahedra]:
    """Cut a solid out of a lattice with these nodal distances: return nodes [m] and elements."""
    return _cut_tetrahedra(solid, *_snap_nodes(solid, nodes, elements, distances))


def _snap_nodes(
    solid: Solid, nodes: Nodes, elements: Elements, distances: Vector
) -> tuple[Nodes, Elements, Int[np.ndarray, " nodes"], Edges, Places]:
    """Nodes with the side they are on (-1 in, 0 on the surface, 1 out), edges that are cut and where.

    A node near to a cut moves onto the nearest, and its own cuts are gone.
    """
    edges, _ = edges_of(elements)
    sides = np.where(distances < 0, -1, 1)
    edges = edges[sides[edges[:, 0]] != sides[edges[:, 1]]]
    shares = _edge_crossings(solid, nodes[edges], distances[edges])
    ends = nodes[edges]
    cuts = ends[:, 0] + shares[:, None] * (ends[:, 1] - ends[:, 0])
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    nodes = nodes.copy()
    owner = np.concatenate([edges[:, 0], edges[:, 1]])
    away = np.concatenate([shares, 1 - shares])
    which = np.tile(np.arange(len(edges)), 2)
    near = 0.3  # a cut this near to a node, in lengths of the edge, draws the node onto it
    close = away < near
    order = np.lexsort((which[close], (away * np.tile(lengths, 2))[close], owner[close]))
    movers, first = np.unique(owner[close][order], return_index=True)
    nodes[movers] = cuts[which[close][order][first]]
    sides[movers] = 0
    left = (sides[edges] != 0).all(axis=1)
    return nodes, elements, sides, edges[left], cuts[left]


_THERE = 1e-6  # a cut this near to the surface, in sizes of the body, is on it


def _edge_crossings(
    solid: Solid, ends: Float[np.ndarray, "edges 2 3"], distances: Float[np.ndarray, "edges 2"]
) -> Float[np.ndarray, " edges"]:
    """Share of each edge where it passes the surface, by the Illinois method, to a thousandth."""
    low, high = ends[:, 0], ends[:, 1]
    left, right = np.zeros(len(ends)), np.ones(len(ends))
    at_left, at_right = distances.T.copy()
    share = np.full(len(ends), 0.5)
    some = np.arange(len(ends))  # those that go on
    for _ in range(5):
        one, two = at_left[some], at_right[some]
        share[some] = left[some] + (right - left)[some] * np.clip(one / (one - two), 0.02, 0.98)
        value = solid.distances(low[some] + share[some, None] * (high - low)[some])
        same = (value < 0) == (one < 0)
        left[some[same]], right[some[~same]] = share[some[same]], share[some[~same]]
        at_left[some], at_right[some] = np.where(same, value, 0.5 * one), np.where(same, 0.5 * two, value)
        some = some[np.abs(value) > _THERE * solid.surface.size]
    return share


def _cut_tetrahedra(
    solid: Solid, nodes: Nodes, elements: Elements, sides: Int[np.ndarray, " nodes"], edges: Edges, cuts: Places
) -> tuple[Places, Tetrahedra]:
    """Parts of all tetrahedra inside: whole ones, corners, wedges."""
    count = len(nodes)
    keys = edges[:, 0] * count + edges[:, 1]

    def find_cut_node(inner: Numbers, outer: Numbers) -> Numbers:
        """Node of the cut between two nodes; a node that is on the surface is its own."""
        low, high = np.minimum(inner, outer), np.maximum(inner, outer)
        found = count + np.searchsorted(keys, low * count + high)
        return np.where(sides[outer] == 0, outer, found)

    order = np.argsort(sides[elements] * (count + 1.0) * 2 + elements, axis=1)
    elements = np.take_along_axis(elements, order, axis=1)
    inside = (sides[elements] < 0).sum(axis=1)
    outside = (sides[elements] > 0).sum(axis=1)
    flat = elements[(inside == 0) & (outside == 0)]
    parts = [elements[(inside > 0) & (outside == 0)], flat[_deep(solid, nodes[flat])]]
    a, b, c, d = elements[(inside == 1) & (outside > 0)].T
    parts.append(np.column_stack([a, find_cut_node(a, b), find_cut_node(a, c), find_cut_node(a, d)]))
    a, b, c, d = elements[(inside == 2) & (outside > 0)].T
    parts += _wedge(
        np.concatenate([nodes, cuts]),
        a,
        find_cut_node(a, c),
        find_cut_node(a, d),
        b,
        find_cut_node(b, c),
        find_cut_node(b, d),
    )
    a, b, c, d = elements[(inside == 3) & (outside > 0)].T
    lower, upper, top = find_cut_node(a, d), find_cut_node(b, d), find_cut_node(c, d)
    parts += [np.column_stack(part) for part in ((a, b, c, top), (a, b, upper, top), (a, lower, upper, top))]
    filled, places = np.concatenate(parts), np.concatenate([nodes, cuts])
    filled = filled[_four_corners(filled)]
    return places, turned_outward(places, filled)


def _wedge(nodes: Nodes, a: Numbers, ac: Numbers, ad: Numbers, b: Numbers, bc: Numbers, bd: Numbers) -> list[Elements]:
    """Three tetrahedra of a prism with an inner edge a-b; its outer side is divided along its shorter diagonal."""
    parts = [np.column_stack([a, b, bc, bd])]
    first = np.linalg.norm(nodes[ac] - nodes[bd], axis=1) <= np.linalg.norm(nodes[ad] - nodes[bc], axis=1)
    parts.append(np.where(first[:, None], np.column_stack([a, ac, ad, bd]), np.column_stack([a, ac, ad, bc])))
    parts.append(np.where(first[:, None], np.column_stack([a, ac, bc, bd]), np.column_stack([a, ad, bc, bd])))
    return parts


def _deep(solid: Solid, corners: Float[np.ndarray, "elements 4 3"]) -> Bool[np.ndarray, " elements"]:
    """Find the tetrahedra with all corners on the surface that are no slices of it: their middles lie well inside."""
    lengths = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    # a tetrahedron with all corners on the surface is kept if its middle is deeper, in lengths of an edge
    deep = 0.1
    return solid.distances(corners.mean(axis=1)) < -deep * lengths


def _four_corners(elements: Elements) -> Bool[np.ndarray, " elements"]:
    """Find the tetrahedra that have four different corners."""
    ordered = np.sort(elements, axis=1)
    return (ordered[:, 1:] != ordered[:, :-1]).all(axis=1)


_OPEN = 0.05  # a place of an edge as far outside, in lengths of the edge, is in a gap


def find_bridges(
    solid: Solid, nodes: Nodes, elements: Elements, distances: Vector
) -> tuple[Bool[np.ndarray, " elements"], Places]:
    """Find the tetrahedra with an edge whose ends are inside and that passes outside, and the points outside [m].

    Only edges longer than what their ends are deep can: no ball about an end reaches the surface. Without them the
    body has a dent there, which is better than fingers grown together, and finer elements then mend it.
    """
    edges, which = edges_of(elements)
    lengths = np.linalg.norm(nodes[edges[:, 1]] - nodes[edges[:, 0]], axis=1)
    ends = distances[edges]
    asked = np.flatnonzero((ends < 0).all(axis=1) & (lengths + ends.sum(axis=1) > 0))
    crossing = np.zeros(len(edges), dtype=bool)
    places = [np.empty((0, 3))]
    along = (0.25, 0.5, 0.75)  # where to look along an edge
    for share in along:
        there = (1 - share) * nodes[edges[asked, 0]] + share * nodes[edges[asked, 1]]
        outside = solid.distances(there) > _OPEN * lengths[asked]
        crossing[asked[outside]] = True
        places.append(there[outside])
    return np.asarray(crossing[which].any(axis=1)), np.concatenate(places)
