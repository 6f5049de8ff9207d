"""Newton's method with a safeguarded step: the statics solver."""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import count

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics.assembly import Assembly
from hydrostat.mechanics.cable import CableEnergy
from hydrostat.mechanics.settle import settle
from hydrostat.mechanics.stiffness import Stiffness
from hydrostat.mechanics.warp import Warp


class Reason(StrEnum):
    """Why a solve ended."""

    CONVERGED = "converged"
    ITERATION_LIMIT = "iteration limit reached"
    NO_DESCENT = "no step lowers the energy"
    BAD_START = "the start has an inverted element"


@dataclass(frozen=True, kw_only=True)
class NewtonOptions:
    """How far and how long Newton goes (M4).

    Attributes:
        tolerance: largest nodal force left over, as a fraction of the largest applied force.
        iterations: most iterations.
        halvings: most halvings of one step.
    """

    tolerance: float = 1e-10
    iterations: int = 200
    halvings: int = 50


@dataclass(frozen=True, kw_only=True)
class RoundOff:
    """What is lost in the rounding errors of a body whose modulus x volume is some energy.

    Attributes:
        force: [N].
        energy: [J].
    """

    force: float
    energy: float


@dataclass(frozen=True, kw_only=True, eq=False)
class NewtonResult:
    """Where Newton stopped.

    Attributes:
        nodes: the best positions found [m]; every element has J > 0.
        reason: why it stopped.
        residual: largest component of a nodal force [N].
        allowed: residual [N] at which it counts as converged.
        energy: total energy [J].
        iterations: steps taken.
        stable: whether the full Hessian there is positive definite: a minimum, no saddle.
        buckled: whether a saddle was left on the way: the body could as well have gone elsewhere.
        stiffness: the Hessian there, factorised, or where the last step began, if that was with less than 1e-5 of the
            applied force left over.
    """

    nodes: Nodes
    reason: Reason
    residual: float
    allowed: float
    energy: float
    iterations: int
    stable: bool
    buckled: bool
    stiffness: Stiffness | None = field(repr=False)

    @property
    def converged(self) -> bool:
        """Whether the residual is as small as allowed."""
        return self.reason is Reason.CONVERGED


def minimise(
    assembly: Assembly,
    start: Nodes,
    controls: Vector,
    *,
    force_scale: Callable[[Nodes], float],
    round_off: RoundOff,
    options: NewtonOptions,
    warp: Warp | None = None,
    stiffness: Stiffness | None = None,
) -> NewtonResult:
    """Nodes of least energy near `start` at fixed controls (R15, R17, R19).

    The full Hessian is used wherever it is positive definite, mixed with the projected one elsewhere (E6). The
    step follows arcs and knows that a cable can go slack; it is halved until no element is inverted and the energy
    falls. A saddle is left along a mode in which the energy falls.

    Args:
        assembly: the energy.
        start: positions to begin at [m].
        controls: contractions [m] or tensions [N].
        force_scale: largest applied force [N] at given nodes; `options.tolerance` is relative to it.
        round_off: forces and energies too small to be told apart.
        options: tolerance and limits.
        warp: bends steps along arcs; only straight ones without it.
        stiffness: the Hessian at `start` at other controls, such as those at which it is in equilibrium. The first step
            then costs no factorisation: it is the prediction dx/da, bent along arcs.
    """
    return _Descent(assembly, controls, force_scale, round_off, options, warp).run(start, stiffness)


class _Descent:
    """One minimisation; `run` is the loop, each method one part of it."""

    def __init__(
        self,
        assembly: Assembly,
        controls: Vector,
        force_scale: Callable[[Nodes], float],
        round_off: RoundOff,
        options: NewtonOptions,
        warp: Warp | None,
    ) -> None:
        self.assembly, self.controls = assembly, controls
        self.force_scale, self.noise, self.options, self.warp = force_scale, round_off, options, warp
        self.cables = next((energy for energy in assembly.energies if isinstance(energy, CableEnergy)), None)
        self.share = 0.0
        self.saddles = 0

    def run(self, start: Nodes, known: Stiffness | None) -> NewtonResult:
        """Newton from `start` to a reason to stop."""
        assembly, controls = self.assembly, self.controls
        nodes, energy = start, assembly.value(start, controls)
        if not np.isfinite(energy):
            return self._result(start, Reason.BAD_START, np.inf, 0.0, energy, 0, None)
        gradient = assembly.gradient(nodes, controls)
        last, last_near = None, False
        for iteration in count():
            allowed = max(self.options.tolerance * self.force_scale(nodes), self.noise.force)
            residual = float(np.abs(gradient).max())
            arrived = residual <= allowed
            near = residual < _NEAR * self.force_scale(nodes)
            if arrived or iteration == self.options.iterations:
                stiffness = last if arrived and last_near else assembly.stiffness(nodes, controls)
                found = self._leave_saddle(nodes, energy, stiffness) if arrived else None
                if found is None:
                    reason = Reason.CONVERGED if arrived else Reason.ITERATION_LIMIT
                    return self._result(nodes, reason, residual, allowed, energy, iteration, stiffness)
                nodes, energy, gradient = found
                continue
            found = None
            if last is not None and near:
                found = self._chord(nodes, energy, gradient, last)
            if found is None:
                last, known, last_near = self._reuse(nodes, known) or self._definite(nodes), None, near
                if last is not None:
                    found = self._search(nodes, energy, gradient, last)
            if found is None:
                stiffness = assembly.stiffness(nodes, controls)
                return self._result(nodes, Reason.NO_DESCENT, residual, allowed, energy, iteration, stiffness)
            nodes, energy, gradient = found
            if self.share > 0.0:
                last, last_near = None, False
        raise AssertionError("count() never ends")

    def _reuse(self, nodes: Nodes, known: Stiffness | None) -> Stiffness | None:
        """What is known of the Hessian, with the cables as they are now; None if that is not definite."""
        if known is None or known.singular:
            return None
        stiffness = known.with_weights(self.assembly.low_rank(nodes, self.controls)[1])
        return stiffness if stiffness.definite else None

    def _definite(self, nodes: Nodes) -> Stiffness | None:
        """The Hessian, or a definite matrix in its place where it is not definite.

        Near a buckling load the full Hessian is indefinite by a hair only. There the projected one is far too stiff: it
        drops the whole effect of compression, and Newton creeps for hundreds of steps. So only a share of what is
        negative is taken out; the share falls from step to step as long as it suffices. None where nothing helps: the
        Hessian is not finite, or 0.
        """
        self.share = self.share / 4 if self.share > _LEAST_SHARE else 0.0
        while True:
            stiffness = self.assembly.stiffness(nodes, self.controls, lift=self.share)
            if stiffness.definite:
                return stiffness
            if self.share == 1.0:
                break
            self.share = min(4 * self.share, 1.0) if self.share else 1.0
        for shift in _SHIFTS:
            stiffness = self.assembly.stiffness(nodes, self.controls, lift=1.0, shift=shift)
            if stiffness.definite:
                return stiffness
        return None

    def _search(
        self, nodes: Nodes, energy: float, gradient: Vector, stiffness: Stiffness
    ) -> tuple[Nodes, float, Vector] | None:
        """Next nodes, energy and gradient; None if no length of the step lowers the energy.

        Near the end the energy falls by less than its own noise; then the slope along the step must fall instead.
        """
        step = self._step(nodes, gradient, stiffness)
        slope = float(gradient @ step)
        length = 1.0
        for _ in range(self.options.halvings):
            gain = -length * slope
            trial = self.bend(nodes, length * step.reshape(nodes.shape))
            value = self.assembly.value(trial, self.controls)
            if gain > self.noise.energy:
                if value <= energy - 1e-4 * gain:
                    if self.share > 0.0 and length == 1.0:
                        trial, value = self._stride(nodes, step, trial, value)
                    return trial, value, self.assembly.gradient(trial, self.controls)
            elif value <= energy + 10 * self.noise.energy:
                after = self.assembly.gradient(trial, self.controls)
                if abs(after @ step) <= 0.9 * abs(slope):
                    return trial, value, after
            length *= 0.5
        return None

    def bend(self, nodes: Nodes, step: Nodes) -> Nodes:
        """Where a step leads, along arcs if that is known."""
        return nodes + step if self.warp is None else self.warp(nodes, step)

    def _chord(
        self, nodes: Nodes, energy: float, gradient: Vector, last: Stiffness
    ) -> tuple[Nodes, float, Vector] | None:
        """One more step with the factors of the last one; None if it does not pay."""
        trial = self.bend(nodes, -last.solve(gradient).reshape(nodes.shape))
        value = self.assembly.value(trial, self.controls)
        if not value <= energy + 10 * self.noise.energy:
            return None
        after = self.assembly.gradient(trial, self.controls)
        return (trial, value, after) if np.abs(after).max() < _PAYS * np.abs(gradient).max() else None

    def _step(self, nodes: Nodes, gradient: Vector, stiffness: Stiffness) -> Vector:
        """Newton's step; where the body alone is stable it knows that a cable can go slack on the way, or taut."""
        if self.cables is not None and stiffness.body_definite and stiffness.columns.size:
            stretches = self.cables.stretches(nodes, self.controls)
            pulled = stiffness.columns @ self.cables.law.tension(stretches)
            free = -stiffness.solve_body(gradient - pulled)
            tensions = settle(self.cables.law, stretches + stiffness.columns.T @ free, stiffness.compliance)
            if tensions is not None:
                return free - stiffness.moves @ tensions
        return -stiffness.solve(gradient)

    def _stride(self, nodes: Nodes, step: Vector, trial: Nodes, value: float) -> tuple[Nodes, float]:
        """A lifted Hessian is too stiff, so its step is too short: doubled as long as the energy falls."""
        length = 2.0
        while True:
            longer = self.bend(nodes, length * step.reshape(nodes.shape))
            lower = self.assembly.value(longer, self.controls)
            if not lower < value:
                return trial, value
            trial, value = longer, lower
            length *= 2.0

    def _leave_saddle(self, nodes: Nodes, energy: float, stiffness: Stiffness) -> tuple[Nodes, float, Vector] | None:
        """A place of lower energy along a falling mode; None at a minimum, or where none is found."""
        if stiffness.definite or stiffness.singular or self.saddles == _SADDLES:
            return None
        try:
            mode = _falling_mode(stiffness, nodes.size).reshape(nodes.shape)
        except ArpackNoConvergence:
            return None
        size = float(np.ptp(nodes, axis=0).max())
        trials = [self.bend(nodes, leap * size * mode) for leap in _LEAPS]
        values = [self.assembly.value(trial, self.controls) for trial in trials]
        least = int(np.argmin(values))
        if not values[least] < energy - 10 * self.noise.energy:
            return None
        self.saddles += 1
        return trials[least], values[least], self.assembly.gradient(trials[least], self.controls)

    def _result(
        self,
        nodes: Nodes,
        reason: Reason,
        residual: float,
        allowed: float,
        energy: float,
        iterations: int,
        stiffness: Stiffness | None,
    ) -> NewtonResult:
        return NewtonResult(
            nodes=nodes,
            reason=reason,
            residual=residual,
            allowed=allowed,
            energy=energy,
            iterations=iterations,
            stable=stiffness is not None and stiffness.definite,
            buckled=self.saddles > 0,
            stiffness=stiffness,
        )


def _falling_mode(stiffness: Stiffness, size: int) -> Vector:
    """A mode of negative curvature, largest entry 1: that of the most negative eigenvalue of H^-1, by Lanczos."""
    inverse = LinearOperator((size, size), matvec=stiffness.solve, dtype=float)
    start = np.random.default_rng(0).standard_normal(size)
    mode = eigsh(inverse, k=1, which="SA", v0=start, tol=1e-3)[1][:, 0]
    return mode / np.abs(mode).max()


_NEAR = 1e-5
"""With less than this share of the largest applied force left over, the factors of the last step may serve again."""

_PAYS = 0.1
"""A step with old factors has to bring the residual down this far, or new ones are made."""

_LEAST_SHARE = 1 / 32
"""Below this share of what is negative, try the full Hessian."""

_SHIFTS = tuple(np.logspace(-10, 1, 12))
"""What is added to the diagonal of the projected Hessian, if even that is singular: fractions of its largest entry."""

_SADDLES = 3
"""So many saddles are left in one solve."""

_LEAPS = tuple(sign * leap for leap in (0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-4, 1e-5) for sign in (1.0, -1.0))
"""How far to go from a saddle: fractions of the size of the body; the lowest place is taken."""
