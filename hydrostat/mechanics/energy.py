"""`Energy`: the contract of every term of the potential energy E(x; a)."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Protocol, Self, runtime_checkable

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Points, Vector
from hydrostat.kernel import native

if TYPE_CHECKING:
    from hydrostat.mechanics.factorization import Factorization

Stencils = Int[np.ndarray, "terms corners"]
Blocks = Float[np.ndarray, "terms corners dim"]
HessianBlocks = Float[np.ndarray, "terms size size"]
LowRankBasis = Float[np.ndarray, "dofs rank"]
RankMatrix = Float[np.ndarray, "rank rank"]


@runtime_checkable
class Law(Protocol):
    """Forces of a few springs against their elongations s: T = dU/ds, with U convex."""

    def tension(self, elongation: Vector) -> Vector:
        """T [N] at these elongations [m]."""
        ...

    def tangent(self, elongation: Vector) -> Vector:
        """dT/ds [N/m]."""
        ...

    def solve_slack_complementarity(self, elongations: Vector, compliance: RankMatrix) -> Vector | None:
        """T = law(elongations - compliance @ T): spring forces on a linearly compliant body; None if not found."""
        ...


class Compliance:
    """Compliance of the body without coupling springs, K, to the directions of these springs, computed when needed."""

    def __init__(self, factors: "Factorization", columns: LowRankBasis) -> None:
        """Take the factors of K and the directions G."""
        self._factors, self._columns = factors, columns

    @cached_property
    def moves(self) -> LowRankBasis:
        """K^-1 G [m/N]."""
        return self._factors.expand(self._reduced_columns)

    @cached_property
    def compliance(self) -> RankMatrix:
        """G^T K^-1 G [m/N]."""
        return self._factors.inner(self._reduced_columns, self._reduced_columns)

    @cached_property
    def _reduced_columns(self) -> np.ndarray:
        return self._factors.reduce(self._columns)


Response = Callable[[LowRankBasis], LowRankBasis]
"""Displacement of all degrees of freedom under forces on them, a column for each load case [m]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LowRankStiffness:
    """Springs that couple many nodes through few elongations s(x): the part G D G^T of the Hessian, of low rank.

    Attributes:
        columns: G = ds/dx.
        weights: D [N/m], positive semidefinite.
        elongations: s [m]; None if only G and D are given.
        law: force law of the springs, with D = diag(dT/ds); Newton then allows for springs that go slack within a step.
        series: spring that each span belongs to, where springs are spans in series that may change; else None.
    """

    columns: LowRankBasis
    weights: RankMatrix
    elongations: Vector | None = None
    law: Law | None = None
    series: Int[np.ndarray, " spans"] | None = None


class ScatterMap(NamedTuple):
    """Map from the Hessian blocks of one energy to the values of the sparse matrix.

    Attributes:
        slots: index of the first value of the block of each pair of corners of each term, (terms, corners, corners).
        strides: distance between two columns of each node in the values, (nodes,).
        data: values of the sparse matrix, column by column, both triangles.
    """

    slots: np.ndarray
    strides: np.ndarray
    data: np.ndarray


class ContactForces(NamedTuple):
    """Contact points of a body and the forces there.

    Attributes:
        places: positions of the contact points [m].
        forces: forces on the body [N]. For self-contact: on the first side; the other has the opposite force.
        stencils: nodes of the body at each contact point, (places, corners).
    """

    places: Points
    forces: Points
    stencils: Stencils


class Gaps(NamedTuple):
    """Gaps between parts that may touch, less the width at which they come to rest on one another.

    Attributes:
        stencils: nodes of each pair, (pairs, corners).
        widths: gap less that width [m], (pairs,).
        normals: derivative of each gap by the nodes, (pairs, corners, dim).
        stiffness: stiffness of each pair below that width [N/m], (pairs,).
    """

    stencils: Stencils
    widths: Vector
    normals: Blocks
    stiffness: Vector


class Energy(ABC):
    """Sum of terms, each of which depends on the few nodes of its stencil and on at most one control.

    A control is the command of an actuator: the contraction of a winch [m] or the tension of a muscle fibre [N].
    A new energy needs value, gradient and Hessian for assembly and minimization; pass it to a `Simulation` in a list.
    All other methods have defaults; they answer optional requests of a solver. Test an energy with
    `hydrostat.testing.check_energy`.

    Attributes:
        stencils: nodes of each term, (terms, corners).
        controls: index of the control of each term, (terms,); None for an energy without controls.
        supports: index of the support that holds each term, (terms,); None for an energy without supports.
        convex: True if every Hessian block is positive semidefinite wherever the energy is defined.
        has_constant_hessian: True if the Hessian is the same for all nodes and controls; then it is assembled once.
        projects_first: True if its total Hessian is projected first when the sum is indefinite.
        has_history: True if the energy depends on the loading path, as with friction. A solve then follows the path by
            `history_residual`, `with_corrected_history` and `with_advanced_history`, and `history` is kept with the
            pose.
        follows_tangent: True if, with a history, its Hessian after an increment is that of continued motion.
        max_stalled_corrections: number of consecutive corrections without progress after which a solve with history
            stops.
        stiffest: stiffness of its stiffest spring to a fixed place [N/m], which scales rounding errors of positions to
            forces.
    """

    stencils: Stencils
    controls: Int[np.ndarray, " terms"] | None = None
    supports: Int[np.ndarray, " terms"] | None = None
    convex: ClassVar[bool] = True
    has_constant_hessian: ClassVar[bool] = False
    projects_first: ClassVar[bool] = False
    has_history: bool = False
    follows_tangent: ClassVar[bool] = False
    max_stalled_corrections: ClassVar[int] = 40
    stiffest: float = 0.0

    @abstractmethod
    def value(self, nodes: Nodes, controls: Vector) -> float:
        """Return the energy [J]; infinite where it is undefined, as for an inverted element."""

    @abstractmethod
    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        """Return dE/dx of each term [N], (terms, corners, dim)."""

    @abstractmethod
    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        """Return d2E/dx2 of each term [N/m], (terms, corners x dim, corners x dim), without `low_rank_hessian`."""

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        """Return Hessian blocks without this share, 0 to 1, of their negative part (projected Newton)."""
        blocks = self.hessian(nodes, controls)
        return blocks if self.convex else blocks + share * (nearest_semidefinite(blocks) - blocks)

    def add_gradient(self, nodes: Nodes, controls: Vector, total: Nodes) -> None:
        """Add dE/dx to the forces of all nodes [N]; override only if this is faster than `gradient`."""
        native.add_vectors(self.stencils, self.gradient(nodes, controls), total)

    def add_hessian(self, nodes: Nodes, controls: Vector, share: float, places: ScatterMap) -> None:
        """Add d2E/dx2, without a share of its negative part, to the values of a sparse matrix; override as above."""
        if share and not self.convex:
            blocks = self.projected_hessian(nodes, controls, share)
        else:
            blocks = self.hessian(nodes, controls)
        native.add_blocks(self.stencils, places.slots, places.strides, blocks, places.data)

    def low_rank_hessian(self, nodes: Nodes, controls: Vector) -> LowRankStiffness | None:
        """Return springs that couple many nodes, with a low-rank Hessian G D G^T; None for most energies."""
        return None

    def span_columns(self, nodes: Nodes) -> LowRankBasis | None:
        """Return gradients of elongations whose compliance `with_corrected_history` needs; None for most energies."""
        return None

    def control_gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        """Return d2E/dx da of each term, (terms, corners, dim), where a is the term's own control."""
        raise NotImplementedError(f"{type(self).__name__} has no controls")

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        """Return its largest force on the body [N], the scale of a solver's tolerance; 0 for none."""
        return 0.0

    def largest_step(self, nodes: Nodes, move: Nodes) -> float:
        """Return the largest admissible share of a straight move [m], above 0 and at most 1: up to the first contact.

        The solver calls this near the start; the result must cover all terms that the move can activate.
        """
        return 1.0

    def min_volume_ratio(self, nodes: Nodes) -> float:
        """Return the smallest volume ratio J of any element, at most 1; 1 for an energy without elements."""
        return 1.0

    def with_active_terms(self, nodes: Nodes) -> "Energy":
        """Return the energy with the terms that are active near `nodes`; itself if its terms never change."""
        return self

    def continues(self, other: "Energy") -> bool:
        """Return True if another energy differs only in its active terms, so it can replace this one in a solve."""
        return False

    def contact_forces(self, nodes: Nodes) -> ContactForces | None:
        """Return contact points and forces on the body at `nodes`; None for an energy that models no contact."""
        return None

    def gaps(self, nodes: Nodes) -> Gaps | None:
        """Return the gaps of pairs that are close at `nodes`, along which a step slides; None without contact."""
        return None

    def with_load(self, share: float) -> "Energy":
        """Return the energy with this share of its dead load, for load stepping; itself if it has none."""
        return self

    def with_supports_moved(self, shifts: Points) -> "Energy":
        """Return the energy with each support moved by its row of `shifts` [m]; itself if it has no supports."""
        return self

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        """Return d(dE/dx . field) / dp for parameters p by name, one vector each; energies with equal names add up.

        `mu` and `lame` are Lame's parameters [Pa]; `load` is a factor on all dead loads, `thickness` one on terms
        proportional to the thickness of a flat body; `support_stiffness` is that of each support [N/m].
        """
        return {}

    @property
    def history(self) -> Vector:
        """History variables as a flat vector; empty for energies without history."""
        return np.zeros(0)

    def with_history(self, history: Vector, nodes: Nodes, controls: Vector) -> Self:
        """Return the energy with history variables `history`, at equilibrium in a given state."""
        return self

    def history_residual(self, nodes: Nodes, controls: Vector) -> float:
        """Return the error [N] of the quantities held fixed in a minimization, at `nodes`; 0 for most energies."""
        return 0.0

    def with_corrected_history(
        self, nodes: Nodes, controls: Vector, compliance: Compliance | None, response: Response | None = None
    ) -> Self:
        """Return the energy with these quantities corrected; by Newton's method if the compliance is given.

        Args:
            nodes: equilibrium with these quantities fixed [m].
            controls: contractions [m].
            compliance: compliance of the body to the springs of this energy; None if unknown.
            response: displacement of the body under arbitrary forces; None if unknown.
        """
        return self

    def with_advanced_history(self, nodes: Nodes, controls: Vector) -> Self:
        """Return the energy for the next increment after a state of the loading path."""
        return self


class ElementGroups(NamedTuple):
    """Elements eight at a time, the last group filled up with elements of no volume.

    Attributes:
        stencils: nodes of each element, (groups, corners, 8).
        gradients: gradients of the shape functions [1/m], (groups, corners, dim, 8).
        volumes: element volumes [m^3], (groups, 8).
        terms: number of elements.
    """

    stencils: np.ndarray
    gradients: np.ndarray
    volumes: np.ndarray
    terms: int


def element_groups(
    stencils: Stencils, gradients: Float[np.ndarray, "terms corners dim"], volumes: Float[np.ndarray, " terms"]
) -> ElementGroups:
    """Elements with their shape gradients [1/m] and volumes [m^3] in groups."""
    return ElementGroups(
        group_terms(stencils, np.int32), group_terms(gradients, float), group_terms(volumes, float), len(stencils)
    )


def group_moduli(mu: Float[np.ndarray, " terms"], lame: Float[np.ndarray, " terms"]) -> Float[np.ndarray, "2 groups 8"]:
    """Lame's parameters of each element [Pa], grouped like the elements."""
    return np.stack([group_terms(mu, float), group_terms(lame, float)])


def group_terms(array: np.ndarray, kind: type) -> np.ndarray:
    """Rows of elements in groups of eight, the last one filled up with zeros."""
    filled = np.concatenate([array, np.zeros((-len(array) % 8, *array.shape[1:]))])
    groups = filled.reshape(-1, 8, *array.shape[1:])
    return np.ascontiguousarray(np.moveaxis(groups, 1, -1), dtype=kind)


def nearest_semidefinite(blocks: HessianBlocks) -> HessianBlocks:
    """Projection on semidefinite matrices: symmetric blocks with their negative eigenvalues set to zero."""
    values, vectors = np.linalg.eigh(blocks)
    bad = values[:, 0] < 0
    if not bad.any():
        return blocks
    repaired = blocks.copy()
    kept = np.maximum(values[bad], 0.0)
    repaired[bad] = (vectors[bad] * kept[:, None, :]) @ np.swapaxes(vectors[bad], 1, 2)
    return repaired
