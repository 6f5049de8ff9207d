"""`PrandtlEnergy`: rate-free hysteresis of a material by Prandtl elements (Prandtl 1928, Iwan 1966)."""

from collections.abc import Mapping
from copy import copy
from typing import ClassVar, NamedTuple

import numpy as np

from hydrostat.arrays import Float, Nodes, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, Stencils

Tensors = Float[np.ndarray, "points dim dim"]


class PrandtlEnergy(Energy):
    """Springs in series with sliders, parallel to the elastic material at each point of quadrature.

    With Green's strain E and the slip P the spring has the stress k (E - P), of norm at most k y: beyond, P follows. In
    one increment from P both together have the potential k h(|E - P|), h(r) = r^2 / 2 up to y, then y r - y^2 / 2: what
    the spring stores and the slider dissipates, k y |dP| >= 0. Nothing of it changes when the body turns. Along one
    axis the stress is that of Prandtl's element, and several energies are Iwan's.

    Attributes:
        slip: strain P of the slider at each point, its history.
    """

    convex: ClassVar[bool] = False
    has_history = True
    follows_tangent: ClassVar[bool] = True

    def __init__(
        self,
        nodes: Nodes,
        stencils: Stencils,
        *,
        gradients: Float[np.ndarray, "terms points corners dim"],
        volumes: Float[np.ndarray, "terms points"],
        young: float,
        strain: float,
    ) -> None:
        """Elements on the rest shape `nodes`, which have not yet slipped.

        Args:
            nodes: rest positions [m].
            stencils: nodes of each element.
            gradients: gradients of its shape functions at each point of quadrature [1/m].
            volumes: volume that each point stands for [m^3].
            young: Young's modulus k of the springs, of Poisson's ratio 0 [Pa].
            strain: strain y at which the sliders slip.
        """
        self.stencils = np.ascontiguousarray(stencils)
        self.young, self.strain = young, strain
        self._rest, self._points = nodes, gradients.shape[1]
        self._gradients = gradients.reshape(-1, *gradients.shape[2:])
        self._weights = young * volumes.ravel()
        dim = nodes.shape[1]
        self.slip: Tensors = np.zeros((len(self._weights), dim, dim))

    def value(self, nodes: Nodes, controls: Vector) -> float:
        lengths = self._state(nodes).lengths
        slips = lengths > self.strain
        return float(self._weights @ np.where(slips, self.strain * (lengths - 0.5 * self.strain), 0.5 * lengths**2))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        state = self._state(nodes)
        stress = (self._weights * state.secants)[:, None, None] * state.spans
        forces = self._gradients @ np.swapaxes(state.deformation @ stress, 1, 2)
        return self._sum_points(forces)

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        """Sliders at their limit go on slipping."""
        state, shapes = self._state(nodes), self._gradients
        (corners, dim), secants = shapes.shape[1:], self._weights * state.secants
        deformation = state.deformation
        stress = shapes @ (secants[:, None, None] * state.spans) @ np.swapaxes(shapes, 1, 2)
        inner = 0.5 * secants[:, None, None] * (shapes @ np.swapaxes(shapes, 1, 2))
        blocks = np.einsum("pab,ij->paibj", stress, np.eye(dim))
        blocks += np.einsum("pab,pij->paibj", inner, deformation @ np.swapaxes(deformation, 1, 2))
        turned = shapes @ np.swapaxes(deformation, 1, 2)  # B_a . F_i
        blocks += np.einsum("p,pbi,paj->paibj", 0.5 * secants, turned, turned)
        hair = 1e-9  # Nearer to its limit than this share a slider slips
        slips = state.lengths >= (1 - hair) * self.strain
        rates = np.where(slips, secants / np.where(slips, state.lengths, 1.0) ** 2, 0.0)
        ways = shapes @ np.swapaxes(deformation @ state.spans, 1, 2)
        blocks -= np.einsum("p,pai,pbj->paibj", rates, ways, ways)
        size = corners * dim
        return blocks.reshape(-1, self._points, size, size).sum(axis=1)

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        """By the thickness."""
        return {"thickness": np.array([float((self.gradient(nodes, np.zeros(0)) * field[self.stencils]).sum())])}

    @property
    def history(self) -> Vector:
        """Slip of each point."""
        return self.slip.ravel()

    def with_history(self, history: Vector, nodes: Nodes, controls: Vector) -> "PrandtlEnergy":
        other = copy(self)
        other.slip = history.reshape(self.slip.shape)
        return other

    def with_advanced_history(self, nodes: Nodes, controls: Vector) -> "PrandtlEnergy":
        """Return the energy whose sliders have followed to `nodes`."""
        state = self._state(nodes)
        slip = self.slip + (1 - state.secants)[:, None, None] * state.spans
        return self.with_history(slip.ravel(), nodes, controls)

    def _state(self, nodes: Nodes) -> "_SliderState":
        """Strain of the springs if no slider moved; from the displacements, so that little is lost to rounding."""
        moved = (nodes - self._rest)[self.stencils]
        moved = np.repeat(moved - moved[:, :1], self._points, axis=0)
        turned = np.swapaxes(moved, 1, 2) @ self._gradients
        spans = 0.5 * (turned + np.swapaxes(turned, 1, 2) + np.swapaxes(turned, 1, 2) @ turned) - self.slip
        lengths = np.sqrt((spans**2).sum(axis=(1, 2)))
        secants = self.strain / np.maximum(lengths, self.strain)
        return _SliderState(np.eye(nodes.shape[1]) + turned, spans, lengths, secants)

    def _sum_points(self, forces: np.ndarray) -> Blocks:
        return forces.reshape(len(self.stencils), self._points, *forces.shape[1:]).sum(axis=1)


class _SliderState(NamedTuple):
    """F, the strain of the springs E - P, its norm, and the share of it that they keep, at each point."""

    deformation: Tensors
    spans: Tensors
    lengths: Vector
    secants: Vector
