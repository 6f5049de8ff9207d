"""`NeoHookean`: the elastic energy of the body."""

from typing import ClassVar

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Elements, Nodes, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks


class NeoHookean(Energy):
    """Compressible Neo-Hookean solid on linear simplices (R20 to R22, E7 to E9).

    Psi(F) = mu/2 tr(F^T F - I) - mu ln J + lambda/2 (ln J)^2, E = sum of volume x Psi.
    In the plane this is plane strain; the volume is area times thickness.
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
        self.stencils = elements
        self._rest = corners
        self.mu, self.lame = mu, lame
        self.volumes = np.linalg.det(spans) / (2.0 if dim == 2 else 6.0) * thickness
        self.shape_gradients = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
        self._stiffness = mu * np.einsum("e,eci,ebi->ecb", self.volumes, self.shape_gradients, self.shape_gradients)

    def deformation_gradients(self, nodes: Nodes) -> Float[np.ndarray, "elements dim dim"]:
        """F of each element (R21)."""
        return np.swapaxes(nodes[self.stencils], 1, 2) @ self.shape_gradients

    def value(self, nodes: Nodes, controls: Vector) -> float:
        """Computed from the displacement gradient G = F - I, so that little is lost to rounding near rest."""
        G = np.swapaxes(nodes[self.stencils] - self._rest, 1, 2) @ self.shape_gradients
        trace = np.trace(G, axis1=1, axis2=2)
        change = _determinants(np.eye(G.shape[1]) + G) - 1.0 if G.shape[1] == 3 else trace + _determinants(G)
        if not change.min() > -1.0:
            return np.inf
        log_j = np.log1p(change)
        stretch = trace + 0.5 * np.einsum("eij,eij->e", G, G)
        return float(self.volumes @ (self.mu * (stretch - log_j) + 0.5 * self.lame * log_j**2))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        F = self.deformation_gradients(nodes)
        spatial, J = self._spatial_gradients(F)
        pressure = self.volumes * (self.lame * np.log(J) - self.mu)
        corners = nodes[self.stencils]
        return self._stiffness @ corners + pressure[:, None, None] * spatial

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        F = self.deformation_gradients(nodes)
        spatial, J = self._spatial_gradients(F)
        terms, corners, dim = spatial.shape
        flat = spatial.reshape(terms, corners * dim)
        outer = flat[:, :, None] * flat[:, None, :]
        swapped = outer.reshape(terms, corners, dim, corners, dim).swapaxes(2, 4)
        crossed = (self.volumes * (self.mu - self.lame * np.log(J)))[:, None, None, None, None] * swapped
        blocks = (self.lame * self.volumes)[:, None, None] * outer + crossed.reshape(outer.shape)
        view = blocks.reshape(terms, corners, dim, corners, dim)
        for axis in range(dim):
            view[:, :, axis, :, axis] += self._stiffness
        return blocks

    def _spatial_gradients(
        self, F: Float[np.ndarray, "elements dim dim"]
    ) -> tuple[Blocks, Float[np.ndarray, " elements"]]:
        """Gradients of the shape functions in the deformed shape, F^-T grad N, and J."""
        return self.shape_gradients @ np.linalg.inv(F), _determinants(F)


def _determinants(F: Float[np.ndarray, "elements dim dim"]) -> Float[np.ndarray, " elements"]:
    if F.shape[1] == 2:
        return F[:, 0, 0] * F[:, 1, 1] - F[:, 0, 1] * F[:, 1, 0]
    return np.linalg.det(F)
