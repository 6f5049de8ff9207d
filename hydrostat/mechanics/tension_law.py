"""`TensionLaw`, `SeriesLaw`, `ChainLaw`: tension of a cable from its stretch, without and with friction."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Vector
from hydrostat.kernel import native
from hydrostat.mechanics.energy import RankMatrix


@dataclass(frozen=True, kw_only=True, eq=False)
class TensionLaw:
    """Unilateral spring by its elongation, shifted so that a cable at rest has no tension (R25, E1, E2, E3).

    T(s) = 0 for s <= 0; k s^2 / (4 eps) for 0 <= s <= 2 eps; k (s - eps) above. Its integral is C2.
    All is a row per cable.

    Attributes:
        stiffness: stiffness k [N/m] (2K in Chang 2018).
        smoothing: smoothing length eps [m].
    """

    stiffness: Vector
    smoothing: Vector

    def energy(self, elongation: Vector) -> Vector:
        """Integral of the tension [J]."""
        return self._evaluate(elongation)[0]

    def tension(self, elongation: Vector) -> Vector:
        """T [N] (R26)."""
        return self._evaluate(elongation)[1]

    def tangent(self, elongation: Vector) -> Vector:
        """dT/ds [N/m]."""
        return self._evaluate(elongation)[2]

    def _evaluate(self, elongation: Vector) -> Float[np.ndarray, "three cables"]:
        stiffness, smoothing = self.stiffness, self.smoothing
        if elongation.shape != stiffness.shape:
            stiffness, smoothing, elongation = np.broadcast_arrays(stiffness, smoothing, elongation)
        found = np.empty((3, len(elongation)))
        native.evaluate(stiffness, smoothing, np.ascontiguousarray(elongation), found)
        return found

    def elongation(self, tension: Vector) -> Vector:
        """Elongation [m] at which a taut cable has this tension > 0 [N]."""
        k, eps = self.stiffness, self.smoothing
        share = np.maximum(tension, 0.0) / k
        return np.where(share > eps, share + eps, 2 * np.sqrt(eps * share))

    def solve_slack_complementarity(self, elongations: Vector, compliance: RankMatrix) -> Vector | None:
        """Tensions of cables on a linear body at rest, as a complementarity problem; None if they are not found.

        The body gives way by compliance @ tensions, so T = law(elongations - compliance @ T): the least of a convex
        function of one number a cable. This knows, as a linear law does not, that a slack cable does not push.

        Args:
            elongations: elongation of each cable on the body before it deforms under them [m].
            compliance: positive semidefinite, (cables, cables) [m/N].
        """
        tensions = np.zeros_like(elongations)
        found = native.balance(self.stiffness, self.smoothing, elongations, compliance, tensions)
        return tensions if found else None


@dataclass(frozen=True, kw_only=True, eq=False)
class SeriesLaw:
    """Tension laws of springs that are several spans in series, by the sum of the elongations of the spans.

    Attributes:
        law: law of each spring.
        offsets: elongation of the spans at which that of the law is 0 [m].
    """

    law: TensionLaw
    offsets: Vector

    def tension(self, elongation: Vector) -> Vector:
        """Least tension of the spans in series [N]."""
        return self.law.tension(elongation - self.offsets)

    def tangent(self, elongation: Vector) -> Vector:
        """dT/ds [N/m]."""
        return self.law.tangent(elongation - self.offsets)

    def solve_slack_complementarity(self, elongations: Vector, compliance: RankMatrix) -> Vector | None:
        """Tensions on a linear body at rest, as in `TensionLaw`."""
        return self.law.solve_slack_complementarity(elongations - self.offsets, compliance)


class SpanSprings(NamedTuple):
    """Springs that the spans of cables are in series, between points where cable sticks.

    Attributes:
        springs: spring that each span belongs to, (spans,).
        elongations: elongation of each spring, the sum of those of its spans [m], (springs,).
        law: tension of each spring.
    """

    springs: Int[np.ndarray, " spans"]
    elongations: Vector
    law: SeriesLaw


@dataclass(frozen=True, kw_only=True, eq=False)
class ChainLaw(TensionLaw):
    """Tensions of the spans of cables between which cable slips, against friction of given largest force.

    A span is a spring of the law of `TensionLaw`, and over the points between spans cable slips by lengths p. They are
    those of least energy: sum of U(elongation + p before - p after) + sum of limit |p|. So neighboring tensions differ
    by no more than the limit, and by just the limit where cable slips, from the lower to the higher tension. As this is
    the minimum of a convex function, the tensions are the gradient of a convex function of the elongations.

    Attributes:
        starts: first span of each cable, followed by the number of spans.
        limits: largest friction force at the point before each span [N]; 0 for the first span of a cable.
    """

    starts: Int[np.ndarray, " ends"]
    limits: Vector
    _last: list[tuple[Vector, Vector]] = field(default_factory=list, init=False, repr=False)

    def slips(self, elongation: Vector) -> Vector:
        """Slip over the point before each span [m], positive towards the winch; 0 for the first span of a cable.

        The last answer is kept: energy, forces and Hessian of one state ask for the same. Threads may share the law, so
        question and answer are read and replaced together.
        """
        for asked, slips in self._last:
            if np.array_equal(asked, elongation):
                return slips
        slips = np.zeros_like(elongation)
        native.relax_chains(elongation, self.stiffness, self.smoothing, self.limits, self.starts, slips)
        self._last[:] = [(elongation.copy(), slips)]
        return slips

    def energy(self, elongation: Vector) -> Vector:
        """Elastic energy of each span plus the energy dissipated by friction at the point before it [J]."""
        slips = self.slips(elongation)
        return super().energy(self._own(elongation, slips)) + self.limits * np.abs(slips)

    def tension(self, elongation: Vector) -> Vector:
        """T of each span [N]."""
        return super().tension(self._own(elongation, self.slips(elongation)))

    def tangents(self, elongation: Vector) -> RankMatrix:
        """dT/ds [N/m]: springs joined where cable slips are one spring in series."""
        slips = self.slips(elongation)
        return self._join_spans(super().tangent(self._own(elongation, slips)), slips != 0)[0]

    def springs(self, elongation: Vector) -> SpanSprings:
        """Springs of the spans while cable goes on slipping where it does, slack neighbors as one.

        Near this state a spring has the tension and derivative of its spans; far from it, those of one taut spring.
        """
        slips = self.slips(elongation)
        own = self._own(elongation, slips)
        _, tensions, derivatives = self._evaluate(own)
        group, series = self._series(derivatives, slips != 0)
        slack = series[group] <= 0
        heads = slips == 0
        heads[1:] &= ~(slack[1:] & slack[:-1])
        heads[self.starts[:-1]] = True
        springs, firsts = np.cumsum(heads) - 1, np.flatnonzero(heads)
        stiffness = 1.0 / np.bincount(springs, 1.0 / self.stiffness)
        smoothing, whole = np.bincount(springs, self.smoothing), np.bincount(springs, own)
        tension, derivative = np.minimum.reduceat(tensions, firsts), series[group[firsts]]
        straight = 1.0 - 1e-9  # A spring of this share of its stiffness is beyond its smoothing
        curved = (derivative > 0) & (derivative < straight * stiffness)
        safe = np.where(curved, derivative, stiffness)
        known = np.where(curved, 2.0 * tension / safe, tension / stiffness + smoothing)
        offsets = whole - np.where(derivative > 0, known, np.bincount(springs, np.minimum(own, 0.0)))
        law = TensionLaw(stiffness=stiffness, smoothing=np.where(curved, stiffness * tension / safe**2, smoothing))
        return SpanSprings(springs, whole, SeriesLaw(law=law, offsets=offsets))

    def compute_slip_jacobians(self, tensions: Vector, signs: Vector) -> tuple[RankMatrix, RankMatrix]:
        """dT/ds [N/m] and dT/dlimits while cable goes on slipping where it does.

        Args:
            tensions: tensions of the spans [N].
            signs: slip direction at the point before each span: 1 towards the winch, -1 the other way, 0 for no slip.
        """
        springs = super().tangent(np.where(tensions > 0, self.elongation(tensions), 0.0))
        by_elongation, soft, same = self._join_spans(springs, signs != 0)
        # A limit lowers the tension of all spans behind it in its group; then all move so that no length changes.
        lowered = -np.tril(same) * signs
        weights = same * soft
        return by_elongation, lowered - weights @ lowered / weights.sum(axis=1, keepdims=True)

    def _own(self, elongation: Vector, slips: Vector) -> Vector:
        """Elongation of each span after the slips."""
        after = np.append(slips[1:], 0.0)
        return elongation + slips - after

    def _join_spans(
        self, springs: Vector, slipping: Bool[np.ndarray, " spans"]
    ) -> tuple[RankMatrix, Vector, RankMatrix]:
        """dT/ds, the compliance of each span, and which spans are joined by points that slip."""
        group, series = self._series(springs, slipping)
        same = (group[:, None] == group).astype(float)
        return same * series[group], 1.0 / np.maximum(springs, 1e-12 * self.stiffness), same

    def _series(
        self, springs: Vector, slipping: Bool[np.ndarray, " spans"]
    ) -> tuple[Int[np.ndarray, " spans"], Vector]:
        """Group of each span that points that slip join, and dT/ds of each group; 0 where a span is slack."""
        group = np.cumsum(~slipping) - 1
        weakest = np.minimum.reduceat(springs, np.flatnonzero(~slipping)) if len(springs) else springs
        soft = np.bincount(group, 1.0 / np.maximum(springs, 1e-12 * self.stiffness))
        return group, np.where(weakest > 0, 1.0 / soft, 0.0)
