"""`Mesh`: triangles in the plane or tetrahedra in space."""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Elements, Nodes
from hydrostat.errors import InputError


@dataclass(frozen=True, eq=False)
class Mesh:
    """Linear simplices: triangles (dim 2) or tetrahedra (dim 3), positively oriented.

    Attributes:
        nodes: rest positions [m], (nodes, dim).
        elements: node indices, (elements, dim + 1).

    Raises:
        InputError: indices out of range, or an element of zero or negative volume.
    """

    nodes: Nodes
    elements: Elements

    def __post_init__(self) -> None:
        if self.elements.shape[1] != self.dim + 1:
            raise InputError(f"a mesh of dimension {self.dim} needs {self.dim + 1} nodes an element, not {self.elements.shape[1]}")
        if self.elements.size and (self.elements.min() < 0 or self.elements.max() >= len(self.nodes)):
            raise InputError("the mesh names a node that it does not have")
        bad = np.flatnonzero(~(self.volumes > 0))
        if bad.size:
            raise InputError(f"{bad.size} mesh elements have no positive volume, the first is number {bad[0]}")
        self.nodes.setflags(write=False)
        self.elements.setflags(write=False)

    @property
    def dim(self) -> int:
        """2 for triangles, 3 for tetrahedra."""
        return self.nodes.shape[1]

    @cached_property
    def volumes(self) -> Float[np.ndarray, " elements"]:
        """Area [m^2] of each triangle or volume [m^3] of each tetrahedron, with sign."""
        corners = self.nodes[self.elements]
        factorial = 2.0 if self.dim == 2 else 6.0
        return np.linalg.det(corners[:, 1:] - corners[:, :1]) / factorial

    @cached_property
    def edges(self) -> Int[np.ndarray, "edges 2"]:
        """Every edge once, lower node first, sorted."""
        pairs = np.concatenate([self.elements[:, list(pair)] for pair in combinations(range(self.dim + 1), 2)])
        return np.unique(np.sort(pairs, axis=1), axis=0)

    @cached_property
    def boundary(self) -> Int[np.ndarray, "facets dim"]:
        """Facets that belong to one element only, oriented with the body inside (left in the plane)."""
        facets = np.concatenate([np.delete(self.elements, corner, axis=1) for corner in range(self.dim + 1)])
        signs = np.repeat([(-1) ** corner for corner in range(self.dim + 1)], len(self.elements))
        facets[signs < 0, :2] = facets[signs < 0, 1::-1]
        _, index, count = np.unique(np.sort(facets, axis=1), axis=0, return_index=True, return_counts=True)
        return facets[np.sort(index[count == 1])]

    @cached_property
    def boundary_nodes(self) -> Int[np.ndarray, " nodes"]:
        """Nodes on the boundary, sorted."""
        return np.unique(self.boundary)

    @cached_property
    def size(self) -> float:
        """Longest side of the bounding box [m]."""
        return float(np.ptp(self.nodes, axis=0).max())
