"""`grow_patches`: small groups of elements that lie close together, for F-bar patches against volumetric locking."""

from collections import defaultdict
from itertools import combinations

import numpy as np
from jaxtyping import Int

from hydrostat.arrays import Elements


def grow_patches(elements: Elements, size: int) -> Int[np.ndarray, " elements"]:
    """Index of the patch of each element; every element is in one patch of about `size` elements.

    A patch grows from an element beside the last patches by the neighbour across a face that has the most nodes in
    common with it, so that it stays compact: in space, a ring of elements about an edge. What is left over between
    full patches, less than half a patch, joins the neighbour with which it has the most nodes in common. The same
    elements in the same order always make the same patches.
    """
    return _Growth(elements, size).run()


class _Growth:
    """Patches while they grow."""

    def __init__(self, elements: Elements, size: int) -> None:
        self.corners = [frozenset(element) for element in elements.tolist()]
        self.size = size
        self.neighbours = _across_faces(elements)
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
                        front.update((other, None) for other in self.neighbours[member] if self.patch[other] < 0)
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
            reach.update(other for other in self.neighbours[chosen])
            reach = {element for element in reach if self.patch[element] < 0}

    def _join_small(self) -> None:
        """Give the elements of patches less than half full to their neighbours."""
        for patch in range(len(self.members)):
            if 2 * len(self.members[patch]) >= self.size:
                continue
            others = {self.patch[other] for member in self.members[patch] for other in self.neighbours[member]} - {
                patch
            }
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
        return sum(self.patch[other] < 0 for other in self.neighbours[element])


def _across_faces(elements: Elements) -> list[list[int]]:
    """Elements that share a face with each."""
    faces = defaultdict(list)
    for index, element in enumerate(np.sort(elements, axis=1).tolist()):
        for face in combinations(element, len(element) - 1):
            faces[face].append(index)
    neighbours: list[list[int]] = [[] for _ in elements]
    for sharing in faces.values():
        for element in sharing:
            neighbours[element].extend(other for other in sharing if other != element)
    return neighbours


PATCH_SIZE = {2: 4, 3: 6}
"""Elements in a patch, in the plane and in space: `lab/locking/locking.py` and decision 0012 compare others."""
