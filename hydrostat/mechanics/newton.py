"""Projected Newton with a line search: the statics solver."""

import time
from functools import partial
from itertools import count
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics.assembly import Assembly
from hydrostat.mechanics.factorized_hessian import FactorizedHessian, find_negative_curvature
from hydrostat.mechanics.newton_options import RULES, NewtonOptions
from hydrostat.mechanics.newton_result import NewtonResult, NewtonStatus, RoundOff
from hydrostat.mechanics.projection import Projection
from hydrostat.mechanics.sliding_step import StepTrial, find_sliding_step
from hydrostat.mechanics.warp import StepMap


def minimize(
    assembly: Assembly,
    start: Nodes,
    controls: Vector,
    *,
    round_off: RoundOff,
    options: NewtonOptions,
    warp: StepMap | None = None,
    stiffness: FactorizedHessian | None = None,
    exact: bool = False,
) -> NewtonResult:
    """Projected Newton: nodes of least energy near `start` at fixed controls (R15, R17, R19).

    The full Hessian is used wherever it is positive definite, mixed with the projected one elsewhere (E6). The
    step follows arcs and knows that a cable can go slack; it goes no further than all energies admit, and is halved
    until no element is inverted or crushed and the energy falls. A saddle is left along a mode in which the energy
    falls. Forces count as balanced relative to the largest one that an energy applies.

    Args:
        assembly: the energy.
        start: positions to begin at [m].
        controls: contractions [m] or tensions [N].
        round_off: forces and energies too small to be told apart.
        options: tolerance and limits.
        warp: bends steps along arcs; only straight ones without it.
        stiffness: the Hessian at `start` at other controls, such as those at which it is in equilibrium. The first step
            then costs no factorization: it is the prediction dx/da, bent along arcs.
        exact: True if `stiffness` is that of `start` up to rounding; then it may serve as the Hessian at an end nearby.
    """
    return _EnergyDescent(assembly, controls, round_off, options, warp, exact).run(start, stiffness)


class _Iterate(NamedTuple):
    """Current point of the iteration, with the energies that are active there."""

    assembly: Assembly
    nodes: Nodes
    energy: float
    gradient: Vector
    min_volume_ratio: float = 1.0


class _EnergyDescent:
    """One minimization; `run` is the loop, each method one part of it.

    Attributes:
        projection: shares of the negative part of the Hessian that the last step removed.
        whole: True if the step must be taken whole or not at all.
        left: residual as a share of the largest applied force.
        fast: True if the last step reduced the residual strongly.
        saddles: number of saddles left so far.
        is_first: True until a Hessian is factorized.
        last: Hessian of the last step, if nothing was removed from it.
        sharp: True if that step began close enough to the end that `last` serves as the Hessian there.
        error: estimated distance of the last iterate from equilibrium [m].
    """

    def __init__(
        self,
        assembly: Assembly,
        controls: Vector,
        round_off: RoundOff,
        options: NewtonOptions,
        warp: StepMap | None,
        exact: bool,
    ) -> None:
        self.exact = exact
        self.assembly, self.controls = assembly, controls
        self.noise, self.options, self.warp = round_off, options, warp
        self.projection, self.damping = Projection(), 0.0
        self.whole, self.fast, self.is_first = False, False, True
        self.left = np.inf
        self.saddles = 0
        self.last: FactorizedHessian | None = None
        self.sharp = False
        self.error = np.inf

    def run(self, start: Nodes, known: FactorizedHessian | None) -> NewtonResult:
        """Newton from `start` to a reason to stop."""
        assembly = self.assembly.continuing(None if known is None else known.source).with_active_terms(start)
        energy = assembly.value(start, self.controls)
        if not np.isfinite(energy):
            place = _Iterate(assembly, start, energy, np.full(start.size, np.inf))
            return self._result(place, NewtonStatus.BAD_START, 0.0, 0)
        place = self._evaluate(assembly, start, energy, assembly.min_volume_ratio(start))
        residual = np.inf
        for iteration in count():
            self.whole = self.options.whole and iteration == 0
            scale = place.assembly.largest_force(place.nodes, self.controls)
            allowed = max(self.options.tolerance * scale, self.noise.force)
            before, residual = residual, float(np.abs(place.gradient).max())
            self.fast = residual < RULES.fast_decrease * before
            if residual <= allowed:
                found, status, self.error = self._leave_saddle(place), NewtonStatus.CONVERGED, 0.0
            elif iteration == self.options.iterations:
                found, status = None, NewtonStatus.ITERATION_LIMIT
            elif self._late:
                found, status = None, NewtonStatus.TIME_LIMIT
            else:
                self.left = residual / scale if scale else np.inf
                found, status = self._advance(place, known), NewtonStatus.NO_DESCENT
            known = None
            if found is place:
                return self._result(place, NewtonStatus.CONVERGED, allowed, iteration)
            if found is None:
                return self._result(place, NewtonStatus.TIME_LIMIT if self._late else status, allowed, iteration)
            place = found
        raise AssertionError("count() never ends")

    @property
    def _late(self) -> bool:
        return time.monotonic() >= self.options.deadline

    def _evaluate(self, assembly: Assembly, nodes: Nodes, energy: float, min_volume_ratio: float) -> _Iterate:
        return _Iterate(assembly, nodes, energy, assembly.gradient(nodes, self.controls), min_volume_ratio)

    def _try(self, place: _Iterate, step: Vector, *, bent: bool = True) -> StepTrial:
        """Take a step as far as all energies admit it; the energy is infinite where an element is crushed."""
        nodes = self.bend(place.nodes, step) if bent else place.nodes + step.reshape(place.nodes.shape)
        least, floor = place.assembly.min_volume_ratio(nodes), RULES.crushed * place.min_volume_ratio
        lowest, known = place.assembly.values_before_contact(nodes, self.controls)
        if least < floor or lowest > place.energy + 10 * self.noise.energy:
            return StepTrial(place.assembly, nodes, np.inf, least, 1.0)
        share = place.assembly.largest_step(place.nodes, nodes - place.nodes)
        if share < 1.0:
            nodes, known = place.nodes + share * (nodes - place.nodes), []
            least = place.assembly.min_volume_ratio(nodes)
        assembly = place.assembly.with_active_terms(nodes)
        energy = assembly.value(nodes, self.controls, known)
        return StepTrial(assembly, nodes, energy if least >= floor else np.inf, least, share)

    def _advance(self, place: _Iterate, known: FactorizedHessian | None) -> _Iterate | None:
        """Take one step with the factors of the last one if that pays, else with `known` ones, else with new ones.

        None if there is none; the place itself if it is as near to equilibrium as was asked.
        """
        if self.last is not None and self.sharp:
            found = self._chord(place, self.last)
            if found is not None:
                return found
        reused = self._reuse(place, known)
        self.last = None  # its memory serves for new factors
        stiffness = reused or self._definite_hessian(place)
        self.last, self.sharp = (
            (stiffness, self.left < self.options.near and (reused is None or self.exact or self.options.known))
            if self._is_unmodified
            else (None, False)
        )
        if stiffness is None:
            return None
        step = self._step(place, stiffness)
        if reused is None and self._is_unmodified and self._within_accuracy(place, step):
            return place
        slid, trial = self._slide(place, step, stiffness)
        found = self._search(place, slid, trial)
        self._damp(place, slid, found, eases=slid is not step)
        return found

    @property
    def _is_unmodified(self) -> bool:
        """True if the last step was made with the Hessian itself."""
        return not self.projection.any and not self.damping

    def _slide(self, place: _Iterate, step: Vector, stiffness: FactorizedHessian) -> tuple[Vector, StepTrial]:
        """Step that slides along the parts that this one meets, with its trial; this one where it meets none."""
        trial = self._try(place, step)
        enough = place.energy + 1e-4 * trial.share * float(place.gradient @ step)
        if (
            self.whole
            or trial.energy == np.inf
            or (trial.share > RULES.long_step and trial.energy <= enough)
            or not trial.assembly.projects_first
        ):
            return step, trial
        found = find_sliding_step(partial(self._try, place), place.nodes, step, trial, stiffness)
        slope = float(place.gradient @ found.step)
        falls = found.trial.energy < place.energy + 1e-4 * found.trial.share * slope
        return found if slope < 0.0 and falls else (step, trial)

    def _damp(self, place: _Iterate, step: Vector, found: _Iterate | None, *, eases: bool) -> None:
        """Levenberg and Marquardt's damping, where parts of a body that touch cut steps short; less again where not."""
        if found is None:
            return
        square, curvature = float(step @ step), -float(place.gradient @ step) / float(step @ step)
        taken = float(np.linalg.norm(found.nodes - place.nodes)) / square**0.5
        if taken < RULES.short_step and place.assembly.projects_first and not eases:
            least = 1e-3  # Damping is chosen for steps of at least this share
            self.damping = max(RULES.damps * self.damping, curvature * (1.0 / max(taken, least) - 1.0))
        elif eases or taken > RULES.long_step:
            self.damping = self.damping / RULES.eases if self.damping > RULES.min_damping_share * curvature else 0.0

    def _within_accuracy(self, place: _Iterate, step: Vector) -> bool:
        """Return True if a step with the unmodified Hessian shows that the iterate is within the requested accuracy."""
        if self.options.accuracy is None or not self.left < RULES.linear:
            return False
        self.error = RULES.margin * float(np.sqrt((step.reshape(place.nodes.shape) ** 2).sum(axis=1).max()))
        self.sharp = self.sharp or self.error <= self.options.accuracy
        return self.error <= self.options.accuracy

    def _reuse(self, place: _Iterate, known: FactorizedHessian | None) -> FactorizedHessian | None:
        """Return a known factorization with the current springs; None if the result is not positive definite."""
        if known is None or known.singular or known.token is not self.assembly.token:
            return None
        springs = place.assembly.low_rank_hessian(place.nodes, self.controls)
        stiffness = known.with_low_rank(springs)
        return stiffness if stiffness.definite else None

    def _definite_hessian(self, place: _Iterate) -> FactorizedHessian | None:
        """Hessian, or a definite matrix in its place; None where nothing helps: it is not finite, or 0."""
        first = place.assembly.projects_first
        left, self.is_first = self.left if self.is_first else 0.0, False
        begin = Projection() if self.fast else self.projection
        self.projection = begin.with_smaller_shares(projects_first=first, left=left)
        while True:
            shares = self.projection
            stiffness = place.assembly.stiffness(
                place.nodes, self.controls, projection=shares.late, early=shares.early, damping=self.damping
            )
            if stiffness.definite:
                return stiffness
            if shares.whole:
                break
            negative = stiffness.factors.negative
            self.projection = shares.with_larger_shares(projects_first=first, negative=negative)
        for shift in _SHIFTS:
            stiffness = place.assembly.stiffness(place.nodes, self.controls, projection=1.0, shift=shift)
            if stiffness.definite:
                return stiffness
        return None

    def _search(self, place: _Iterate, step: Vector, trial: StepTrial) -> _Iterate | None:
        """Next place; None if no length of the step lowers the energy.

        Near the end the energy falls by less than its noise; then the slope must fall instead. `trial` takes all of it.
        """
        slope = float(place.gradient @ step)
        length = 1.0
        for halving in range(self.options.halvings):
            trial = self._try(place, length * step) if halving else trial
            gain = -length * trial.share * slope
            if gain > self.noise.energy:
                if self.warp is not None and not trial.energy <= place.energy - 1e-4 * gain:
                    straight = self._try(place, length * step, bent=False)
                    trial = min(trial, straight, key=lambda found: found.energy)
                if trial.energy <= place.energy - 1e-4 * gain:
                    found = self._evaluate(*trial[:4])
                    longer = self.projection.any and length * trial.share == 1.0
                    return self._extrapolate(place, step, found) if longer else found
            elif trial.energy <= place.energy + 10 * self.noise.energy:
                found = self._evaluate(*trial[:4])
                if abs(found.gradient @ step) <= 0.9 * abs(slope):
                    return found
            if self.whole or self._late:
                break
            length *= 0.5 * trial.share
        return None

    def bend(self, nodes: Nodes, step: Vector) -> Nodes:
        """Return the end point of a step, along arcs if a warp is given."""
        straight = step.reshape(nodes.shape)
        return nodes + straight if self.warp is None else self.warp(nodes, straight)

    def _chord(self, place: _Iterate, last: FactorizedHessian) -> _Iterate | None:
        """One more step with the factors of the last one; None if it does not pay."""
        trial = self._try(place, -last.solve(place.gradient))
        if not trial.energy <= place.energy + 10 * self.noise.energy:
            return None
        found = self._evaluate(*trial[:4])
        return found if np.abs(found.gradient).max() < RULES.pays * np.abs(place.gradient).max() else None

    def _step(self, place: _Iterate, stiffness: FactorizedHessian) -> Vector:
        """Newton step; if the body alone is stable, it accounts for cables that become slack or taut on the way."""
        if stiffness.body_definite and stiffness.columns.size:
            springs = stiffness.low_rank
            if springs.law is not None and springs.elongations is not None:
                pulled = stiffness.columns @ springs.law.tension(springs.elongations)
                step = stiffness.move(pulled - place.gradient, springs)
                if step is not None:
                    return step
        return -stiffness.solve(place.gradient)

    def _extrapolate(self, place: _Iterate, step: Vector, found: _Iterate) -> _Iterate:
        """Double a step while the energy falls: a projected Hessian is too stiff, so its step is too short."""
        length, before, slope = 1.0, float(place.gradient @ step), float(found.gradient @ step)
        while 3.0 * slope < before:  # slopes need no search for contact; a parabola falls so far
            longer = self._try(place, 2.0 * length * step)
            if not (longer.share == 1.0 and longer.energy < found.energy):
                break
            found, length = self._evaluate(*longer[:4]), 2.0 * length
            before, slope = slope, float(found.gradient @ step)
        return found

    def _leave_saddle(self, place: _Iterate) -> _Iterate | None:
        """Place of lower energy along a falling mode; None at a minimum, or where none is found."""
        if self.saddles == RULES.saddles or self.options.tolerance > RULES.saddle_tolerance:
            return None
        stiffness = self._stiffness(place)
        if stiffness.definite or stiffness.singular:
            return None
        mode = find_negative_curvature(stiffness, place.gradient.size)
        if mode is None:
            return None
        size = float(np.ptp(place.nodes, axis=0).max())
        trials = [self._try(place, leap * size * mode) for leap in _LEAPS]
        lowest = min(trials, key=lambda trial: trial.energy)
        if not lowest.energy < place.energy - 10 * self.noise.energy:
            return None
        self.saddles += 1
        self.last = None
        return self._evaluate(*lowest[:4])

    def _stiffness(self, place: _Iterate) -> FactorizedHessian:
        """Hessian at the end."""
        if self.last is None or not self.sharp:
            self.last, self.sharp = place.assembly.stiffness(place.nodes, self.controls), True
        return self.last

    def _result(self, place: _Iterate, status: NewtonStatus, allowed: float, iterations: int) -> NewtonResult:
        if status is not NewtonStatus.CONVERGED:
            self.last = None
        late = status in (NewtonStatus.BAD_START, NewtonStatus.TIME_LIMIT)
        blank = late or (status is NewtonStatus.NO_DESCENT and self.whole)
        stiffness = None if blank else self._stiffness(place)
        return NewtonResult(
            nodes=place.nodes,
            status=status,
            residual=float(np.abs(place.gradient).max()),
            allowed=allowed,
            energy=place.energy,
            iterations=iterations,
            stable=stiffness is not None and stiffness.definite,
            buckled=self.saddles > 0,
            stiffness=stiffness,
            error=0.0 if self.options.accuracy is None else self.error if status is NewtonStatus.CONVERGED else np.inf,
        )


_SHIFTS = tuple(np.logspace(-10, 1, 12))
"""Shifts of the diagonal if even the projected Hessian is singular: fractions of its largest entry."""


_LEAPS = tuple(sign * leap for leap in (0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-4, 1e-5) for sign in (1.0, -1.0))
"""Lengths of trial steps away from a saddle: fractions of the size of the body; the one of least energy is taken."""
