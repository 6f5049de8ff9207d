"""`ElementGroups`: simplices as the compiled core reads them, eight side by side."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from hydrostat.mechanics.energy import Stencils

_SIDE_BY_SIDE = 8


class ElementGroups(NamedTuple):
    """Elements eight at a time, the last group filled up with elements of no volume.

    Attributes:
        stencils: nodes, (groups, corners, 8).
        gradients: of the shape functions [1/m], (groups, corners, dim, 8).
        volumes: [m^3], (groups, 8).
        terms: how many elements there are.
    """

    stencils: np.ndarray
    gradients: np.ndarray
    volumes: np.ndarray
    terms: int


def element_groups(
    stencils: Stencils, gradients: Float[np.ndarray, "terms corners dim"], volumes: Float[np.ndarray, " terms"]
) -> ElementGroups:
    """Elements with their shape gradients [1/m] and volumes [m^3] in groups."""
    count, missing = len(stencils), -len(stencils) % _SIDE_BY_SIDE

    def grouped(array: np.ndarray, kind: type) -> np.ndarray:
        filled = np.concatenate([array, np.zeros((missing, *array.shape[1:]))])
        groups = filled.reshape(-1, _SIDE_BY_SIDE, *array.shape[1:])
        return np.ascontiguousarray(np.moveaxis(groups, 1, -1), dtype=kind)

    return ElementGroups(grouped(stencils, np.int32), grouped(gradients, float), grouped(volumes, float), count)
