"""`PatchVolume`: resistance to a change of volume over patches of elements (F-bar), against volumetric locking."""

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import ClassVar, no_type_check

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Elements, Nodes, Vector
from hydrostat.kernel import INNER, KERNEL, njit
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks
from hydrostat.mechanics.neo_hookean import NeoHookean, _displacement_gradient, _spatial_gradients


class PatchVolume(Energy):
    """F-bar patches: sum of V lambda/2 (ln J)^2, with J the deformed volume of the patch over its rest volume V.

    It takes the place of that term in `NeoHookean`, which then has lame = 0. There every linear element would have to
    keep its own volume when lambda is large, which leaves too few ways to move: the body locks. A patch asks for one
    volume of several elements (F-bar on patches, de Souza Neto et al. 2005). The mean is exact for a homogeneous
    deformation. That no single element is inverted is left to the - mu ln J of `NeoHookean`.
    """

    convex: ClassVar[bool] = False

    def __init__(
        self,
        nodes: Nodes,
        elements: Elements,
        patches: Int[np.ndarray, " elements"],
        *,
        lame: float,
        thickness: float = 1.0,
    ) -> None:
        """Patches of elements on the rest shape `nodes`.

        Args:
            nodes: rest positions [m].
            elements: all elements of the body.
            patches: index of the patch of each element, counted from 0 without gaps.
            lame: Lame's first parameter, lambda [Pa].
            thickness: of a flat body [m]; leave it out in space.
        """
        shape = NeoHookean(nodes, elements, mu=0.0, lame=0.0, thickness=thickness)
        order = np.argsort(patches, kind="stable")
        self.lame = lame
        self.volumes = np.bincount(patches, shape.volumes)
        self._starts = np.concatenate([[0], np.cumsum(np.bincount(patches))])
        self.stencils, self._places = _stencils(elements[order], self._starts)
        self._shares = shape.volumes[order] / np.repeat(self.volumes, np.diff(self._starts))
        self._padded = np.zeros((*elements.shape, 3))
        self._padded[:, :, : nodes.shape[1]] = shape.shape_gradients[order]
        self._rest = nodes
        self._axes = tuple(range(nodes.shape[1]))

    def changes(self, nodes: Nodes) -> Float[np.ndarray, " patches"]:
        """J - 1 of each patch, without cancellation."""
        changes = np.empty(len(self.volumes))
        _changes(nodes - self._rest, changes, *self._patch_data)
        return changes

    def value(self, nodes: Nodes, controls: Vector) -> float:
        """Computed from the displacement gradient, so that little is lost to rounding near rest."""
        changes = self.changes(nodes)
        if not (changes > -1.0).all():
            return np.inf
        return 0.5 * self.lame * float(self.volumes @ np.log1p(changes) ** 2)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        blocks = np.zeros((*self.stencils.shape, nodes.shape[1]))
        _gradient(nodes - self._rest, self.lame * self.volumes, blocks, *self._patch_data)
        return blocks

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        size = self.stencils.shape[1] * nodes.shape[1]
        blocks = np.zeros((len(self.stencils), size, size))
        _hessian(nodes - self._rest, self.lame * self.volumes, share, blocks, *self._patch_data)
        return blocks

    def parameter_work(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        blocks = np.zeros((*self.stencils.shape, nodes.shape[1]))
        _gradient(nodes - self._rest, self.volumes, blocks, *self._patch_data)
        work = np.array([float((blocks * field[self.stencils]).sum())])
        return {"lame": work, "thickness": self.lame * work}

    @property
    def _patch_data(self) -> tuple:
        return self.stencils, self._starts, self._places, self._padded, self._shares, self._axes


def _stencils(elements: Elements, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of each patch, the short ones filled up with their first node; and where in them the corners stand."""
    parts = [np.unique(elements[a:b], return_inverse=True) for a, b in pairwise(starts)]
    width = max(len(nodes) for nodes, _ in parts)
    stencils = np.array([np.concatenate([nodes, np.full(width - len(nodes), nodes[0])]) for nodes, _ in parts])
    places = np.concatenate([places.reshape(-1, elements.shape[1]) for _, places in parts])
    return stencils, places


@njit(**KERNEL)
@no_type_check
def _changes(displacements, changes, stencils, starts, places, gradients, shares, axes):
    """J - 1 of each patch: the mean over its elements, by their volumes."""
    G = np.empty((3, 3))
    stencil = np.empty(places.shape[1], dtype=np.int64)
    for patch in range(stencils.shape[0]):
        mean = 0.0
        for member in range(starts[patch], starts[patch + 1]):
            for corner in range(places.shape[1]):
                stencil[corner] = stencils[patch, places[member, corner]]
            mean += shares[member] * _displacement_gradient(displacements, stencil, gradients[member], axes, G)
        changes[patch] = mean


@njit(**INNER)
@no_type_check
def _patch_gradient(displacements, stencil, first, end, places, gradients, shares, axes, G, corners, spatials, slope):
    """J - 1 of a patch; dJ/dx at its nodes, and share x J and F^-T grad N of each of its elements."""
    slope[:] = 0.0
    mean = 0.0
    for member in range(first, end):
        for corner in range(places.shape[1]):
            corners[corner] = stencil[places[member, corner]]
        change = _displacement_gradient(displacements, corners, gradients[member], axes, G)
        _spatial_gradients(G, 1.0 + change, gradients[member], spatials[member - first])
        mean += shares[member] * change
        weight = shares[member] * (1.0 + change)
        for corner in range(places.shape[1]):
            spatials[member - first, corner, 3] = weight
            for i in axes:
                slope[places[member, corner], i] += weight * spatials[member - first, corner, i]
    return mean


@njit(**KERNEL)
@no_type_check
def _gradient(displacements, moduli, blocks, stencils, starts, places, gradients, shares, axes):
    """V lambda ln J / J dJ/dx of each patch."""
    G = np.empty((3, 3))
    corners = np.empty(places.shape[1], dtype=np.int64)
    spatials = np.empty((np.max(starts[1:] - starts[:-1]), 4, 4))
    for patch in range(stencils.shape[0]):
        slope = blocks[patch]
        change = _patch_gradient(
            displacements, stencils[patch], starts[patch], starts[patch + 1],
            places, gradients, shares, axes, G, corners, spatials, slope,
        )  # fmt: skip
        slope *= moduli[patch] * math.log1p(change) / (1.0 + change)


@njit(**KERNEL)
@no_type_check
def _hessian(displacements, moduli, projection, blocks, stencils, starts, places, gradients, shares, axes):
    """V lambda ((1 - ln J) / J^2 dJ dJ^T + ln J / J d2J) of each patch.

    d2J is made element by element: with h = dx/dx, the gradient in the deformed shape, it is (tr h)^2 - tr(h h) = (1 -
    1/dim) (tr h)^2 + |skew h|^2 - |dev sym h|^2 times the element's volume. So what is negative is known.
    """
    G = np.empty((3, 3))
    dim, width = len(axes), stencils.shape[1]
    corners = np.empty(places.shape[1], dtype=np.int64)
    spatials = np.empty((np.max(starts[1:] - starts[:-1]), 4, 4))
    slope = np.empty((width, dim))
    for patch in range(stencils.shape[0]):
        first = starts[patch]
        change = _patch_gradient(
            displacements, stencils[patch], first, starts[patch + 1],
            places, gradients, shares, axes, G, corners, spatials, slope,
        )  # fmt: skip
        log_j, J, block = math.log1p(change), 1.0 + change, blocks[patch]
        straight = moduli[patch] * (1.0 - log_j) / (J * J)
        if straight < 0.0:
            straight -= projection * straight
        for a in range(width):
            for i in axes:
                for b in range(width):
                    for j in axes:
                        block[a * dim + i, b * dim + j] = straight * slope[a, i] * slope[b, j]
        for member in range(first, starts[patch + 1]):
            spatial = spatials[member - first]
            bend = moduli[patch] * log_j / J * spatial[0, 3]
            along = bend - projection * bend * (1.0 / dim if bend > 0.0 else 1.0 - 1.0 / dim)
            crossed = 0.5 * projection * bend - bend
            plain = 0.5 * projection * abs(bend)
            for a in range(places.shape[1]):
                row = places[member, a] * dim
                for b in range(places.shape[1]):
                    column = places[member, b] * dim
                    product = 0.0
                    for i in axes:
                        product += spatial[a, i] * spatial[b, i]
                    for i in axes:
                        for j in axes:
                            entry = along * spatial[a, i] * spatial[b, j] + crossed * spatial[a, j] * spatial[b, i]
                            if i == j:
                                entry += plain * product
                            block[row + i, column + j] += entry
