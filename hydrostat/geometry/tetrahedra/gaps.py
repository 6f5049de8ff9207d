"""`find_bridges`: tetrahedra of a lattice that would join two limbs across a gap narrower than they are."""

import numpy as np
from jaxtyping import Bool

from hydrostat.arrays import Elements, Nodes, Vector
from hydrostat.geometry.solid import Solid
from hydrostat.geometry.tetrahedra.edges import Places, edges_of

_ALONG = (0.25, 0.5, 0.75)
"""Where to look along an edge."""

_OPEN = 0.05
"""A place of an edge as far outside, in lengths of the edge, is in a gap."""


def find_bridges(
    solid: Solid, nodes: Nodes, elements: Elements, distances: Vector
) -> tuple[Bool[np.ndarray, " elements"], Places]:
    """Which tetrahedra have an edge with both ends inside that passes outside, and where it does [m].

    Only edges longer than what their ends are deep can: no ball about an end reaches the surface. Without them the
    body has a dent there, which is better than fingers grown together, and finer elements then mend it.
    """
    edges, which = edges_of(elements)
    lengths = np.linalg.norm(nodes[edges[:, 1]] - nodes[edges[:, 0]], axis=1)
    ends = distances[edges]
    asked = np.flatnonzero((ends < 0).all(axis=1) & (lengths + ends.sum(axis=1) > 0))
    crossing = np.zeros(len(edges), dtype=bool)
    places = [np.empty((0, 3))]
    for share in _ALONG:
        there = (1 - share) * nodes[edges[asked, 0]] + share * nodes[edges[asked, 1]]
        outside = solid.distances(there) > _OPEN * lengths[asked]
        crossing[asked[outside]] = True
        places.append(there[outside])
    return np.asarray(crossing[which].any(axis=1)), np.concatenate(places)
