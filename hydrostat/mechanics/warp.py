"""`Warp`: a step that turns material instead of stretching it."""

import math
from collections.abc import Callable
from typing import no_type_check

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Nodes
from hydrostat.kernel import INNER, LONG, native, njit
from hydrostat.mechanics.energy import Stencils, element_groups
from hydrostat.mechanics.factorisation import Analysis

Bend = Callable[[Nodes, Nodes], Nodes]
"""Where unknowns go when they make a step [m]."""


class Warp:
    """Step of Newton that follows arcs (rotation-strain warping).

    A straight step that turns a limb by an angle t lengthens it by 1/cos t, so far from equilibrium Newton on a
    slender body creeps. Here the step's gradient in each element is split into a stretch S and a spin W; the element
    is turned by exp(W) and stretched by I + S, and the nodes that fit these best follow from one scalar Laplacian for
    all axes, whose factors never change (rotation-strain warping, Huang et al. 2011). To first order the step is the
    same.
    """

    def __init__(
        self,
        *,
        stencils: Stencils,
        shape_gradients: Float[np.ndarray, "elements corners dim"],
        volumes: Float[np.ndarray, " elements"],
        rest: Nodes,
        held: Int[np.ndarray, "points corners"],
        holds: Float[np.ndarray, "points corners"],
    ) -> None:
        """Elements of the body; and held points, by stencils and weights, that go where the straight step leads."""
        count = len(rest)
        spread = volumes[:, None, None] * (shape_gradients @ shape_gradients.swapaxes(1, 2))
        grips = float(np.einsum("eaa->", spread)) / count * holds[:, :, None] * holds[:, None, :]
        entries = [_entries(stencils, spread, count), _entries(held, grips, count)]
        keys, places = np.unique(np.concatenate([keys for keys, _ in entries]), return_inverse=True)
        data = np.bincount(places, np.concatenate([values for _, values in entries]))
        columns, rows = np.divmod(keys, count)
        indptr = np.searchsorted(columns, np.arange(count + 1)).astype(np.int32)
        self._factors = Analysis(indptr, rows.astype(np.int32), dim=1, points=rest).factorise(data)
        self._elements = stencils, np.ascontiguousarray(shape_gradients), volumes
        self._groups = element_groups(stencils, shape_gradients, volumes)
        self._axes = tuple(range(rest.shape[1]))

    def __call__(self, nodes: Nodes, step: Nodes) -> Nodes:
        """Where the nodes go if each element follows its own spin and stretch [m]."""
        right = np.zeros_like(nodes)
        if native is None:
            _turn(nodes, step, *self._elements, self._axes, right)
        else:
            native.turn(nodes, step, *self._groups, right)
        return nodes + (step + self._factors.solve(right))


def _entries(stencils: Stencils, blocks: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Keys, column x count + row, and values of the blocks of all stencils."""
    keys = stencils[:, None, :].astype(np.int64) * count + stencils[:, :, None]
    return keys.ravel(), blocks.ravel()


@njit(**LONG)
@no_type_check
def _turn(nodes, step, stencils, gradients, volumes, axes, right):
    """Sum of volume x (exp(W) (I + S) F - F - dF) grad N over the elements, where dF F^-1 = S + W.

    The difference is of second order; it is taken as ((exp W - I - W) + (exp W - I) S) F, so nothing cancels.
    """
    F = np.empty((3, 3))
    A = np.empty((3, 3))
    bent = np.empty((3, 3))
    for element in range(stencils.shape[0]):
        F[:] = 0.0
        A[:] = 0.0
        F[2, 2] = 1.0 if len(axes) == 2 else 0.0
        for corner in range(stencils.shape[1]):
            node = stencils[element, corner]
            for i in axes:
                for j in axes:
                    F[i, j] += nodes[node, i] * gradients[element, corner, j]
                    A[i, j] += step[node, i] * gradients[element, corner, j]
        _divide(A, F)
        x, y, z = 0.5 * (A[2, 1] - A[1, 2]), 0.5 * (A[0, 2] - A[2, 0]), 0.5 * (A[1, 0] - A[0, 1])
        for i in range(3):
            for j in range(i + 1, 3):
                A[i, j] = 0.5 * (A[i, j] + A[j, i])
                A[j, i] = A[i, j]
        _bend(x, y, z, A, bent)
        for corner in range(stencils.shape[1]):
            node = stencils[element, corner]
            p = q = r = 0.0
            for j in axes:
                slope = volumes[element] * gradients[element, corner, j]
                p += F[0, j] * slope
                q += F[1, j] * slope
                r += F[2, j] * slope
            for i in axes:
                right[node, i] += bent[i, 0] * p + bent[i, 1] * q + bent[i, 2] * r


@njit(**INNER)
@no_type_check
def _bend(x, y, z, S, bent):
    """(exp W - I - W) + (exp W - I) S, W the cross product with (x, y, z), by Rodrigues' formula."""
    square = x * x + y * y + z * z
    angle = math.sqrt(square)
    if angle < 1e-3:
        first, second = -square / 6.0, 0.5 - square / 24.0
    else:
        first, second = math.sin(angle) / angle - 1.0, (1.0 - math.cos(angle)) / square
    bent[0, 0], bent[1, 1], bent[2, 2] = -second * (y * y + z * z), -second * (x * x + z * z), -second * (x * x + y * y)
    bent[0, 1], bent[1, 0] = second * x * y - first * z, second * x * y + first * z
    bent[0, 2], bent[2, 0] = second * x * z + first * y, second * x * z - first * y
    bent[1, 2], bent[2, 1] = second * y * z - first * x, second * y * z + first * x
    for i in range(3):
        a, b, c = bent[i, 0], bent[i, 1], bent[i, 2]
        if i == 0:
            b, c = b - z, c + y
        elif i == 1:
            a, c = a + z, c - x
        else:
            a, b = a - y, b + x
        for j in range(3):
            bent[i, j] += a * S[0, j] + b * S[1, j] + c * S[2, j]


@njit(**INNER)
@no_type_check
def _divide(top, F):
    """Top <- top F^-1, of 3 x 3 matrices."""
    c00 = F[1, 1] * F[2, 2] - F[1, 2] * F[2, 1]
    c01 = F[0, 2] * F[2, 1] - F[0, 1] * F[2, 2]
    c02 = F[0, 1] * F[1, 2] - F[0, 2] * F[1, 1]
    c10 = F[1, 2] * F[2, 0] - F[1, 0] * F[2, 2]
    c11 = F[0, 0] * F[2, 2] - F[0, 2] * F[2, 0]
    c12 = F[0, 2] * F[1, 0] - F[0, 0] * F[1, 2]
    c20 = F[1, 0] * F[2, 1] - F[1, 1] * F[2, 0]
    c21 = F[0, 1] * F[2, 0] - F[0, 0] * F[2, 1]
    c22 = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]
    scale = 1.0 / (F[0, 0] * c00 + F[0, 1] * c10 + F[0, 2] * c20)
    for i in range(3):
        p, q, r = top[i, 0] * scale, top[i, 1] * scale, top[i, 2] * scale
        top[i, 0] = p * c00 + q * c10 + r * c20
        top[i, 1] = p * c01 + q * c11 + r * c21
        top[i, 2] = p * c02 + q * c12 + r * c22
