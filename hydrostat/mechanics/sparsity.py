"""`SparsityPattern`: which pairs of nodes meet in a Hessian, and where the block of each pair of each term goes."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from hydrostat.arrays import Int, Nodes
from hydrostat.mechanics.energy import Stencils
from hydrostat.mechanics.factorization import FACTORIZATIONS, SymbolicFactorization

AnyStencils = Int[np.ndarray, "_ _"]
"""Stencils of one of several energies, which differ in terms and corners."""


class SparsityPattern:
    """Sparsity of the Hessian of a sum of energies, column by column, with degrees of freedom node by node.

    All that follows from it is made when it is first asked for, once, and never changes: patterns are shared.

    Attributes:
        stencils: stencils of each energy.
        shape: (nodes, dim).
        rest: rest positions of the nodes [m].
    """

    def __init__(self, stencils: Sequence[AnyStencils], rest: Nodes, *, base: "SparsityPattern | None" = None) -> None:
        """Pairs of all stencils of a body whose nodes are at `rest` [m], together with those of `base`.

        `rest` decides the order of elimination alone, and `base` too, where its order serves here as well.
        """
        self.stencils, self.shape = tuple(stencils), rest.shape
        self.rest, self._base = rest, base
        self._passing = False

    def with_added_stencils(self, stencils: Sequence[AnyStencils]) -> "SparsityPattern":
        """Pattern of these stencils behind those of this one."""
        return SparsityPattern([*self.stencils, *stencils], self.rest, base=self)

    def with_replaced_stencils(self, stencils: Sequence[AnyStencils]) -> "SparsityPattern":
        """Pattern of other stencils and all pairs of the last settled one; its analysis too, if no pair comes."""
        base = self._base if self._passing and self._base is not None else self
        other = SparsityPattern(stencils, self.rest, base=base)
        other._passing = True
        return other

    def settle(self) -> None:
        """Prepare the factorization of a pattern whose terms come and go; then it keeps no other pattern."""
        if self._base is not None and self._passing:
            _ = self.analysis, self._places
            self._base = None

    @cached_property
    def entries(self) -> np.ndarray:
        """Pairs of nodes that meet, column x nodes + row, rising; the diagonal is there."""
        if self._base is None:
            keys = np.arange(len(self.rest), dtype=np.int64) * (len(self.rest) + 1)
            return np.unique(np.concatenate([keys, *map(self._keys, self.stencils)]))
        shared = {id(own) for own in self._base.stencils}
        keys = [self._keys(own) for own in self.stencils if id(own) not in shared]
        return _merge_rising(self._base.entries, np.sort(np.concatenate([self._base.entries[:0], *keys])))

    @cached_property
    def analysis(self) -> SymbolicFactorization:
        """Symbolic analysis shared by the factorizations of all matrices of this pattern."""
        like = None if self._base is None else self._base.analysis
        if like is not None and self._base is not None and len(self.entries) == len(self._base.entries):
            return like
        uses = _USES if self._passing else FACTORIZATIONS
        return SymbolicFactorization(
            self.indptr, self.indices, dim=self.shape[1], points=self.rest, like=like, uses=uses
        )

    @cached_property
    def indptr(self) -> np.ndarray:
        """Start of each column, (dofs + 1,), as in `csc_array`."""
        return np.concatenate([[0], np.cumsum(np.repeat(self.strides, self.shape[1]))]).astype(np.int32)

    @cached_property
    def indices(self) -> np.ndarray:
        """Rows of the entries of each column, rising."""
        dim = self.shape[1]
        rows = (self.entries % self.shape[0])[:, None] * dim + np.arange(dim)
        lengths = np.repeat(self.strides, dim)
        shift = np.repeat(self._starts[:-1], dim) * dim - self.indptr[:-1]
        return rows.ravel()[np.arange(self.indptr[-1]) + np.repeat(shift, lengths)].astype(np.int32)

    @cached_property
    def strides(self) -> np.ndarray:
        """Entries of a column of each node."""
        return np.diff(self._starts) * self.shape[1]

    @cached_property
    def slots(self) -> list[np.ndarray]:
        """Place in the values of the first entry of each block, for each energy: (terms, corners, corners)."""
        return [
            self._firsts[places].reshape(*stencils.shape, stencils.shape[1])
            for stencils, places in zip(self.stencils, self._places, strict=True)
        ]

    @cached_property
    def diagonal(self) -> np.ndarray:
        """Places of the diagonal in the values, (dofs,)."""
        count, dim = self.shape
        own = np.searchsorted(self.entries, np.arange(count, dtype=np.int64) * (count + 1))
        return (self._firsts[own][:, None] + np.arange(dim) * (self.strides[:, None] + 1)).ravel()

    @cached_property
    def _starts(self) -> np.ndarray:
        """First entry of each column of nodes, and their number."""
        return np.searchsorted(self.entries, np.arange(self.shape[0] + 1, dtype=np.int64) * self.shape[0])

    @cached_property
    def _firsts(self) -> np.ndarray:
        """Place in the values of the first number of the block of each entry."""
        dim = self.shape[1]
        columns = self.entries // self.shape[0]
        return self._starts[columns] * dim * dim + (np.arange(len(self.entries)) - self._starts[columns]) * dim

    @cached_property
    def _places(self) -> list[np.ndarray]:
        """Place among the entries of each pair, for each energy; those of shared stencils follow from the base."""
        known = {}
        if self._base is not None:
            moved = np.searchsorted(self.entries, self._base.entries)
            pairs = zip(self._base.stencils, self._base._places, strict=True)
            known = {id(stencils): moved[places] for stencils, places in pairs}
        return [
            known[id(own)] if id(own) in known else np.searchsorted(self.entries, self._keys(own))
            for own in self.stencils
        ]

    def _keys(self, stencils: Stencils) -> np.ndarray:
        return (stencils[:, None, :].astype(np.int64) * self.shape[0] + stencils[:, :, None]).ravel()


def _merge_rising(rising: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Numbers that stand in either of two rising lists, once each and rising; the first has no number twice."""
    others = others[np.append(True, others[1:] != others[:-1])[: len(others)]]
    places = np.searchsorted(rising, others)
    new = rising[np.minimum(places, len(rising) - 1)] != others
    return np.insert(rising, places[new], others[new])


_USES = 10
"""So often is a matrix factorized before terms come that it has no place for."""
