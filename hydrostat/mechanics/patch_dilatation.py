"""`PatchDilatation`: resistance to a change of volume over patches (mean dilatation), against volumetric locking."""

from collections import defaultdict
from collections.abc import Mapping
from itertools import combinations, pairwise
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Elements, Float, Int, Nodes, Vector
from hydrostat.kernel import native
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks
from hydrostat.mechanics.neo_hookean import NeoHookean


def grow_patches(
    elements: Elements, size: int, materials: Int[np.ndarray, " elements"] | None = None
) -> Int[np.ndarray, " elements"]:
    """Index of the patch of each element; every element is in one patch of about `size` elements of one material.

    A patch grows from an element beside the last patches by the neighbor across a face that has the most nodes in
    common with it, so that it stays compact: in space, a ring of elements about an edge. What is left over between
    full patches, less than half a patch, joins the neighbor with which it has the most nodes in common. The same
    elements in the same order always make the same patches.
    """
    return _Growth(elements, size, materials).run()


class _Growth:
    """Patches while they grow."""

    def __init__(self, elements: Elements, size: int, materials: Int[np.ndarray, " elements"] | None) -> None:
        self.corners = [frozenset(element) for element in elements.tolist()]
        self.size = size
        self.neighbors = _across_faces(elements)
        if materials is not None:
            self.neighbors = [
                [other for other in near if materials[other] == own]
                for own, near in zip(materials, self.neighbors, strict=True)
            ]
        self.patch = [-1] * len(elements)
        self.nodes: list[set[int]] = []
        self.members: list[list[int]] = []

    def run(self) -> Int[np.ndarray, " elements"]:
        front: dict[int, None] = {}
        for first in range(len(self.corners)):
            front[first] = None
            while front:
                seed = next(iter(front))
                if self.patch[seed] < 0:
                    self._grow(seed)
                    for member in self.members[-1]:
                        front.update((other, None) for other in self.neighbors[member] if self.patch[other] < 0)
                del front[seed]
        self._join_small()
        return np.unique(self.patch, return_inverse=True)[1]

    def _grow(self, seed: int) -> None:
        """New patch about a free element."""
        self.nodes.append(set())
        self.members.append([])
        reach = {seed}
        while reach and len(self.members[-1]) < self.size:
            nodes = self.nodes[-1]
            chosen = min(reach, key=lambda element: (len(self.corners[element] - nodes), self._free(element), element))
            self._take(chosen, len(self.members) - 1)
            reach.update(other for other in self.neighbors[chosen])
            reach = {element for element in reach if self.patch[element] < 0}

    def _join_small(self) -> None:
        """Give the elements of patches less than half full to their neighbors."""
        for patch in range(len(self.members)):
            if 2 * len(self.members[patch]) >= self.size:
                continue
            others = {self.patch[other] for member in self.members[patch] for other in self.neighbors[member]} - {patch}
            if others:
                mine = self.nodes[patch]
                host = min(others, key=lambda other: (len(mine - self.nodes[other]), len(self.members[other]), other))
                for member in self.members[patch]:
                    self._take(member, host)
                self.members[patch] = []

    def _take(self, element: int, patch: int) -> None:
        self.patch[element] = patch
        self.members[patch].append(element)
        self.nodes[patch] |= self.corners[element]

    def _free(self, element: int) -> int:
        """Number of neighbors of an element that are in no patch yet: an element with few could be left over."""
        return sum(self.patch[other] < 0 for other in self.neighbors[element])


def _across_faces(elements: Elements) -> list[list[int]]:
    """Elements that share a face with each."""
    faces = defaultdict(list)
    for index, element in enumerate(np.sort(elements, axis=1).tolist()):
        for face in combinations(element, len(element) - 1):
            faces[face].append(index)
    neighbors: list[list[int]] = [[] for _ in elements]
    for sharing in faces.values():
        for element in sharing:
            neighbors[element].extend(other for other in sharing if other != element)
    return neighbors


PATCH_SIZE = {2: 4, 3: 6}
"""Elements in a patch, in the plane and in space: `lab/locking/locking.py` and decision 0012 compare others."""


class PatchDilatation(Energy):
    """Mean dilatation: sum of V lambda/2 (ln J)^2 over patches, J being the deformed over the rest volume V of each.

    It takes the place of that term in `NeoHookean`, which then has lame = 0. There every linear element would have to
    keep its own volume when lambda is large, which leaves too few ways to move: the body locks. A patch asks for one
    volume of several elements (patches as of F-bar, de Souza Neto et al. 2005, but for this term alone). The mean is
    exact for a homogeneous deformation. That no single element is inverted is left to the - mu ln J of `NeoHookean`.
    """

    convex: ClassVar[bool] = False

    def __init__(
        self,
        nodes: Nodes,
        elements: Elements,
        patches: Int[np.ndarray, " elements"],
        *,
        lame: float | Vector,
        thickness: float | Vector = 1.0,
        materials: Int[np.ndarray, " elements"] | None = None,
    ) -> None:
        """Patches of elements on the rest shape `nodes`.

        Args:
            nodes: rest positions [m].
            elements: all elements of the body.
            patches: index of the patch of each element, counted from 0 without gaps.
            lame: Lame's first parameter, lambda [Pa], one number or one for each element; all of a patch are equal.
            thickness: thickness as of `NeoHookean`; a factor of the moduli also weighs the mean of its patch.
            materials: index of the material of each element, counted from 0, for `parameter_derivative`; all of one by
                default.
        """
        shape = NeoHookean(nodes, elements, mu=0.0, lame=0.0, thickness=thickness)
        order = np.argsort(patches, kind="stable")
        self.volumes = np.bincount(patches, shape.volumes)
        self._starts = np.concatenate([[0], np.cumsum(np.bincount(patches))])
        first = order[self._starts[:-1]]  # an element of each patch
        self.lame = np.broadcast_to(lame, len(elements))[first]
        self._materials = np.zeros(len(first), dtype=np.int64) if materials is None else materials[first]
        self.stencils, self._places = _stencils(elements[order], self._starts)
        self._shares = shape.volumes[order] / np.repeat(self.volumes, np.diff(self._starts))
        self._padded = np.zeros((*elements.shape, 3))
        self._padded[:, :, : nodes.shape[1]] = shape.shape_gradients[order]
        self._rest = nodes

    def changes(self, nodes: Nodes) -> Float[np.ndarray, " patches"]:
        """J - 1 of each patch, without cancellation."""
        changes = np.empty(len(self.volumes))
        native.patch_changes(nodes - self._rest, changes, *self._patch_data)
        return changes

    def value(self, nodes: Nodes, controls: Vector) -> float:
        """Computed from the displacement gradient, so that little is lost to rounding near rest."""
        changes = self.changes(nodes)
        if not (changes > -1.0).all():
            return np.inf
        return 0.5 * float((self.lame * self.volumes) @ np.log1p(changes) ** 2)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        blocks = np.zeros((*self.stencils.shape, nodes.shape[1]))
        native.patch_gradient(nodes - self._rest, self.lame * self.volumes, blocks, *self._patch_data)
        return blocks

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        size = self.stencils.shape[1] * nodes.shape[1]
        blocks = np.zeros((len(self.stencils), size, size))
        native.patch_hessian(nodes - self._rest, self.lame * self.volumes, share, blocks, *self._patch_data)
        return blocks

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        blocks = np.zeros((*self.stencils.shape, nodes.shape[1]))
        native.patch_gradient(nodes - self._rest, self.volumes, blocks, *self._patch_data)
        work = (blocks * field[self.stencils]).sum(axis=(1, 2))
        return {"lame": np.bincount(self._materials, work), "thickness": np.array([float(self.lame @ work)])}

    @property
    def _patch_data(self) -> tuple:
        return self.stencils, self._starts, self._places, self._padded, self._shares


def _stencils(elements: Elements, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of each patch, the short ones filled up with their first node; and where in them the corners stand."""
    parts = [np.unique(elements[a:b], return_inverse=True) for a, b in pairwise(starts)]
    width = max(len(nodes) for nodes, _ in parts)
    stencils = np.array([np.concatenate([nodes, np.full(width - len(nodes), nodes[0])]) for nodes, _ in parts])
    places = np.concatenate([places.reshape(-1, elements.shape[1]) for _, places in parts])
    return stencils, places
