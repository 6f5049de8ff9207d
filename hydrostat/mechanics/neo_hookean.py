"""`NeoHookean`: the elastic energy of the body."""

import math
from collections.abc import Mapping
from functools import cached_property, partial
from typing import ClassVar, no_type_check

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Elements, Nodes, Vector
from hydrostat.kernel import INNER, LONG, Kernel, native, njit
from hydrostat.mechanics.energy import Blocks, ElementGroups, Energy, HessianBlocks, Places, element_groups


class NeoHookean(Energy):
    """Compressible Neo-Hookean solid on linear simplices (R20 to R22, E7 to E9).

    Psi(F) = mu/2 tr(F^T F - I) - mu ln J + lambda/2 (ln J)^2, E = sum of volume x Psi.
    In the plane this is plane strain (F is padded by F33 = 1); the volume is area times thickness.
    """

    convex: ClassVar[bool] = False

    def __init__(
        self,
        nodes: Nodes,
        elements: Elements,
        *,
        mu: float,
        lame: float | None,
        thickness: float = 1.0,
        volumes: Float[np.ndarray, " elements"] | None = None,
    ) -> None:
        """Material of Lame's parameters `mu` and `lame` [Pa] on the rest shape `nodes`.

        `lame` is None where another energy resists a change of volume, such as `PatchVolume`. `thickness` [m] is that
        of a flat body; leave it out in space. `volumes` [m^3] stand for those of the rest shape if given.
        """
        dim = nodes.shape[1]
        corners = nodes[elements]
        spans = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
        inverse = np.linalg.inv(spans)
        self.stencils = np.ascontiguousarray(elements)
        self.mu, self.lame, self.volumetric = mu, lame or 0.0, lame is not None
        own = np.linalg.det(spans) / (2.0 if dim == 2 else 6.0) * thickness
        self.volumes = own if volumes is None else volumes
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
        if native is not None:
            return native.value(nodes - self._rest, *self._groups, self.mu, self.lame)
        return _value(nodes - self._rest, *self._element_data)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        blocks = np.empty((*self.stencils.shape, nodes.shape[1]))
        _gradient(blocks, nodes - self._rest, *self._element_data)
        return blocks

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        size = self.stencils.shape[1] * nodes.shape[1]
        blocks = np.empty((len(self.stencils), size, size))
        _hessian(blocks, share, nodes - self._rest, *self._element_data)
        return blocks

    def add_gradient(self, nodes: Nodes, controls: Vector, total: Nodes) -> None:
        if native is None:
            super().add_gradient(nodes, controls, total)
        else:
            native.gradient(nodes - self._rest, *self._groups, self.mu, self.lame, total)

    def add_hessian(self, nodes: Nodes, controls: Vector, share: float, places: Places) -> None:
        if native is None:
            super().add_hessian(nodes, controls, share, places)
        else:
            native.hessian(nodes - self._rest, *self._groups, self.mu, self.lame, share, *places)

    def least_volume(self, nodes: Nodes) -> float:
        return _least_volume(nodes, self.stencils, self._padded, self._axes)

    def parameter_work(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        works = {"mu": self._work(nodes, field, 1.0, 0.0)}
        if self.volumetric:
            works["lame"] = self._work(nodes, field, 0.0, 1.0)
        whole = self.mu * works["mu"] + self.lame * works.get("lame", 0.0)
        return {**works, "thickness": whole}

    def _work(self, nodes: Nodes, field: Nodes, mu: float, lame: float) -> Vector:
        """Work of the forces along a field, were Lame's parameters these."""
        blocks = np.empty((*self.stencils.shape, nodes.shape[1]))
        _gradient(blocks, nodes - self._rest, self.stencils, self._padded, self.volumes, mu, lame, self._axes)
        return np.array([float((blocks * field[self.stencils]).sum())])

    @cached_property
    def _groups(self) -> ElementGroups:
        return element_groups(self.stencils, self.shape_gradients, self.volumes)

    @property
    def _element_data(self) -> tuple:
        return self.stencils, self._padded, self.volumes, self.mu, self.lame, self._axes


@njit(inline="always", **INNER)
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


@njit(**LONG)
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


@partial(Kernel, options=LONG)
@no_type_check
def _least_volume(nodes, stencils, gradients, axes):
    """J of the element that is squeezed most, by the spans of its corners; 1 if none is."""
    least = 1.0
    for element in range(stencils.shape[0]):
        corners, rest = stencils[element], gradients[element]
        o, p, q = corners[0], corners[1], corners[2]
        ax, ay, bx, by = (
            nodes[p, 0] - nodes[o, 0],
            nodes[p, 1] - nodes[o, 1],
            nodes[q, 0] - nodes[o, 0],
            nodes[q, 1] - nodes[o, 1],
        )
        if len(axes) == 2:
            scale = rest[1, 0] * rest[2, 1] - rest[1, 1] * rest[2, 0]
            least = min(least, (ax * by - ay * bx) * scale)
            continue
        r = corners[3]
        az, bz = nodes[p, 2] - nodes[o, 2], nodes[q, 2] - nodes[o, 2]
        cx, cy, cz = nodes[r, 0] - nodes[o, 0], nodes[r, 1] - nodes[o, 1], nodes[r, 2] - nodes[o, 2]
        scale = (
            rest[1, 0] * (rest[2, 1] * rest[3, 2] - rest[2, 2] * rest[3, 1])
            - rest[1, 1] * (rest[2, 0] * rest[3, 2] - rest[2, 2] * rest[3, 0])
            + rest[1, 2] * (rest[2, 0] * rest[3, 1] - rest[2, 1] * rest[3, 0])
        )
        least = min(least, (ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)) * scale)
    return least


@njit(inline="always", **INNER)
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


@njit(**LONG)
@no_type_check
def _gradient(blocks, displacements, stencils, gradients, volumes, mu, lame, axes):
    """P grad N of each element, with P = mu (F - F^-T) + lambda ln J F^-T = mu (G + (I - F^-T)) + ..."""
    G = np.empty((3, 3))
    spatial = np.empty((4, 3))
    kept = np.empty((3, 3))
    for element in range(stencils.shape[0]):
        rest = gradients[element]
        change = _displacement_gradient(displacements, stencils[element], rest, axes, G)
        for i in range(3):
            for j in range(3):
                kept[i, j] = G[i, j]
        _spatial_gradients(G, 1.0 + change, rest, spatial)
        pressure = lame * math.log1p(change)
        for corner in range(stencils.shape[1]):
            for i in axes:
                force = pressure * spatial[corner, i] + mu * (rest[corner, i] - spatial[corner, i])
                for j in axes:
                    force += mu * kept[i, j] * rest[corner, j]
                blocks[element, corner, i] = volumes[element] * force


@njit(**LONG)
@no_type_check
def _hessian(blocks, share, displacements, stencils, gradients, volumes, mu, lame, axes):
    G, V, stretches, vectors = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    spatial, local = np.empty((4, 3)), np.empty((4, 3))
    dim = len(axes)
    column = np.empty(stencils.shape[1] * dim)
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
            _project(G, 1.0 + change, rest, share * volume, mu, lame, axes, block, V, stretches, vectors, local, column)


@njit(**INNER)
@no_type_check
def _project(F, J, gradients, weight, mu, lame, axes, block, V, stretches, vectors, local, column):
    """Take the negative eigenvalues, times a weight, out of one element's Hessian block.

    The eigenvectors of d2Psi/dF2 are known from the singular value decomposition F = U diag(s) V^T (Smith, de Goes and
    Kim 2019): three that stretch, and for each pair of axes a twist and a flip. The last five arguments are room to
    work in.
    """
    dim, corners = len(axes), gradients.shape[0]
    for i in range(3):
        for j in range(3):
            stretches[i, j] = F[0, i] * F[0, j] + F[1, i] * F[1, j] + F[2, i] * F[2, j]
    _eigen(stretches, V)
    s0 = math.sqrt(max(stretches[0, 0], 1e-300))
    s1 = math.sqrt(max(stretches[1, 1], 1e-300))
    s2 = math.sqrt(max(stretches[2, 2], 1e-300))
    s = (s0, s1, s2)
    out = -1
    if dim == 2:  # the axis out of the plane does not take part
        for k in range(3):
            if abs(V[2, k]) > 0.5:
                out = k
    log_j = math.log(J)
    first = (lame * log_j - mu) / J
    second = lame - lame * log_j + mu
    for i in range(3):
        for j in range(3):
            stretches[i, j] = mu + second / (s[i] * s[i]) if i == j else second / (s[i] * s[j]) + first * s[3 - i - j]
    if out >= 0:
        for j in range(3):
            stretches[out, j] = 0.0
            stretches[j, out] = 0.0
    # local[a, k] = V_k . grad N_a, and U_k = F V_k / s_k in the place of V from here on
    for a in range(corners):
        for k in range(3):
            local[a, k] = gradients[a, 0] * V[0, k] + gradients[a, 1] * V[1, k] + gradients[a, 2] * V[2, k]
    for k in range(3):
        x, y, z = V[0, k], V[1, k], V[2, k]
        for i in range(3):
            V[i, k] = (F[i, 0] * x + F[i, 1] * y + F[i, 2] * z) / s[k]
    for k in range(3):
        if out >= 0 and k != out:
            continue
        p, q = (k + 1) % 3, (k + 2) % 3
        for sign in (1.0, -1.0):
            value = mu - sign * first * s[k]
            if value >= 0.0:
                continue
            for a in range(corners):
                for i in axes:
                    column[a * dim + i] = V[i, p] * local[a, q] + sign * V[i, q] * local[a, p]
            _add_square(block, -0.5 * weight * value, column)
    if _positive(stretches, out):
        return
    _eigen(stretches, vectors)
    for k in range(3):
        value = stretches[k, k]
        if value >= 0.0:
            continue
        for a in range(corners):
            for i in axes:
                column[a * dim + i] = (
                    vectors[0, k] * V[i, 0] * local[a, 0]
                    + vectors[1, k] * V[i, 1] * local[a, 1]
                    + vectors[2, k] * V[i, 2] * local[a, 2]
                )
        _add_square(block, -weight * value, column)


@njit(inline="always", **INNER)
@no_type_check
def _positive(A, out):
    """Whether a symmetric 3 x 3 matrix, less its axis `out`, is positive definite, by its leading minors."""
    if out >= 0:
        p, q = (out + 1) % 3, (out + 2) % 3
        return A[p, p] > 0.0 and A[p, p] * A[q, q] > A[p, q] * A[p, q]
    minor = A[0, 0] * A[1, 1] - A[0, 1] * A[0, 1]
    whole = (
        A[2, 2] * minor - A[0, 0] * A[1, 2] * A[1, 2] - A[1, 1] * A[0, 2] * A[0, 2] + 2.0 * A[0, 1] * A[0, 2] * A[1, 2]
    )
    return A[0, 0] > 0.0 and minor > 0.0 and whole > 0.0


@njit(**INNER)
@no_type_check
def _add_square(block, scale, column):
    """Block += scale column column^T."""
    for row in range(column.shape[0]):
        factor = scale * column[row]
        for other in range(column.shape[0]):
            block[row, other] += factor * column[other]


@njit(**INNER)
@no_type_check
def _eigen(A, V):
    """Make a symmetric 3 x 3 matrix diagonal by Jacobi's rotations; the columns of V are its eigenvectors."""
    for i in range(3):
        for j in range(3):
            V[i, j] = 1.0 if i == j else 0.0
    size = abs(A[0, 0]) + abs(A[1, 1]) + abs(A[2, 2])
    for _ in range(12):
        if abs(A[0, 1]) + abs(A[0, 2]) + abs(A[1, 2]) <= 1e-15 * size:
            return
        for p in range(2):
            for q in range(p + 1, 3):
                if A[p, q] == 0.0:
                    continue
                tilt = 0.5 * (A[q, q] - A[p, p]) / A[p, q]
                t = 1.0 / (abs(tilt) + math.sqrt(tilt * tilt + 1.0))
                if tilt < 0.0:
                    t = -t
                c = 1.0 / math.sqrt(t * t + 1.0)
                sine = t * c
                r = 3 - p - q
                turn = t * A[p, q]
                A[p, p] -= turn
                A[q, q] += turn
                A[p, q] = 0.0
                A[q, p] = 0.0
                x, y = A[r, p], A[r, q]
                A[r, p] = c * x - sine * y
                A[r, q] = sine * x + c * y
                A[p, r] = A[r, p]
                A[q, r] = A[r, q]
                for i in range(3):
                    x, y = V[i, p], V[i, q]
                    V[i, p] = c * x - sine * y
                    V[i, q] = sine * x + c * y
