"""`Assembly`: the sum of energies as one function of all nodes, with a sparse pattern made once."""

from collections.abc import Sequence
from functools import cached_property
from itertools import zip_longest
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from hydrostat.arrays import Float, Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.mechanics.energy import Energy, Gaps, LowRankStiffness, ScatterMap
from hydrostat.mechanics.factorized_hessian import FactorizedHessian
from hydrostat.mechanics.sparsity import SparsityPattern

if TYPE_CHECKING:
    from scipy.sparse import csc_array


class Assembly:
    """Value, gradient and Hessian of a list of energies, with degrees of freedom node by node.

    Attributes:
        energies: terms of the sum.
        pattern: sparsity of the Hessian.
        control_count: number of controls that the energies read.
        token: identity of the Hessian, under which its factors are kept; shared with the assembly that this one was
            made from.
    """

    def __init__(
        self, energies: Sequence[Energy], *, rest: Nodes, control_count: int, pattern: SparsityPattern | None = None
    ) -> None:
        """Sum of energies of a body whose nodes are at `rest` [m] before it deforms.

        Args:
            energies: terms of the sum; they read `control_count` controls.
            rest: decides the order of elimination alone.
            control_count: number of controls.
            pattern: sparsity pattern of the stencils of these energies, if available.
        """
        self.energies, self.control_count = tuple(energies), control_count
        self.pattern = pattern or SparsityPattern([energy.stencils for energy in energies], rest)
        self.shape, self.size = rest.shape, rest.size
        self.token = object()

    def with_added_energies(self, energies: Sequence[Energy], *, control_count: int) -> "Assembly":
        """Return the sum with more energies; it reuses the sparsity pattern of this one."""
        for energy in energies:
            if not (isinstance(energy, Energy) and hasattr(energy, "stencils")):
                raise InputError(f"{energy!r:.60} is no Energy with stencils; see hydrostat.mechanics.Energy")
            if energy.stencils.size and not 0 <= energy.stencils.min() <= energy.stencils.max() < self.shape[0]:
                raise InputError(f"stencils of {type(energy).__name__} must be nodes from 0 to {self.shape[0] - 1}")
        pattern = self.pattern.with_added_stencils([energy.stencils for energy in energies])
        return Assembly(
            [*self.energies, *energies], rest=self.pattern.rest, control_count=control_count, pattern=pattern
        )

    def with_energies(self, energies: Sequence[Energy]) -> "Assembly":
        """Sum of other energies on the same stencils, such as those of the next time step; costs next to nothing."""
        if [energy.stencils.shape for energy in energies] != [energy.stencils.shape for energy in self.energies]:
            raise ValueError("the energies must have the stencils of those they replace")
        other = self._like(energies, self.pattern)
        pairs = zip(self.energies, energies, strict=True)
        if not any(old is not new and (old.has_constant_hessian or new.has_constant_hessian) for old, new in pairs):
            other.__dict__.update({name: value for name, value in self.__dict__.items() if name == "_quadratic"})
        return other

    def with_active_terms(self, nodes: Nodes) -> "Assembly":
        """Sum with the terms that count near `nodes`; itself where none come and go.

        The pattern is analyzed again only when a pair of nodes meets that never met before.
        """
        return self.with_terms([energy.with_active_terms(nodes) for energy in self.energies])

    def continuing(self, other: object) -> "Assembly":
        """This sum with the terms that come and go of another one made from it, and its pattern; itself where none do.

        So a solve that begins where one ended analyses no pattern. One that has grown by much on its way is left alone.
        """
        if not isinstance(other, Assembly) or other.token is not self.token:
            return self
        if len(other.pattern.entries) > _GROWN * len(self.pattern.entries):
            return self
        pairs = list(zip(self.energies, other.energies, strict=True))
        energies = [old if new.continues(old) else new for new, old in pairs]
        if any(new.stencils is not old.stencils for new, old in zip(energies, other.energies, strict=True)):
            return self
        return other.with_energies(energies)

    def with_terms(self, energies: Sequence[Energy]) -> "Assembly":
        """Sum of other energies, some with other stencils, as those of contact have; itself if all are the same."""
        if all(new is old for new, old in zip(energies, self.energies, strict=True)):
            return self
        stencils = [energy.stencils for energy in energies]
        same = all(new is old for new, old in zip(stencils, self.pattern.stencils, strict=True))
        return (
            self.with_energies(energies)
            if same
            else self._like(energies, self.pattern.with_replaced_stencils(stencils))
        )

    def with_load(self, share: float) -> "Assembly":
        """Sum with this share of all dead loads."""
        return self.with_energies([energy.with_load(share) for energy in self.energies])

    @property
    def has_history(self) -> bool:
        """True if any energy depends on the loading path."""
        return any(energy.has_history for energy in self.energies)

    @property
    def follows_tangent(self) -> bool:
        """True if the Hessian at a pose is that of going on: nothing with a history but sliders of materials."""
        return all(energy.follows_tangent for energy in self.energies if energy.has_history)

    @property
    def max_stalled_corrections(self) -> int:
        """Largest `max_stalled_corrections` of the energies with a history; 0 without one."""
        return max((energy.max_stalled_corrections for energy in self.energies if energy.has_history), default=0)

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        """Largest force that is applied to the body [N]."""
        return max((energy.largest_force(nodes, controls) for energy in self.energies), default=0.0)

    def largest_step(self, nodes: Nodes, move: Nodes) -> float:
        """Largest share of a straight move [m] that all energies admit, above 0, at most 1."""
        return min((energy.largest_step(nodes, move) for energy in self.energies), default=1.0)

    def gaps(self, nodes: Nodes) -> list[Gaps]:
        """Gaps between parts near one another, of each energy of contact."""
        return [found for energy in self.energies if (found := energy.gaps(nodes)) is not None]

    def min_volume_ratio(self, nodes: Nodes) -> float:
        """J of the element that is squeezed most, at most 1."""
        return min((energy.min_volume_ratio(nodes) for energy in self.energies), default=1.0)

    @property
    def history(self) -> Vector:
        """History variables of all energies, concatenated in the order of the energies."""
        return np.concatenate([np.zeros(0), *(energy.history for energy in self.energies)])

    def part_of(self, history: Vector, energy: Energy) -> Vector:
        """Return the part of the concatenated history that belongs to one of the energies."""
        number = self.energies.index(energy)
        begin = sum(len(other.history) for other in self.energies[:number])
        return history[begin : begin + len(energy.history)]

    def with_history(self, history: Vector, nodes: Nodes, controls: Vector) -> "Assembly":
        """Sum of energies that remember `history`, at equilibrium in a given state."""
        ends = np.cumsum([len(energy.history) for energy in self.energies])
        parts = zip(self.energies, np.split(history, ends[:-1]), strict=True)
        return self.with_terms([energy.with_history(part, nodes, controls) for energy, part in parts])

    def history_residual(self, nodes: Nodes, controls: Vector) -> float:
        """Largest error [N] of the quantities that a minimization holds fixed, such as friction limits."""
        return max((energy.history_residual(nodes, controls) for energy in self.energies), default=0.0)

    def with_corrected_history(self, nodes: Nodes, controls: Vector, stiffness: FactorizedHessian | None) -> "Assembly":
        """Return the sum with these quantities corrected; by Newton's method if the stiffness is given."""
        if stiffness is None:
            return self.with_terms([energy.with_corrected_history(nodes, controls, None) for energy in self.energies])
        energies, response = [], stiffness.with_low_rank(self.low_rank_hessian(nodes, controls)).solve
        for energy in self.energies:
            spans = energy.span_columns(nodes)
            compliance = None if spans is None else stiffness.compliance_to(spans)
            energies.append(energy.with_corrected_history(nodes, controls, compliance, response))
        return self.with_terms(energies)

    def with_advanced_history(self, nodes: Nodes, controls: Vector) -> "Assembly":
        """Return the sum for the next increment after a state of the loading path."""
        return self.with_terms([energy.with_advanced_history(nodes, controls) for energy in self.energies])

    def value(self, nodes: Nodes, controls: Vector, known: Sequence[float | None] = ()) -> float:
        """Total energy [J]; infinite where one of the energies is not defined. `known` are those already computed."""
        total = 0.0
        for energy, there in zip_longest(self.energies, known):
            total += energy.value(nodes, controls) if there is None else there
            if not isfinite(total):
                return np.inf
        return total

    def values_before_contact(self, nodes: Nodes, controls: Vector) -> tuple[float, list[float | None]]:
        """Lower bound of the energy, before a search for contact [J], and each energy but contact.

        -inf and none of them where parts are near one another.
        """
        contact = [energy.projects_first for energy in self.energies]
        if not any(contact) or self.projects_first:
            return -np.inf, []
        pairs = zip(self.energies, contact, strict=True)
        values = [None if it else energy.value(nodes, controls) for energy, it in pairs]
        return sum(value for value in values if value is not None), values

    def gradient(self, nodes: Nodes, controls: Vector) -> Float[np.ndarray, " dofs"]:
        """dE/dx [N], (nodes x dim,)."""
        total = np.zeros(self.shape)
        for energy in self.energies:
            energy.add_gradient(nodes, controls, total)
        return total.ravel()

    def hessian(self, nodes: Nodes, controls: Vector, *, projection: float = 0.0) -> "csc_array":
        """d2E/dx2 [N/m], sparse, less its part of low rank.

        `projection` is the share, 0 to 1, of what is negative in the blocks that is taken out (E6).
        """
        from scipy.sparse import csc_array

        values = self._values(nodes, controls, projection)
        return csc_array((values, self.pattern.indices, self.pattern.indptr), shape=(self.size, self.size))

    def low_rank_hessian(self, nodes: Nodes, controls: Vector) -> LowRankStiffness:
        """Springs of all energies together: the part G D G^T of d2E/dx2 that `hessian` leaves out.

        Their law is known if one energy alone has any.
        """
        parts = [part for part in self.low_rank_hessians(nodes, controls) if part is not None]
        if not parts:
            return LowRankStiffness(columns=np.zeros((self.size, 0)), weights=np.zeros((0, 0)))
        if len(parts) == 1:
            return parts[0]
        columns = np.concatenate([part.columns for part in parts], axis=1)
        ends = np.cumsum([0, *(len(part.weights) for part in parts)])
        weights = np.zeros((ends[-1], ends[-1]))
        for begin, end, part in zip(ends, ends[1:], parts, strict=False):
            weights[begin:end, begin:end] = part.weights
        return LowRankStiffness(columns=columns, weights=weights)

    def low_rank_hessians(self, nodes: Nodes, controls: Vector) -> list[LowRankStiffness | None]:
        """Springs of each energy that couple many nodes; None where it has none."""
        return [energy.low_rank_hessian(nodes, controls) for energy in self.energies]

    def stiffness(
        self,
        nodes: Nodes,
        controls: Vector,
        *,
        projection: float = 0.0,
        early: float | None = None,
        shift: float = 0.0,
        damping: float = 0.0,
    ) -> FactorizedHessian:
        """Whole Hessian d2E/dx2, factorized.

        `projection` is as in `hessian`; `early` is that of energies that project first, if it is another one. `damping`
        [N/m] is added to the diagonal, as is `shift`, a share of its largest entry.
        """
        values = self._values(nodes, controls, projection, early)
        if damping:
            values[self.pattern.diagonal] += damping
        if shift:
            values[self.pattern.diagonal] += shift * values[self.pattern.diagonal].max()
        factors = self.pattern.analysis.factorize(values)
        return FactorizedHessian(factors, self.low_rank_hessian(nodes, controls), token=self.token, source=self)

    def control_derivative(self, nodes: Nodes, controls: Vector) -> "csc_array":
        """d2E/dx da, sparse, (nodes x dim, controls)."""
        from scipy.sparse import csc_array

        rows, columns, data = [], [], []
        for energy in self.energies:
            if energy.controls is not None:
                terms, corners = energy.stencils.shape
                dofs = energy.stencils[:, :, None] * self.shape[1] + np.arange(self.shape[1])
                dofs = dofs.reshape(terms, corners * self.shape[1])
                rows.append(dofs.ravel())
                columns.append(np.repeat(energy.controls, dofs.shape[1]))
                data.append(energy.control_gradient(nodes, controls).ravel())
        shape = (self.size, self.control_count)
        if not rows:
            return csc_array(shape)
        return csc_array((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=shape)

    def _like(self, energies: Sequence[Energy], pattern: SparsityPattern) -> "Assembly":
        """Assembly that factors of this one serve too."""
        other = Assembly(energies, rest=pattern.rest, control_count=self.control_count, pattern=pattern)
        other.token = self.token
        return other

    def _values(self, nodes: Nodes, controls: Vector, projection: float, early: float | None = None) -> Vector:
        """Values of the sparse part of the Hessian."""
        self.pattern.settle()
        data = self._quadratic.copy()
        early = float(projection > 0.0) if early is None else early
        for energy, slots in zip(self.energies, self.pattern.slots, strict=True):
            if not energy.has_constant_hessian:
                share = early if energy.projects_first else projection
                energy.add_hessian(nodes, controls, share, ScatterMap(slots, self.pattern.strides, data))
        return data

    @property
    def projects_first(self) -> bool:
        """True if active terms ask for their Hessian to be projected before that of the other energies."""
        return any(energy.projects_first and len(energy.stencils) for energy in self.energies)

    @cached_property
    def _quadratic(self) -> Vector:
        """Values of the Hessian of the energies in which it is constant."""
        data = np.zeros(int(self.pattern.indptr[-1]))
        rest, idle = np.zeros(self.shape), np.zeros(self.control_count)
        for energy, slots in zip(self.energies, self.pattern.slots, strict=True):
            if energy.has_constant_hessian:
                energy.add_hessian(rest, idle, 0.0, ScatterMap(slots, self.pattern.strides, data))
        return data


_GROWN = 1.25
"""A pattern with so many times the entries of the one without terms that come and go serves no other solve."""
