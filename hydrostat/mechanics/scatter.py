"""`Places`: where the blocks of an energy go in the Hessian; and how vectors and blocks of its terms are added up."""

from typing import NamedTuple, no_type_check

import numpy as np
from numba import njit

from hydrostat.kernel import KERNEL


class Places(NamedTuple):
    """Where the Hessian blocks of one energy are added.

    Attributes:
        slots: first place of the block of each pair of corners of each term, (terms, corners, corners).
        strides: distance of two columns of each node, (nodes,).
        data: values of the sparse matrix, column by column, both triangles.
    """

    slots: np.ndarray
    strides: np.ndarray
    data: np.ndarray


@njit(**KERNEL)
@no_type_check
def add_vectors(stencils, vectors, total):
    """Add the vector of every corner of every term to its node."""
    for term in range(stencils.shape[0]):
        for corner in range(stencils.shape[1]):
            node = stencils[term, corner]
            for axis in range(total.shape[1]):
                total[node, axis] += vectors[term, corner, axis]


@njit(**KERNEL)
@no_type_check
def add_blocks(stencils, slots, strides, blocks, data):
    """Add every dim x dim block of symmetric blocks to the values of the sparse matrix."""
    corners = stencils.shape[1]
    dim = blocks.shape[1] // corners
    for term in range(stencils.shape[0]):
        for b in range(corners):
            stride = strides[stencils[term, b]]
            for a in range(corners):
                start = slots[term, a, b]
                for j in range(dim):
                    for i in range(dim):
                        data[start + j * stride + i] += blocks[term, b * dim + j, a * dim + i]
