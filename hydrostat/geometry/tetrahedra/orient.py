"""Tetrahedra turned the right way round."""

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Elements, Nodes


def signed_volumes(nodes: Nodes, elements: Elements) -> Float[np.ndarray, " elements"]:
    """Volume of each tetrahedron [m^3], negative where it is inside out."""
    first, *others = (nodes[corner] for corner in elements.T)
    one, two, three = (other - first for other in others)
    return np.einsum("ed,ed->e", np.cross(one, two), three) / 6


def turned_outward(nodes: Nodes, elements: Elements) -> Elements:
    """The same tetrahedra, two corners exchanged where one was inside out."""
    return np.where((signed_volumes(nodes, elements) < 0)[:, None], elements[:, [1, 0, 2, 3]], elements)
