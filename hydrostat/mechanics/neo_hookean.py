"""`NeoHookean`: the elastic energy of the body."""

from collections.abc import Mapping
from copy import copy
from functools import cached_property
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Elements, Float, Int, Nodes, Vector
from hydrostat.kernel import native
from hydrostat.mechanics.energy import (
    Blocks,
    ElementGroups,
    Energy,
    HessianBlocks,
    ScatterMap,
    element_groups,
    group_moduli,
)
from hydrostat.mechanics.plane_stress import thickening_works


class NeoHookean(Energy):
    """Compressible Neo-Hookean solid on linear simplices (R20 to R22, E7 to E9).

    Psi(F) = mu/2 tr(F^T F - I) - mu ln J + lambda/2 (ln J)^2, E = sum of volume x Psi.
    In the plane this is plane strain (F is padded by F33 = 1), or plane stress (`as_plane_stress`); the volume is area
    times thickness.
    """

    convex: ClassVar[bool] = False
    thin = False

    def __init__(
        self,
        nodes: Nodes,
        elements: Elements,
        *,
        mu: float | Vector,
        lame: float | Vector | None,
        thickness: float | Vector = 1.0,
        volumes: Float[np.ndarray, " elements"] | None = None,
        materials: Int[np.ndarray, " elements"] | None = None,
    ) -> None:
        """Material of Lame's parameters `mu` and `lame` [Pa] on the rest shape `nodes`.

        Args:
            nodes: rest positions [m].
            elements: corners of each element.
            mu: shear modulus, one number or one for each element.
            lame: Lame's first parameter, likewise; None where another energy resists a change of volume, such as
                `PatchDilatation`.
            thickness: thickness of a flat body [m], leave it out in space; times a factor of the moduli, if there is
                one, of each element.
            volumes: volume of each element [m^3], in place of that of the rest shape.
            materials: index of the material of each element, counted from 0, for `parameter_derivative`; all of one by
                default.
        """
        dim = nodes.shape[1]
        corners = nodes[elements]
        spans = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
        inverse = np.linalg.inv(spans)
        self.stencils = np.ascontiguousarray(elements)
        count = len(elements)
        self.mu, self.lame = np.broadcast_to(mu, count), np.broadcast_to(0.0 if lame is None else lame, count)
        self.volumetric = lame is not None
        self.materials = np.zeros(count, dtype=np.int64) if materials is None else materials
        own = np.linalg.det(spans) / (2.0 if dim == 2 else 6.0) * thickness
        self.volumes = own if volumes is None else volumes
        self.shape_gradients = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
        self._rest = nodes
        self._padded = np.zeros((*elements.shape, 3))
        self._padded[:, :, :dim] = self.shape_gradients
        self._axes = tuple(range(dim))

    def as_plane_stress(self) -> "NeoHookean":
        """The same flat solid, free to become thicker or thinner: see `mechanics/plane_stress.py`."""
        found = copy(self)
        found.thin = True
        return found

    @property
    def point_gradients(self) -> Float[np.ndarray, "elements corners dim"]:
        """Gradients of the shape functions at each point of quadrature [1/m], one in each element."""
        return self.shape_gradients

    def deformation_gradients(self, nodes: Nodes) -> Float[np.ndarray, "elements dim dim"]:
        """F of each element (R21)."""
        return np.swapaxes(nodes[self.stencils], 1, 2) @ self.shape_gradients

    def value(self, nodes: Nodes, controls: Vector) -> float:
        """Computed from the displacement gradient G = F - I, so that little is lost to rounding near rest."""
        return native.value(nodes - self._rest, *self._groups, self._moduli, self.thin)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self._forces(nodes, self._moduli)

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        (terms, corners), dim = self.stencils.shape, nodes.shape[1]
        size, blocks = corners * dim, np.zeros((terms, corners * dim, corners * dim))
        corner = dim * np.arange(corners)
        slots = size**2 * np.arange(terms)[:, None, None] + size * corner + corner[:, None]
        strides = np.full(terms * corners, size)
        apart = self._apart(nodes), *self._groups_apart
        native.hessian(*apart, self._moduli, self.thin, share, slots, strides, blocks.reshape(-1))
        return blocks

    def add_gradient(self, nodes: Nodes, controls: Vector, total: Nodes) -> None:
        native.gradient(nodes - self._rest, *self._groups, self._moduli, self.thin, total)

    def add_hessian(self, nodes: Nodes, controls: Vector, share: float, places: ScatterMap) -> None:
        native.hessian(nodes - self._rest, *self._groups, self._moduli, self.thin, share, *places)

    def min_volume_ratio(self, nodes: Nodes) -> float:
        return native.least_volume(nodes, self.stencils, self._padded, self._axes)

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        """By mu and lame of each material, and by the thickness."""
        one, none = np.ones(len(self.stencils)), np.zeros(len(self.stencils))
        shear = self._work(nodes, field, one, none)
        squeeze = self._work(nodes, field, none, one) if self.volumetric else none
        if self.thin:
            gradients = self.deformation_gradients(nodes), self.deformation_gradients(field)
            thickening, squeeze = thickening_works(self.mu, self.lame, self.volumes, *gradients)
            shear = shear + thickening
        own = self.mu > 0  # other energies stand for elements without moduli
        works = {"mu": np.bincount(self.materials, own * shear)}
        if self.volumetric:
            works["lame"] = np.bincount(self.materials, own * squeeze)
        return {**works, "thickness": np.array([float(self.mu @ shear + self.lame @ squeeze)])}

    def _work(self, nodes: Nodes, field: Nodes, mu: Vector, lame: Vector) -> Vector:
        """Work of the forces of each element along a field, were Lame's parameters these."""
        forces = self._forces(nodes, group_moduli(mu, lame))
        return (forces * field[self.stencils]).sum(axis=(1, 2))

    def _forces(self, nodes: Nodes, moduli: Float[np.ndarray, "2 groups 8"]) -> Blocks:
        """Gradient of each element, were Lame's parameters these."""
        total = np.zeros((self.stencils.size, nodes.shape[1]))
        native.gradient(self._apart(nodes), *self._groups_apart, moduli, self.thin, total)
        return total.reshape(*self.stencils.shape, -1)

    def _apart(self, nodes: Nodes) -> Nodes:
        """Displacements of the corners of each element, as if no two had a node in common."""
        return (nodes - self._rest)[self.stencils].reshape(-1, nodes.shape[1])

    @cached_property
    def _groups_apart(self) -> ElementGroups:
        own = np.arange(self.stencils.size).reshape(self.stencils.shape)
        return element_groups(own, self.shape_gradients, self.volumes)

    @cached_property
    def _groups(self) -> ElementGroups:
        return element_groups(self.stencils, self.shape_gradients, self.volumes)

    @cached_property
    def _moduli(self) -> Float[np.ndarray, "2 groups 8"]:
        return group_moduli(self.mu, self.lame)
