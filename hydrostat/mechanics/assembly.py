"""`Assembly`: the sum of energies as one function of all nodes, with a sparse pattern made once."""

from collections.abc import Sequence
from copy import copy
from typing import no_type_check

import numpy as np
from jaxtyping import Float
from numba import njit
from scipy.sparse import csc_array

from hydrostat.arrays import Nodes, Vector
from hydrostat.kernel import KERNEL
from hydrostat.mechanics.energy import Energy
from hydrostat.mechanics.factorisation import Analysis
from hydrostat.mechanics.stiffness import Stiffness


class Assembly:
    """Value, gradient and Hessian of a list of energies, with degrees of freedom node by node."""

    def __init__(self, energies: Sequence[Energy], *, rest: Nodes, control_count: int) -> None:
        """Energies of a body whose nodes are at `rest` [m] before it deforms; they read `control_count` controls.

        Only the order of elimination depends on `rest`.
        """
        self.energies = tuple(energies)
        self.shape = rest.shape
        self.size = rest.size
        self.control_count = control_count
        self._dofs = [
            (stencils[:, :, None] * rest.shape[1] + np.arange(rest.shape[1])).reshape(
                len(stencils), stencils.shape[1] * rest.shape[1]
            )
            for stencils in (energy.stencils for energy in self.energies)
        ]
        self._rest = rest
        self._pattern()
        self._quadratic = self._sum_of_quadratic()
        self._analysis = Analysis(self._indptr, self._indices, dim=rest.shape[1], points=rest)

    def with_energies(self, energies: Sequence[Energy]) -> "Assembly":
        """The same with other energies on the same stencils, such as those of the next time step; costs nothing."""
        if [energy.stencils.shape for energy in energies] != [energy.stencils.shape for energy in self.energies]:
            raise ValueError("the energies must have the stencils of those they replace")
        other = copy(self)
        other.energies = tuple(energies)
        pairs = zip(self.energies, other.energies, strict=True)
        if any(old is not new and (old.quadratic or new.quadratic) for old, new in pairs):
            other._quadratic = other._sum_of_quadratic()
        return other

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
        total = np.zeros(self.shape)
        for energy in self.energies:
            _add_vectors(energy.stencils, energy.gradient(nodes, controls), total)
        return total.ravel()

    def hessian(self, nodes: Nodes, controls: Vector, *, lift: float = 0.0) -> csc_array:
        """d2E/dx2 [N/m], sparse, less its part of low rank.

        `lift` is the share, 0 to 1, of what is negative in the blocks that is taken out (E6).
        """
        data = self._hessian_values(nodes, controls, lift)
        return csc_array((data, self._indices, self._indptr), shape=(self.size, self.size))

    def _hessian_values(self, nodes: Nodes, controls: Vector, lift: float) -> Vector:
        data = self._quadratic.copy()
        for energy, slots in zip(self.energies, self._slots, strict=True):
            if energy.quadratic:
                continue
            if lift and not energy.convex:
                blocks = energy.lifted_hessian(nodes, controls, lift)
            else:
                blocks = energy.hessian(nodes, controls)
            _add_blocks(energy.stencils, slots, self._strides, blocks, data)
        return data

    def _sum_of_quadratic(self) -> Vector:
        """Values of the Hessian of the energies in which it is constant."""
        data = np.zeros(len(self._indices))
        rest, idle = np.zeros(self.shape), np.zeros(self.control_count)
        for energy, slots in zip(self.energies, self._slots, strict=True):
            if energy.quadratic:
                _add_blocks(energy.stencils, slots, self._strides, energy.hessian(rest, idle), data)
        return data

    def low_rank(
        self, nodes: Nodes, controls: Vector
    ) -> tuple[Float[np.ndarray, "dofs rank"], Float[np.ndarray, "rank rank"]]:
        """G and D of the part G D G^T of d2E/dx2 that `hessian` leaves out."""
        parts = [part for energy in self.energies if (part := energy.low_rank(nodes, controls)) is not None]
        if not parts:
            return np.zeros((self.size, 0)), np.zeros((0, 0))
        if len(parts) == 1:
            return parts[0]
        ranks = np.cumsum([0, *(len(weights) for _, weights in parts)])
        joint = np.zeros((ranks[-1], ranks[-1]))
        for start, end, (_, weights) in zip(ranks, ranks[1:], parts, strict=False):
            joint[start:end, start:end] = weights
        return np.concatenate([columns for columns, _ in parts], axis=1), joint

    def stiffness(self, nodes: Nodes, controls: Vector, *, lift: float = 0.0, shift: float = 0.0) -> Stiffness:
        """The whole of d2E/dx2, ready to be solved with.

        `lift` is as in `hessian`; `shift`, a share of the largest diagonal entry, is added to the diagonal.
        """
        values = self._hessian_values(nodes, controls, lift)
        if shift:
            values[self._diagonal] += shift * values[self._diagonal].max()
        return Stiffness(self._analysis.factorise(values), *self.low_rank(nodes, controls))

    def hessian_product(
        self, nodes: Nodes, controls: Vector, columns: Float[np.ndarray, "dofs columns"]
    ) -> Float[np.ndarray, "dofs columns"]:
        """d2E/dx2 times some columns."""
        vectors, weights = self.low_rank(nodes, controls)
        return self.hessian(nodes, controls) @ columns + vectors @ (weights @ (vectors.T @ columns))

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

    def _pattern(self) -> None:
        """Columns and rows of the Hessian, and where each dim x dim block of each term goes."""
        count, dim = self.shape
        keys = [
            (energy.stencils[:, None, :].astype(np.int64) * count + energy.stencils[:, :, None]).ravel()
            for energy in self.energies
        ]
        diagonal = np.arange(count, dtype=np.int64) * (count + 1)
        entries, places = np.unique(np.concatenate([*keys, diagonal]), return_inverse=True)
        columns, rows = np.divmod(entries, count)
        starts = np.searchsorted(columns, np.arange(count + 1))
        heights = np.diff(starts)
        self._strides = heights * dim
        below = (rows[:, None] * dim + np.arange(dim)).astype(np.int32)
        self._indices = np.concatenate(
            [np.tile(below[starts[node] : starts[node + 1]].ravel(), dim) for node in range(count)]
        )
        self._indptr = np.concatenate([[0], np.cumsum(np.repeat(self._strides, dim))]).astype(np.int32)
        own = np.repeat(np.arange(self.size), np.diff(self._indptr))
        self._diagonal = np.flatnonzero(self._indices == own)
        first = starts[columns] * dim * dim + (np.arange(len(entries)) - starts[columns]) * dim
        slots = np.split(first[places], np.cumsum([len(key) for key in keys]))
        self._slots = [
            slot.reshape(*energy.stencils.shape, energy.stencils.shape[1])
            for slot, energy in zip(slots, self.energies, strict=False)
        ]


@njit(**KERNEL)
@no_type_check
def _add_vectors(stencils, vectors, total):
    """Add the vector of every corner of every term to its node."""
    for term in range(stencils.shape[0]):
        for corner in range(stencils.shape[1]):
            node = stencils[term, corner]
            for axis in range(total.shape[1]):
                total[node, axis] += vectors[term, corner, axis]


@njit(**KERNEL)
@no_type_check
def _add_blocks(stencils, slots, strides, blocks, data):
    """Add every dim x dim block of symmetric blocks to the values of the sparse matrix."""
    corners = stencils.shape[1]
    dim = blocks.shape[1] // corners
    for term in range(stencils.shape[0]):
        for b in range(corners):
            stride = strides[stencils[term, b]]
            for a in range(corners):
                start = slots[term, a, b]
                for j in range(dim):
                    for i in range(dim):
                        data[start + j * stride + i] += blocks[term, b * dim + j, a * dim + i]
