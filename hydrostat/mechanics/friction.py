"""`FrictionCableEnergy`: cables that rub at their via points; `ChainLaw`: the tensions along them."""

import math
from copy import copy
from dataclasses import dataclass, replace
from typing import no_type_check

import numpy as np
from jaxtyping import Bool, Float, Int
from numba import njit

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.mechanics.cable import CableEnergy, TensionLaw
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, Stencils
from hydrostat.mechanics.stiffness import Stiffness

Small = Float[np.ndarray, "spans spans"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Turns:
    """Corners of cables in the body, by the directions of the two segments that meet there.

    Attributes:
        stencils: nodes of the segments before, then of those after, (2, corners of cables, nodes of a segment).
        weights: signed, of those nodes.
        offsets: what points fixed in the world add to the segments [m].
        points: at which point of friction a corner is; a sheath is one point with two corners, its ends.
    """

    stencils: Int[np.ndarray, "2 turns corners"]
    weights: Float[np.ndarray, "2 turns corners"]
    offsets: Float[np.ndarray, "2 turns dim"]
    points: Int[np.ndarray, " turns"]

    def angles(self, nodes: Nodes) -> Float[np.ndarray, " turns"]:
        """How far a cable turns at each corner [rad], 0 to pi."""
        before, after = self._directions(nodes)[0]
        return 2 * np.arctan2(np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1))

    def gradients(self, nodes: Nodes, count: int) -> Float[np.ndarray, "dofs points"]:
        """Derivative of the sum of the angles at each of `count` points of friction [rad/m].

        A straight run has none: its angle has a kink there.
        """
        (before, after), lengths = self._directions(nodes)
        cosine = np.einsum("td,td->t", before, after)[:, None]
        sine = np.maximum(np.sin(self.angles(nodes)), _STRAIGHT)[:, None]
        slopes = np.stack([(cosine * before - after) / sine, (cosine * after - before) / sine]) / lengths[..., None]
        columns = np.zeros((*nodes.shape, count))
        spread = self.weights[..., None] * slopes[:, :, None, :]
        axes = np.arange(nodes.shape[1])
        np.add.at(columns, (self.stencils[..., None], axes, self.points[:, None, None]), spread)
        return columns.reshape(nodes.size, count)

    def _directions(self, nodes: Nodes) -> tuple[Float[np.ndarray, "2 turns dim"], Float[np.ndarray, "2 turns"]]:
        spans = np.einsum("stc,stcd->std", self.weights, nodes[self.stencils]) + self.offsets
        lengths = np.maximum(np.linalg.norm(spans, axis=2), np.finfo(float).tiny ** 0.5)
        return spans / lengths[..., None], lengths


@dataclass(frozen=True, kw_only=True, eq=False)
class ChainLaw(TensionLaw):
    """Tensions of the spans of cables between which cable slips, against friction of given largest force.

    A span is a spring of the law of `TensionLaw`, and over the points between spans cable slips by lengths p. They are
    those of least energy: sum of U(stretch + p before - p after) + sum of limit |p|. So neighbouring tensions differ by
    no more than the limit, and by just the limit where cable slips, from the lower to the higher tension. As this is
    the minimum of a convex function, the tensions are the gradient of a convex function of the stretches.

    Attributes:
        starts: first span of each cable, and at the end how many there are.
        limits: largest force of friction at the point before each span [N]; 0 for the first span of a cable.
    """

    starts: Int[np.ndarray, " ends"]
    limits: Vector

    def slips(self, stretch: Vector) -> Vector:
        """P at the point before each span [m], positive towards the winch; 0 for the first span of a cable."""
        slips = np.zeros_like(stretch)
        _relax(stretch, self.stiffness, self.smoothing, self.limits, self.starts, slips)
        return slips

    def energy(self, stretch: Vector) -> Vector:
        """Energy of each span and what friction dissipates at the point before it [J]."""
        slips = self.slips(stretch)
        return super().energy(self._own(stretch, slips)) + self.limits * np.abs(slips)

    def tension(self, stretch: Vector) -> Vector:
        """T of each span [N]."""
        return super().tension(self._own(stretch, self.slips(stretch)))

    def tangents(self, stretch: Vector) -> Small:
        """dT/ds [N/m]: springs joined where cable slips are one spring in series."""
        slips = self.slips(stretch)
        return self._joined(super().tangent(self._own(stretch, slips)), slips != 0)[0]

    def locked(self, tensions: Vector, signs: Vector) -> tuple[Small, Small]:
        """dT/ds [N/m] and dT/dlimits while cable goes on slipping where it does.

        Args:
            tensions: of the spans [N].
            signs: at the point before each span 1 where cable slips towards the winch, -1 the other way, 0 where not.
        """
        springs = super().tangent(np.where(tensions > 0, self.stretch(tensions), 0.0))
        by_stretch, soft, same = self._joined(springs, signs != 0)
        # A limit lowers the tension of all spans behind it in its group; then all move so that no length changes.
        lowered = -np.tril(same) * signs
        weights = same * soft
        return by_stretch, lowered - weights @ lowered / weights.sum(axis=1, keepdims=True)

    def _own(self, stretch: Vector, slips: Vector) -> Vector:
        """Stretch of each span after the slips."""
        after = np.append(slips[1:], 0.0)
        return stretch + slips - after

    def _joined(self, springs: Vector, slipping: Bool[np.ndarray, " spans"]) -> tuple[Small, Vector, Small]:
        """dT/ds, the compliance of each span, and which spans are joined by points that slip."""
        group = np.cumsum(~slipping) - 1
        same = (group[:, None] == group).astype(float)
        soft = 1.0 / np.maximum(springs, 1e-12 * self.stiffness)
        weakest = np.minimum.reduceat(springs, np.flatnonzero(~slipping))
        series = np.where(weakest > 0, 1.0 / np.bincount(group, soft), 0.0)
        return same * series[group], soft, same


class FrictionCableEnergy(Energy):
    """Cables that rub at the points where they turn: E14, F4.

    A cable with friction is a chain of springs of its own material, a span for every segment that is not sheathed; one
    without friction is a single span, as in `CableEnergy`. Cable slips over the point between two spans against a force
    of at most `law.limits`. By the capstan law this belongs to the tensions and angles of the state that is found, so
    there is no potential: whoever minimises brings it about, by `capstan_limits`, `corrected` and `with_limits`. The
    slips of the past are in `slips`; `after` gives the energy of what comes next.

    Attributes:
        slips: what has passed the point before each span [m], positive towards the winch.
        friction: coefficient mu at the point before each span.
        law: of the spans, with the limits of friction.
    """

    def __init__(
        self,
        nodes: Nodes,
        *,
        stencils: Stencils,
        weights: Float[np.ndarray, "terms corners"],
        offsets: Points,
        cables: Int[np.ndarray, " terms"],
        law: TensionLaw,
        winches: Int[np.ndarray, " cables"],
        slack: Vector,
        friction: Vector,
        turns: Turns,
    ) -> None:
        """Cables at rest on the rest shape `nodes`, which have not yet slipped.

        Args:
            nodes: rest positions [m].
            stencils: nodes of each segment.
            weights: signed: those of its end less those of its start.
            offsets: what points fixed in the world add to each segment [m].
            cables: which cable a segment belongs to, rising.
            law: tension against stretch, of each cable.
            winches: whose contraction each cable follows.
            slack: of each cable, taken in before it begins to be taut [m]; at the winch.
            friction: coefficient mu of each cable.
            turns: where they turn; their points are the segments after them.
        """
        first = np.append(True, np.diff(cables) != 0)[: len(cables)]
        heads = first | (friction[cables] > 0)
        spans = np.cumsum(heads) - 1
        owners, firsts = cables[heads], first[heads]
        self._spans = CableEnergy(
            nodes,
            stencils=stencils,
            weights=weights,
            offsets=offsets,
            cables=spans,
            law=law,
            winches=winches[owners],
            slack=np.where(firsts, slack[owners], 0.0),
        )
        self.stencils, self.controls = self._spans.stencils, self._spans.controls
        lengths = self._spans.rest_lengths
        shares = lengths / np.bincount(owners, lengths, len(winches))[owners]
        self.friction = np.where(firsts, 0.0, friction[owners])
        self.slips = np.zeros(len(owners))
        self._firsts, self._owners = firsts, owners
        self._turns = Turns(
            stencils=turns.stencils, weights=turns.weights, offsets=turns.offsets, points=spans[turns.points]
        )
        self.law = ChainLaw(
            stiffness=law.stiffness[owners] / shares,
            smoothing=law.smoothing[owners] * shares,
            starts=np.append(np.flatnonzero(firsts), len(owners)),
            limits=np.zeros(len(owners)),
        )

    def stretches(self, nodes: Nodes, controls: Vector) -> Vector:
        """S of each span [m] if nothing slips."""
        spans = self._spans
        moved = np.where(self._firsts, controls[spans.winches] - spans.slack, self.slips)
        passed = np.append(np.where(self._firsts, 0.0, self.slips)[1:], 0.0)
        return spans.lengths(nodes) - spans.rest_lengths + moved - passed

    def span_tensions(self, nodes: Nodes, controls: Vector) -> Vector:
        """T of each span [N]."""
        return self.law.tension(self.stretches(nodes, controls))

    def tensions(self, nodes: Nodes, controls: Vector) -> Vector:
        """T of each cable [N] in the span at its winch."""
        return self.span_tensions(nodes, controls)[self._firsts]

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return float(self.law.energy(self.stretches(nodes, controls)).sum())

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self._pull(nodes, self.span_tensions(nodes, controls))

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self._spans.bends(nodes, self.span_tensions(nodes, controls))

    def low_rank(
        self, nodes: Nodes, controls: Vector
    ) -> tuple[Float[np.ndarray, "dofs spans"], Float[np.ndarray, "spans spans"]]:
        return self._spans.columns(nodes), self.law.tangents(self.stretches(nodes, controls))

    def control_gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self._pull(nodes, self._by_control(self.law.tangents(self.stretches(nodes, controls))))

    def angles(self, nodes: Nodes) -> Vector:
        """How far the cable turns at the point before each span, at both ends of a sheath together [rad]."""
        return np.bincount(self._turns.points, self._turns.angles(nodes), len(self.slips))

    def capstan_limits(self, nodes: Nodes, controls: Vector) -> Vector:
        """Limits of friction at these tensions and angles: the larger tension x (1 - exp(-mu angle)) [N]."""
        tensions = self.span_tensions(nodes, controls)
        larger = np.maximum(tensions, np.append(0.0, tensions[:-1]))
        return -np.expm1(-self.friction * self.angles(nodes)) * larger

    def with_limits(self, limits: Vector) -> "FrictionCableEnergy":
        """The same against other limits of friction [N]."""
        return self._with(limits, self.slips)

    def resumed(self, slips: Vector, nodes: Nodes, controls: Vector) -> "FrictionCableEnergy":
        """The same after other slips [m], at equilibrium with these in a given state."""
        still = self._with(np.full_like(slips, _HELD), slips)
        return still.with_limits(still.capstan_limits(nodes, controls))

    def after(self, nodes: Nodes, controls: Vector) -> "FrictionCableEnergy":
        """Energy of what follows a state: the cable has slipped, and the limits are those of that state."""
        slips = self.slips + self.law.slips(self.stretches(nodes, controls))
        return self._with(self.capstan_limits(nodes, controls), slips)

    def corrected(self, nodes: Nodes, controls: Vector, stiffness: Stiffness) -> Vector:
        """Better limits [N] than those now: a step of Newton towards the capstan law.

        Args:
            nodes: equilibrium with the limits as they are [m].
            controls: contractions [m].
            stiffness: the Hessian there.
        """
        stretches = self.stretches(nodes, controls)
        tensions = self.law.tension(stretches)
        by_stretch, by_limit = self.law.locked(tensions, np.sign(self.law.slips(stretches)))
        unit = np.eye(len(tensions))
        moved = np.linalg.solve(unit + by_stretch @ stiffness.compliance, by_limit)
        slopes = unit - self._limit_slopes(nodes, tensions, stiffness) @ moved
        miss = self.capstan_limits(nodes, controls) - self.law.limits
        return np.maximum(self.law.limits + np.linalg.solve(slopes, miss), 0.0)

    def moves(self, nodes: Nodes, controls: Vector, stiffness: Stiffness) -> Float[np.ndarray, "dofs controls"]:
        """D nodes / d controls while the capstan law holds and cable goes on slipping where it is about to.

        Args:
            nodes: an equilibrium [m].
            controls: contractions [m].
            stiffness: the Hessian there.
        """
        tensions = self.span_tensions(nodes, controls)
        drops = np.where(self._firsts, 0.0, np.append(0.0, -np.diff(tensions)))
        near = _AT_THE_LIMIT * tensions.max(initial=0.0)
        slipping = np.abs(drops) >= self.capstan_limits(nodes, controls) - near
        by_stretch, by_limit = self.law.locked(tensions, np.sign(drops) * slipping)
        pulled = np.zeros((len(tensions), len(controls)))
        pulled[np.arange(len(tensions)), self._spans.winches] = self._by_control(by_stretch)
        unit = np.eye(len(tensions))
        slopes = unit + by_stretch @ stiffness.compliance - by_limit @ self._limit_slopes(nodes, tensions, stiffness)
        return -stiffness.moves @ np.linalg.solve(slopes, pulled)

    def _limit_slopes(self, nodes: Nodes, tensions: Vector, stiffness: Stiffness) -> Small:
        """D capstan limits / d tensions, of the body that gives way to these too."""
        before = np.append(0.0, tensions[:-1])
        angles = self.friction * self.angles(nodes)
        slopes = np.zeros((len(tensions), len(tensions)))
        span = np.arange(len(tensions))
        slopes[span, span - (before > tensions)] = -np.expm1(-angles)
        turned = self._turns.gradients(nodes, len(tensions)).T @ stiffness.moves
        return slopes - (self.friction * np.exp(-angles) * np.maximum(tensions, before))[:, None] * turned

    def _pull(self, nodes: Nodes, forces: Vector) -> Blocks:
        return self._spans.length_gradients(nodes) * forces[self._spans.cables][:, None, None]

    def _by_control(self, tangents: Small) -> Vector:
        """Slope of the tension of each span along the contraction of its winch [N/m]."""
        return tangents[np.arange(len(tangents)), self.law.starts[self._owners]]

    def _with(self, limits: Vector, slips: Vector) -> "FrictionCableEnergy":
        other = copy(self)
        other.law = replace(self.law, limits=limits)
        other.slips = slips
        return other


_HELD = 1e30
"""Friction that nothing overcomes [N]."""

_STRAIGHT = 1e-9
"""A turn of less [rad] counts as none."""

_AT_THE_LIMIT = 1e-6
"""Tensions that come as near to the capstan's limit, as a share of the largest tension, are at it."""

_RELAXATIONS = 500
"""Most steps towards the slips of a cable; it takes about five, and one more for each span that becomes taut."""


_NOISE = 1e-15
"""A stretch is known to this fraction of the lengths that it is the sum of."""


@njit(cache=True, error_model="numpy")
@no_type_check
def _relax(stretch, stiffness, smoothing, limits, starts, slips):
    """Slips of least energy, by Newton's method on those that are free to slip; 0 is a bound for each."""
    count = len(stretch)
    tension, tangent = np.empty(count), np.empty(count)
    force, step, sign = np.empty(count), np.empty(count), np.empty(count)
    trial, work = np.zeros(count), np.empty(count)
    for chain in range(len(starts) - 1):
        start, end = starts[chain], starts[chain + 1]
        if end - start < 2:
            continue
        energy = _pull(start, end, stretch, stiffness, smoothing, limits, slips, tension, tangent)
        for _ in range(_RELAXATIONS):
            worst, noise = 0.0, 0.0
            for span in range(start, end):
                lengths = abs(stretch[span]) + abs(slips[span]) + smoothing[span]
                noise = max(noise, _NOISE * stiffness[span] * lengths)
            for span in range(start + 1, end):
                sign[span] = 0.0
                drop = tension[span - 1] - tension[span]
                if slips[span] != 0.0:
                    sign[span] = math.copysign(1.0, slips[span])
                elif abs(drop) > limits[span]:
                    sign[span] = math.copysign(1.0, drop)
                force[span] = drop - sign[span] * limits[span] if sign[span] != 0.0 else 0.0
                worst = max(worst, abs(force[span]))
            if worst <= noise:
                break
            held = True
            while held:  # a slip that would turn back at once stays where it is
                held = False
                _newton(start, end, stiffness, tangent, force, sign, step, work)
                for span in range(start + 1, end):
                    if sign[span] != 0.0 and slips[span] == 0.0 and step[span] * sign[span] < 0.0:
                        sign[span], force[span], held = 0.0, 0.0, True
            length, better = 1.0, False
            for _ in range(60):
                gain = 0.0
                for span in range(start + 1, end):
                    moved = slips[span] + length * step[span]
                    trial[span] = moved if moved * sign[span] > 0.0 else 0.0
                    gain += force[span] * (trial[span] - slips[span])
                reached = _pull(start, end, stretch, stiffness, smoothing, limits, trial, tension, tangent)
                if reached <= energy - 1e-4 * gain + 1e-15 * abs(energy):
                    better = True
                    break
                length *= 0.5
            if not better:
                break
            change = 0.0
            for span in range(start + 1, end):
                change = max(change, abs(trial[span] - slips[span]))
                slips[span] = trial[span]
            energy = reached
            if change == 0.0:
                break


@njit(cache=True, error_model="numpy", inline="always")
@no_type_check
def _pull(start, end, stretch, stiffness, smoothing, limits, slips, tension, tangent):
    """Tensions and tangents of the spans of one cable; its energy."""
    energy = 0.0
    for span in range(start, end):
        own, k, eps = stretch[span], stiffness[span], smoothing[span]
        if span > start:
            own += slips[span]
            energy += limits[span] * abs(slips[span])
        if span + 1 < end:
            own -= slips[span + 1]
        if own > 2 * eps:
            tension[span], tangent[span] = k * (own - eps), k
            energy += k * (0.5 * (own - eps) ** 2 + eps * eps / 6)
        elif own > 0.0:
            tension[span], tangent[span] = k * own * own / (4 * eps), k * own / (2 * eps)
            energy += k * own**3 / (12 * eps)
        else:
            tension[span], tangent[span] = 0.0, 0.0
    return energy


@njit(cache=True, error_model="numpy", inline="always")
@no_type_check
def _newton(start, end, stiffness, tangent, force, sign, step, work):
    """Step of the slips that are free: a tridiagonal system, by elimination."""
    before = 0.0
    for span in range(start + 1, end):
        if sign[span] == 0.0:
            step[span], before = 0.0, 0.0
            work[span] = 0.0
            continue
        pivot = tangent[span - 1] + tangent[span] + 1e-6 * stiffness[span]
        right = force[span]
        if before > 0.0:
            ratio = tangent[span - 1] / before
            pivot -= ratio * tangent[span - 1]
            right += ratio * step[span - 1]
        step[span], before = right, pivot
        work[span] = pivot
    for span in range(end - 1, start, -1):
        if sign[span] == 0.0:
            continue
        right = step[span]
        if span + 1 < end:
            right += tangent[span] * step[span + 1]
        step[span] = right / work[span]
