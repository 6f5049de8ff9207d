"""`CableEnergy`: all cables (tendons) of a robot, taut or slack."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Points, Vector
from hydrostat.kernel import native
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, LowRankStiffness, ScatterMap, Stencils
from hydrostat.mechanics.tension_law import TensionLaw


@dataclass(frozen=True, kw_only=True, eq=False)
class CableSegments:
    """Straight runs between the points of cables: d = sum of weights x nodes + offset.

    Attributes:
        stencils: nodes of each segment, (terms, corners).
        weights: signed weights of the nodes: those of the segment's end minus those of its start, (terms, corners).
        offsets: contribution of points fixed in the world to each span [m], (terms, dim).
        cables: index of the cable that a segment belongs to, in rising order, (terms,).
    """

    stencils: Stencils
    weights: Float[np.ndarray, "terms corners"]
    offsets: Points
    cables: Int[np.ndarray, " terms"]


class CableEnergy(Energy):
    """Sum of U of frictionless cables, elongation s = l(x) - l(X) + ratio a - slack [m] (R23 to R27, E1, E11, E12).

    A term is a segment of a cable that is not sheathed: a sheathed one keeps its rest length, so it is left out of l.
    The span of a segment is d = sum of weights x nodes + offset: between two anchors in the body, or from a point fixed
    in the world, which is all offset. The length of a segment is rounded off where its two ends meet, so that it has a
    derivative there. U rises with s and l is convex in x, hence the energy is convex.

    The Hessian of a cable is T' dl dl^T + T d2l. The first part couples all the nodes along a cable, so it is kept as
    the low rank it has; the blocks hold the second one.
    """

    def __init__(
        self,
        nodes: Nodes,
        segments: CableSegments,
        *,
        law: TensionLaw,
        winches: Int[np.ndarray, " cables"],
        slack: Vector,
        ratios: Vector | None = None,
    ) -> None:
        """Cables on the rest shape `nodes`.

        Args:
            nodes: rest positions [m].
            segments: those that are not sheathed.
            law: tension against elongation, of each cable.
            winches: index of the winch whose contraction each cable follows.
            slack: contraction at which each cable starts to become taut [m].
            ratios: contraction of each cable per meter of its winch's contraction; 1 by default.
        """
        self.stencils, self.weights, self.offsets = (
            np.ascontiguousarray(part) for part in (segments.stencils, segments.weights, segments.offsets)
        )
        self.cables, self.winches = segments.cables, winches
        self.controls = winches[self.cables]
        self.law, self.slack = law, slack
        self.ratios = np.ones(len(winches)) if ratios is None else ratios
        self.roundings = np.zeros(len(self.cables))
        self.roundings = np.maximum(_ROUNDING * self._spans(nodes)[1], np.finfo(float).tiny ** 0.5)
        self.rest_lengths = self.lengths(nodes)

    def lengths(self, nodes: Nodes) -> Vector:
        """Length of each cable without its sheathed segments [m]."""
        lengths = np.zeros(len(self.winches))
        native.lengths(nodes, self.stencils, self.weights, self.offsets, self.roundings, self.cables, lengths)
        return lengths

    def compute_contractions(self, controls: Vector) -> Vector:
        """Return the contraction of each cable, that is the length taken in [m]."""
        return self.ratios * controls[self.winches]

    def elongations(self, nodes: Nodes, controls: Vector) -> Vector:
        """Elongations s [m] of the cables beyond their free length; negative when slack."""
        return self.lengths(nodes) - self.rest_lengths + self.compute_contractions(controls) - self.slack

    def tensions(self, nodes: Nodes, controls: Vector) -> Vector:
        """T of each cable [N]."""
        return self.law.tension(self.elongations(nodes, controls))

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return float(self.law.energy(self.elongations(nodes, controls)).sum())

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self._pull(nodes, self.tensions(nodes, controls))

    def add_gradient(self, nodes: Nodes, controls: Vector, total: Nodes) -> None:
        forces = self.tensions(nodes, controls)[self.cables]
        self._add_gradients(nodes, np.zeros_like(self.cables), forces, total[:, :, None])

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.bends(nodes, self.tensions(nodes, controls))

    def add_hessian(self, nodes: Nodes, controls: Vector, share: float, places: ScatterMap) -> None:
        spans, lengths = self._spans(nodes)
        pulls = self.tensions(nodes, controls)[self.cables] / lengths
        native.add_bends(spans, lengths, self.weights, pulls, self.stencils, *places)

    def control_gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self._pull(nodes, self.ratios * self.law.tangent(self.elongations(nodes, controls)))

    def low_rank_hessian(self, nodes: Nodes, controls: Vector) -> LowRankStiffness:
        elongations = self.elongations(nodes, controls)
        weights = np.diag(self.law.tangent(elongations))
        return LowRankStiffness(columns=self.columns(nodes), weights=weights, elongations=elongations, law=self.law)

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        return float(self.tensions(nodes, controls).max(initial=0.0))

    def columns(self, nodes: Nodes) -> Float[np.ndarray, "dofs cables"]:
        """Derivatives dl/dx of the length of each cable."""
        return self.spring_columns(nodes, np.arange(len(self.winches)), len(self.winches))

    def spring_columns(
        self, nodes: Nodes, springs: Int[np.ndarray, " cables"], count: int
    ) -> Float[np.ndarray, "dofs springs"]:
        """Derivatives dl/dx of the lengths of springs, each of them of some cables.

        Args:
            nodes: positions [m].
            springs: the spring that each cable is part of; -1 for none.
            count: number of springs.
        """
        columns, owners = np.zeros((*nodes.shape, count)), springs[self.cables]
        if count:
            self._add_gradients(nodes, np.maximum(owners, 0), (owners >= 0).astype(float), columns)
        return columns.reshape(nodes.size, count)

    def length_gradients(self, nodes: Nodes) -> Blocks:
        """Derivatives dl/dx of each segment at its stencil's nodes."""
        return self._pull(nodes, np.ones(len(self.winches)))

    def bends(self, nodes: Nodes, tensions: Vector) -> HessianBlocks:
        """T d2l/dx2 of each segment under the tension of its cable [N/m]."""
        spans, lengths = self._spans(nodes)
        size = self.weights.shape[1] * nodes.shape[1]
        blocks = np.empty((len(self.cables), size, size))
        native.bends(spans, lengths, self.weights, tensions[self.cables], blocks)
        return blocks

    def _pull(self, nodes: Nodes, forces: Vector) -> Blocks:
        spans, lengths = self._spans(nodes)
        directions = spans * (forces[self.cables] / lengths)[:, None]
        return self.weights[:, :, None] * directions[:, None, :]

    def _add_gradients(self, nodes: Nodes, columns: np.ndarray, factors: Vector, total: np.ndarray) -> None:
        """Add the derivatives of the length of each segment, times a factor, to its column of (nodes, dim, columns)."""
        segments = self.stencils, self.weights, self.offsets, self.roundings
        native.add_slopes(nodes, *segments, columns, factors, total)

    def _spans(self, nodes: Nodes) -> tuple[Points, Float[np.ndarray, " terms"]]:
        spans = np.empty((len(self.cables), nodes.shape[1]))
        lengths = np.empty(len(self.cables))
        native.measure(nodes, self.stencils, self.weights, self.offsets, self.roundings, spans, lengths)
        return spans, lengths


_ROUNDING = 1e-3
"""A segment d has the length sqrt(d^2 + r^2), with r this fraction of its rest length: 5e-7 of it too long.

A plain norm has a kink at d = 0, where a winch that pulls hard brings two via points together: the least energy lies in
the kink, no gradient vanishes there, and Newton stops without a descent.
"""
