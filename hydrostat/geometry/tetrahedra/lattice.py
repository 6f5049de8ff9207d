"""`lattice`: the body-centred cubic lattice of tetrahedra that bodies are cut from."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float

from hydrostat.arrays import Elements, Nodes, Points
from hydrostat.geometry.tetrahedra.orient import turned_outward

Wanted = Callable[[Points], Bool[np.ndarray, " points"]]
"""Which of many points [m] to keep."""

MEAN_EDGE = (6 + 8 * np.sqrt(0.75)) / 14
"""Mean length of its edges, in sides of its cells: each node has 6 of one side, and 8 of half a diagonal."""


def lattice(box: Float[np.ndarray, "2 3"], cell: float, wanted: Wanted | None = None) -> tuple[Nodes, Elements]:
    """Nodes [m] and tetrahedra of a lattice that covers a box with a cell to spare, centred on it.

    Its tetrahedra are all alike, with dihedral angles of 60 and 90 degrees: each edge of a face between two cells makes
    one with the middles of both (Labelle and Shewchuk 2007).

    Args:
        box: lowest and highest coordinates [m].
        cell: side of a cell [m].
        wanted: tells of the middles of cells [m] which tetrahedra to make: those with a wanted one; None: all.
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
