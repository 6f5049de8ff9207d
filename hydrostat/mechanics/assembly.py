"""`Assembly`: the sum of energies as one function of all nodes, with a sparse pattern made once."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.sparse import csc_array

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics.energy import Energy, HessianBlocks


class Assembly:
    """Value, gradient and Hessian of a list of energies, with degrees of freedom node by node."""

    def __init__(self, energies: Sequence[Energy], *, node_count: int, dim: int, control_count: int) -> None:
        """Energies that act on `node_count` nodes and read `control_count` controls."""
        self.energies = tuple(energies)
        self.size = node_count * dim
        self.shape = (node_count, dim)
        self.control_count = control_count
        self._dofs = [
            (energy.stencils[:, :, None] * dim + np.arange(dim)).reshape(len(energy.stencils), -1)
            for energy in self.energies
        ]
        self._indptr, self._indices, self._slots = self._pattern()

    def value(self, nodes: Nodes, controls: Vector) -> float:
        """Total energy [J]; infinite where one of the energies is not defined."""
        total = 0.0
        for energy in self.energies:
            total += energy.value(nodes, controls)
            if not np.isfinite(total):
                return np.inf
        return total

    def gradient(self, nodes: Nodes, controls: Vector) -> Float[np.ndarray, " dofs"]:
        """dE/dx [N], (nodes x dim,)."""
        blocks = [energy.gradient(nodes, controls).ravel() for energy in self.energies]
        return np.bincount(np.concatenate([dofs.ravel() for dofs in self._dofs]), np.concatenate(blocks), self.size)

    def hessian(self, nodes: Nodes, controls: Vector, *, project: bool = False) -> csc_array:
        """d2E/dx2 [N/m], sparse; with `project` every block is made positive semidefinite first (E6)."""
        blocks = []
        for energy in self.energies:
            block = energy.hessian(nodes, controls)
            blocks.append((nearest_semidefinite(block) if project and not energy.convex else block).ravel())
        data = np.bincount(self._slots, np.concatenate(blocks), len(self._indices))
        return csc_array((data, self._indices, self._indptr), shape=(self.size, self.size))

    def control_derivative(self, nodes: Nodes, controls: Vector) -> csc_array:
        """d2E/dx da, sparse, (nodes x dim, controls)."""
        rows, columns, data = [], [], []
        for energy, dofs in zip(self.energies, self._dofs, strict=True):
            if energy.controls is not None:
                rows.append(dofs.ravel())
                columns.append(np.repeat(energy.controls, dofs.shape[1]))
                data.append(energy.control_gradient(nodes, controls).ravel())
        shape = (self.size, self.control_count)
        if not rows:
            return csc_array(shape)
        return csc_array((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=shape)

    def _pattern(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Column pointers and row indices of the Hessian, and the slot of every block entry."""
        keys = np.concatenate([(dofs[:, None, :] * self.size + dofs[:, :, None]).ravel() for dofs in self._dofs])
        entries, slots = np.unique(keys, return_inverse=True)
        columns, rows = np.divmod(entries, self.size)
        indptr = np.searchsorted(columns, np.arange(self.size + 1))
        return indptr.astype(np.int32), rows.astype(np.int32), slots


def nearest_semidefinite(blocks: HessianBlocks) -> HessianBlocks:
    """Each symmetric block with its negative eigenvalues set to zero."""
    values, vectors = np.linalg.eigh(blocks)
    bad = values[:, 0] < 0
    if not bad.any():
        return blocks
    repaired = blocks.copy()
    kept = np.maximum(values[bad], 0.0)
    repaired[bad] = (vectors[bad] * kept[:, None, :]) @ np.swapaxes(vectors[bad], 1, 2)
    return repaired
