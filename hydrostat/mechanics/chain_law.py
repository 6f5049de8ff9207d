"""`ChainLaw`: the tensions along a cable (tendon) with capstan friction."""

import math
from dataclasses import dataclass
from typing import no_type_check

import numpy as np
from jaxtyping import Bool, Int

from hydrostat.arrays import Vector
from hydrostat.kernel import INNER, KERNEL, njit
from hydrostat.mechanics.energy import Small
from hydrostat.mechanics.tension_law import TensionLaw, spring


@dataclass(frozen=True, kw_only=True, eq=False)
class ChainLaw(TensionLaw):
    """Tensions of the spans of cables between which cable slips, against friction of given largest force.

    A span is a spring of the law of `TensionLaw`, and over the points between spans cable slips by lengths p. They are
    those of least energy: sum of U(elongation + p before - p after) + sum of limit |p|. So neighbouring tensions differ
    by no more than the limit, and by just the limit where cable slips, from the lower to the higher tension. As this is
    the minimum of a convex function, the tensions are the gradient of a convex function of the elongations.

    Attributes:
        starts: first span of each cable, and at the end how many there are.
        limits: largest force of friction at the point before each span [N]; 0 for the first span of a cable.
    """

    starts: Int[np.ndarray, " ends"]
    limits: Vector

    def slips(self, elongation: Vector) -> Vector:
        """P at the point before each span [m], positive towards the winch; 0 for the first span of a cable."""
        slips = np.zeros_like(elongation)
        _relax(elongation, self.stiffness, self.smoothing, self.limits, self.starts, slips)
        return slips

    def energy(self, elongation: Vector) -> Vector:
        """Energy of each span and what friction dissipates at the point before it [J]."""
        slips = self.slips(elongation)
        return super().energy(self._own(elongation, slips)) + self.limits * np.abs(slips)

    def tension(self, elongation: Vector) -> Vector:
        """T of each span [N]."""
        return super().tension(self._own(elongation, self.slips(elongation)))

    def tangents(self, elongation: Vector) -> Small:
        """dT/ds [N/m]: springs joined where cable slips are one spring in series."""
        slips = self.slips(elongation)
        return self._joined(super().tangent(self._own(elongation, slips)), slips != 0)[0]

    def locked(self, tensions: Vector, signs: Vector) -> tuple[Small, Small]:
        """dT/ds [N/m] and dT/dlimits while cable goes on slipping where it does.

        Args:
            tensions: of the spans [N].
            signs: at the point before each span 1 where cable slips towards the winch, -1 the other way, 0 where not.
        """
        springs = super().tangent(np.where(tensions > 0, self.elongation(tensions), 0.0))
        by_elongation, soft, same = self._joined(springs, signs != 0)
        # A limit lowers the tension of all spans behind it in its group; then all move so that no length changes.
        lowered = -np.tril(same) * signs
        weights = same * soft
        return by_elongation, lowered - weights @ lowered / weights.sum(axis=1, keepdims=True)

    def _own(self, elongation: Vector, slips: Vector) -> Vector:
        """Elongation of each span after the slips."""
        after = np.append(slips[1:], 0.0)
        return elongation + slips - after

    def _joined(self, springs: Vector, slipping: Bool[np.ndarray, " spans"]) -> tuple[Small, Vector, Small]:
        """dT/ds, the compliance of each span, and which spans are joined by points that slip."""
        group = np.cumsum(~slipping) - 1
        same = (group[:, None] == group).astype(float)
        soft = 1.0 / np.maximum(springs, 1e-12 * self.stiffness)
        weakest = np.minimum.reduceat(springs, np.flatnonzero(~slipping))
        series = np.where(weakest > 0, 1.0 / np.bincount(group, soft), 0.0)
        return same * series[group], soft, same


_RELAXATIONS = 500
"""Most steps towards the slips of a cable; it takes about five, and one more for each span that becomes taut."""


_NOISE = 1e-15
"""An elongation is known to this fraction of the lengths that it is the sum of."""


@njit(**KERNEL)
@no_type_check
def _relax(elongation, stiffness, smoothing, limits, starts, slips):
    """Slips of least energy, by Newton's method on those that are free to slip; 0 is a bound for each."""
    count = len(elongation)
    tension, tangent = np.empty(count), np.empty(count)
    force, step, sign = np.empty(count), np.empty(count), np.empty(count)
    trial, work = np.zeros(count), np.empty(count)
    for chain in range(len(starts) - 1):
        start, end = starts[chain], starts[chain + 1]
        if end - start < 2:
            continue
        energy = _tighten(start, end, elongation, stiffness, smoothing, limits, slips, tension, tangent)
        for _ in range(_RELAXATIONS):
            worst, noise = 0.0, 0.0
            for span in range(start, end):
                lengths = abs(elongation[span]) + abs(slips[span]) + smoothing[span]
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
                reached = _tighten(start, end, elongation, stiffness, smoothing, limits, trial, tension, tangent)
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


@njit(**INNER)
@no_type_check
def _tighten(start, end, elongation, stiffness, smoothing, limits, slips, tension, tangent):
    """Tensions and tangents of the spans of one cable; its energy."""
    energy = 0.0
    for span in range(start, end):
        own = elongation[span]
        if span > start:
            own += slips[span]
            energy += limits[span] * abs(slips[span])
        if span + 1 < end:
            own -= slips[span + 1]
        stored, tension[span], tangent[span] = spring(stiffness[span], smoothing[span], own)
        energy += stored
    return energy


@njit(**INNER)
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
