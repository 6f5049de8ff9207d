"""`NeoHookean`: the elastic energy of the body."""

import math
from typing import ClassVar, no_type_check

import numpy as np
from jaxtyping import Float
from numba import njit

from hydrostat.arrays import Elements, Nodes, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks


class NeoHookean(Energy):
    """Compressible Neo-Hookean solid on linear simplices (R20 to R22, E7 to E9).

    Psi(F) = mu/2 tr(F^T F - I) - mu ln J + lambda/2 (ln J)^2, E = sum of volume x Psi.
    In the plane this is plane strain (F is padded by F33 = 1); the volume is area times thickness.
    """

    convex: ClassVar[bool] = False

    def __init__(self, nodes: Nodes, elements: Elements, *, mu: float, lame: float, thickness: float = 1.0) -> None:
        """Material of Lame's parameters `mu` and `lame` [Pa] on the rest shape `nodes`.

        `thickness` [m] is that of a flat body; leave it out in space.
        """
        dim = nodes.shape[1]
        corners = nodes[elements]
        spans = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
        inverse = np.linalg.inv(spans)
        self.stencils = np.ascontiguousarray(elements)
        self.mu, self.lame = mu, lame
        self.volumes = np.linalg.det(spans) / (2.0 if dim == 2 else 6.0) * thickness
        self.shape_gradients = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
        self._rest = nodes
        self._padded = np.zeros((*elements.shape, 3))
        self._padded[:, :, :dim] = self.shape_gradients
        self._axes = tuple(range(dim))

    def deformation_gradients(self, nodes: Nodes) -> Float[np.ndarray, "elements dim dim"]:
        """F of each element (R21)."""
        return np.swapaxes(nodes[self.stencils], 1, 2) @ self.shape_gradients

    def value(self, nodes: Nodes, controls: Vector) -> float:
        """Computed from the displacement gradient G = F - I, so that little is lost to rounding near rest."""
        return _value(nodes - self._rest, *self._element_data, self._axes)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        blocks = np.empty((*self.stencils.shape, nodes.shape[1]))
        _gradient(nodes - self._rest, *self._element_data, self._axes, blocks)
        return blocks

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.lifted_hessian(nodes, controls, 0.0)

    def lifted_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        size = self.stencils.shape[1] * nodes.shape[1]
        blocks = np.empty((len(self.stencils), size, size))
        _hessian(nodes - self._rest, *self._element_data, self._axes, share, blocks)
        return blocks

    @property
    def _element_data(self) -> tuple:
        return self.stencils, self._padded, self.volumes, self.mu, self.lame


@njit(cache=True, error_model="numpy", inline="always")
@no_type_check
def _displacement_gradient(displacements, stencil, gradients, axes, G):
    """G = F - I of one element, padded to 3 x 3; returns J - 1 without cancellation."""
    G[:] = 0.0
    for corner in range(stencil.shape[0]):
        node = stencil[corner]
        for row in axes:
            shift = displacements[node, row]
            for column in axes:
                G[row, column] += shift * gradients[corner, column]
    minors = (
        G[0, 0] * G[1, 1] - G[0, 1] * G[1, 0]
        + G[0, 0] * G[2, 2] - G[0, 2] * G[2, 0]
        + G[1, 1] * G[2, 2] - G[1, 2] * G[2, 1]
    )  # fmt: skip
    determinant = (
        G[0, 0] * (G[1, 1] * G[2, 2] - G[1, 2] * G[2, 1])
        - G[0, 1] * (G[1, 0] * G[2, 2] - G[1, 2] * G[2, 0])
        + G[0, 2] * (G[1, 0] * G[2, 1] - G[1, 1] * G[2, 0])
    )
    return G[0, 0] + G[1, 1] + G[2, 2] + minors + determinant


@njit(cache=True, error_model="numpy")
@no_type_check
def _value(displacements, stencils, gradients, volumes, mu, lame, axes):
    G = np.empty((3, 3))
    total = 0.0
    for element in range(stencils.shape[0]):
        change = _displacement_gradient(displacements, stencils[element], gradients[element], axes, G)
        if not change > -1.0:
            return np.inf
        log_j = math.log1p(change)
        stretch = 0.0
        for i in axes:
            stretch += G[i, i]
            for j in axes:
                stretch += 0.5 * G[i, j] * G[i, j]
        total += volumes[element] * (mu * (stretch - log_j) + 0.5 * lame * log_j * log_j)
    return total


@njit(cache=True, error_model="numpy", inline="always")
@no_type_check
def _spatial_gradients(G, J, gradients, spatial):
    """Gradients of the shape functions in the deformed shape, F^-T grad N, from F = I + G (which this overwrites)."""
    for i in range(3):
        G[i, i] += 1.0
    inverse = 1.0 / J
    c00 = (G[1, 1] * G[2, 2] - G[1, 2] * G[2, 1]) * inverse
    c01 = (G[1, 2] * G[2, 0] - G[1, 0] * G[2, 2]) * inverse
    c02 = (G[1, 0] * G[2, 1] - G[1, 1] * G[2, 0]) * inverse
    c10 = (G[0, 2] * G[2, 1] - G[0, 1] * G[2, 2]) * inverse
    c11 = (G[0, 0] * G[2, 2] - G[0, 2] * G[2, 0]) * inverse
    c12 = (G[0, 1] * G[2, 0] - G[0, 0] * G[2, 1]) * inverse
    c20 = (G[0, 1] * G[1, 2] - G[0, 2] * G[1, 1]) * inverse
    c21 = (G[0, 2] * G[1, 0] - G[0, 0] * G[1, 2]) * inverse
    c22 = (G[0, 0] * G[1, 1] - G[0, 1] * G[1, 0]) * inverse
    for corner in range(gradients.shape[0]):
        x, y, z = gradients[corner, 0], gradients[corner, 1], gradients[corner, 2]
        spatial[corner, 0] = c00 * x + c01 * y + c02 * z
        spatial[corner, 1] = c10 * x + c11 * y + c12 * z
        spatial[corner, 2] = c20 * x + c21 * y + c22 * z


@njit(cache=True, error_model="numpy")
@no_type_check
def _gradient(displacements, stencils, gradients, volumes, mu, lame, axes, blocks):
    """P grad N of each element, with P = mu (F - F^-T) + lambda ln J F^-T = mu (G + (I - F^-T)) + ..."""
    G = np.empty((3, 3))
    spatial = np.empty((4, 3))
    kept = np.empty((3, 3))
    for element in range(stencils.shape[0]):
        rest = gradients[element]
        change = _displacement_gradient(displacements, stencils[element], rest, axes, G)
        kept[:] = G
        _spatial_gradients(G, 1.0 + change, rest, spatial)
        pressure = lame * math.log1p(change)
        for corner in range(stencils.shape[1]):
            for i in axes:
                force = pressure * spatial[corner, i] + mu * (rest[corner, i] - spatial[corner, i])
                for j in axes:
                    force += mu * kept[i, j] * rest[corner, j]
                blocks[element, corner, i] = volumes[element] * force


@njit(cache=True, error_model="numpy")
@no_type_check
def _hessian(displacements, stencils, gradients, volumes, mu, lame, axes, share, blocks):
    G = np.empty((3, 3))
    spatial = np.empty((4, 3))
    dim = len(axes)
    for element in range(stencils.shape[0]):
        rest = gradients[element]
        change = _displacement_gradient(displacements, stencils[element], rest, axes, G)
        _spatial_gradients(G, 1.0 + change, rest, spatial)
        volume = volumes[element]
        straight = volume * lame
        crossed = volume * (mu - lame * math.log1p(change))
        block = blocks[element]
        for a in range(stencils.shape[1]):
            for b in range(a + 1):
                along = 0.0
                for i in axes:
                    along += rest[a, i] * rest[b, i]
                along *= volume * mu
                for i in axes:
                    for j in axes:
                        entry = straight * spatial[a, i] * spatial[b, j] + crossed * spatial[b, i] * spatial[a, j]
                        if i == j:
                            entry += along
                        block[a * dim + i, b * dim + j] = entry
                        block[b * dim + j, a * dim + i] = entry
        if share > 0.0:
            _lift(G, 1.0 + change, rest, share * volume, mu, lame, axes, block)


@njit(cache=True, error_model="numpy")
@no_type_check
def _lift(F, J, gradients, weight, mu, lame, axes, block):
    """Take the negative eigenvalues, times a weight, out of one element's Hessian block.

    The eigenvectors of d2Psi/dF2 are known from the singular value decomposition F = U diag(s) V^T (Smith, de Goes and
    Kim 2019): three that stretch, and for each pair of axes a twist and a flip.
    """
    dim = len(axes)
    squares, V = np.linalg.eigh(F.T @ F)
    s = np.sqrt(np.maximum(squares, 1e-300))
    U = F @ V
    for i in range(3):
        for j in range(3):
            U[i, j] /= s[j]
    first = (lame * math.log(J) - mu) / J
    second = (lame - lame * math.log(J) + mu) / (J * J)
    stretches = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            stretches[i, j] = second * J / s[i] * J / s[j]
            if i == j:
                stretches[i, j] += mu
            else:
                stretches[i, j] += first * s[3 - i - j]
    if dim == 2:
        # The axis out of the plane does not take part: its singular value is 1 and its vector (0, 0, 1).
        for i in range(3):
            if abs(V[2, i]) > 0.5:
                for j in range(3):
                    stretches[i, j] = 0.0
                    stretches[j, i] = 0.0
    values, vectors = np.linalg.eigh(stretches)
    corners = gradients.shape[0]
    mode = np.empty((3, 3))
    column = np.empty(corners * dim)
    for index in range(9):
        mode[:] = 0.0
        if index < 3:
            value = values[index]
            for k in range(3):
                for i in range(3):
                    for j in range(3):
                        mode[i, j] += vectors[k, index] * U[i, k] * V[j, k]
        else:
            k = index % 3
            p, q = (k + 1) % 3, (k + 2) % 3
            sign = 1.0 if index < 6 else -1.0
            if dim == 2 and abs(V[2, k]) < 0.5:
                continue
            value = mu - sign * first * s[k]
            for i in range(3):
                for j in range(3):
                    mode[i, j] = (U[i, p] * V[j, q] + sign * U[i, q] * V[j, p]) * math.sqrt(0.5)
        if value >= 0.0:
            continue
        for a in range(corners):
            for i in axes:
                total = 0.0
                for j in axes:
                    total += mode[i, j] * gradients[a, j]
                column[a * dim + i] = total
        for row in range(corners * dim):
            for other in range(corners * dim):
                block[row, other] -= weight * value * column[row] * column[other]
