"""`find_part_lines`: closed lines on the parts of a body, which show them through its skin."""

from functools import lru_cache

import numpy as np

from hydrostat.arrays import Int, Points
from hydrostat.robot import Body, find_part_facets, find_rings


@lru_cache(maxsize=8)
def find_part_lines(body: Body) -> tuple[Points, ...]:
    """Closed lines at rest [m]: borders of the parts of a flat body; in space sections through their middles."""
    nodes = body.mesh.nodes
    if body.mesh.dim == 2:
        return tuple(nodes[[*loop, loop[0]]] for loops in body.part_rings for loop in loops)
    lines = list[Points]()
    for facets in find_part_facets(body.mesh, body.element_materials, len(body.parts)):
        corners = nodes[facets]
        for axis, middle in enumerate((corners.min(axis=(0, 1)) + corners.max(axis=(0, 1))) / 2):
            lines += _find_sections(nodes, facets, axis, float(middle))
    return tuple(lines)


def _find_sections(nodes: Points, facets: Int[np.ndarray, "_ 3"], axis: int, place: float) -> list[Points]:
    """Closed lines where a surface meets the plane across an axis at a place [m]."""
    above = nodes[:, axis] > place
    starts, ends = facets, np.roll(facets, -1, axis=1)
    rising, falling = ~above[starts] & above[ends], above[starts] & ~above[ends]
    met = rising.any(axis=1)
    # each facet that is met has one rising and one falling side; its neighbor has the same side the other way round
    sides = np.concatenate([[starts[met][flags[met]], ends[met][flags[met]]] for flags in (rising, falling)], axis=1).T
    edges, numbers = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    heights = nodes[edges][:, :, axis] - place
    shares = (heights[:, 0] / (heights[:, 0] - heights[:, 1]))[:, None]
    points = nodes[edges[:, 0]] + shares * (nodes[edges[:, 1]] - nodes[edges[:, 0]])
    chains = find_rings(numbers.reshape(2, -1).T)
    return [points[[*chain, chain[0]]] for chain in chains]
