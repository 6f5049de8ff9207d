"""`StaticSolver`: equilibria of one sum of energies, by load stepping where Newton's method alone does not arrive."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.mechanics import (
    Assembly,
    CableEnergy,
    FactorizedHessian,
    NewtonOptions,
    NewtonResult,
    NewtonStatus,
    RoundOff,
    StepMap,
    minimize,
)
from hydrostat.robot import Robot


def diagnose_failure(
    robot: Robot, cables: CableEnergy, nodes: Nodes, contractions: Vector, forces: Points
) -> tuple[str, ...]:
    """Explain a failed solve: the cable with the highest tension, an almost flat element or the largest residual.

    Args:
        robot: robot of the failed solve.
        cables: its cables, as if they had no friction.
        nodes: node positions where the solve ended [m].
        contractions: contractions of the winches [m].
        forces: left over at the nodes [N].
    """
    told = []
    tensions = cables.tensions(nodes, contractions)
    if tensions.max(initial=0.0) > 0:
        cable = int(np.argmax(tensions))
        taken = (cables.compute_contractions(contractions)[cable] - cables.slack[cable]) / cables.rest_lengths[cable]
        told.append(
            f"highest tension {tensions[cable]:.3g} N in cable {robot.cables[cable].name!r}, "
            f"contracted by {100 * taken:.0f} % of its bare length"
        )
    mesh = robot.body.mesh
    now, before = (np.linalg.det(x[mesh.elements][:, 1:] - x[mesh.elements][:, :1]) for x in (nodes, mesh.nodes))
    flat = int(np.argmin(now / before))
    if now[flat] < _FLAT_VOLUME * before[flat]:
        place = mesh.nodes[mesh.elements[flat]].mean(axis=0)
        told.append(f"element {flat}, {_at(place)} at rest, compressed to {now[flat] / before[flat]:.2g} of its volume")
    if not told:
        node = int(np.argmax(np.abs(forces).max(axis=1)))
        told.append(f"largest residual force at node {node}, {_at(mesh.nodes[node])} at rest")
    return tuple(told)


def not_converged(result: NewtonResult, reasons: Sequence[str]) -> NotConvergedError:
    """Return the error of a solve that stopped early: reason, residual force and diagnosis."""
    return NotConvergedError(
        f"no equilibrium found after {result.iterations} iterations: {result.status} (residual force "
        f"{result.residual:.2g} N, allowed {result.allowed:.2g} N); {'; '.join(reasons)}",
        result,
    )


def _at(place: Vector) -> str:
    return f"at ({', '.join(f'{1e3 * value:.4g}' for value in place)}) mm"


_FLAT_VOLUME = 0.2
"""An element that keeps less than this share of its volume is told."""


@dataclass(frozen=True, eq=False)
class StaticSolver:
    """Newton's method on given physics.

    Attributes:
        assembly: sum of energies.
        options: convergence options of Newton's method.
        round_off: rounding errors of forces and energies.
        warp: map that bends steps along arcs.
    """

    assembly: Assembly
    options: NewtonOptions
    round_off: RoundOff
    warp: StepMap | None

    def relax(
        self,
        nodes: Nodes,
        controls: Vector,
        stiffness: FactorizedHessian | None = None,
        *,
        iterations: int | None = None,
        tolerance: float | None = None,
        exact: bool = False,
        whole: bool = False,
        rough: bool = False,
    ) -> NewtonResult:
        """Newton from some nodes on.

        Args:
            nodes: initial node positions [m].
            controls: contraction of each winch [m].
            stiffness: the Hessian near there, such as that of the last result; then the first step is the prediction
                dx/da and costs no factorization.
            iterations: most steps, if fewer than the options allow.
            tolerance: tolerance, if looser than that of the options.
            exact: True if `stiffness` is that of `nodes` up to rounding, and not of positions nearby.
            whole: give up immediately, at no cost, if the prediction cannot be taken whole.
            rough: let the Hessian of a place nearby serve as that of the result.
        """
        options = replace(self.options, whole=whole)
        if rough:
            options = replace(options, near=_ROUGH_RESIDUAL, known=True)
        if iterations is not None:
            options = replace(options, iterations=min(iterations, options.iterations))
        if tolerance is not None:
            options = replace(options, tolerance=max(tolerance, options.tolerance))
        return minimize(
            self.assembly,
            nodes,
            controls,
            round_off=self.round_off,
            options=options,
            warp=self.warp,
            stiffness=stiffness,
            exact=exact,
        )

    def with_timeout(self, seconds: float | None) -> "StaticSolver":
        """Return the same solver with a timeout counted from now [s]; itself if that is None."""
        if seconds is None:
            return self
        if isinstance(seconds, bool) or not isinstance(seconds, int | float | np.number) or not seconds > 0:
            raise InputError(f"seconds must be above 0, not {seconds!r:.60}")
        return self.with_deadline(time.monotonic() + seconds)

    def with_deadline(self, deadline: float) -> "StaticSolver":
        """Return the same solver with a deadline on the clock of `time.monotonic` [s], unless its own is earlier."""
        return replace(self, options=replace(self.options, deadline=min(deadline, self.options.deadline)))

    def with_accuracy(self, accuracy: float | None, size: float = np.inf) -> "StaticSolver":
        """Return the same solver with a node accuracy [m] for a body of a given size [m]; itself if None.

        Raises:
            InputError: an accuracy that is not above 0, or so rough that it is hardly in meters.
        """
        if accuracy is not None and not (isinstance(accuracy, int | float | np.number) and accuracy > 0):
            raise InputError(f"accuracy must be above 0 m, not {accuracy!r}")
        roughest = 0.1  # So far from equilibrium, in sizes of the body, no pose is of use
        if accuracy is not None and accuracy > roughest * size:
            raise InputError(
                f"accuracy, {accuracy:g} m, is too rough for a body of {size:.3g} m; it is in meters: 0.01 mm is 1e-5"
            )
        return self if accuracy is None else replace(self, options=replace(self.options, accuracy=accuracy))

    def force_tolerance(self, nodes: Nodes, controls: Vector) -> float:
        """Nodal force left over [N] at which nodes count as at rest."""
        return max(
            self.options.tolerance * self.assembly.with_active_terms(nodes).largest_force(nodes, controls),
            self.round_off.force,
        )

    def solve(
        self,
        goal: Vector,
        rest: tuple[Nodes, FactorizedHessian],
        start: tuple[Nodes, Vector, FactorizedHessian | None] | None = None,
    ) -> NewtonResult:
        """Equilibrium at `goal`: directly; else in load steps from `start`, then from rest with the dead loads.

        Where the prediction of the first step would crush an element, load steps follow without delay: cut short
        against the whole command, that step would leave cables that pull far too hard on elements next to flat.

        Args:
            goal: contraction of each winch [m].
            rest: nodes at rest [m], and the Hessian there.
            start: nodes, contractions and the Hessian, if it is known, of a pose to begin from.
        """
        begin, _, known = start or (rest[0], None, rest[1])
        pulled = bool(goal.any())  # dead loads alone pull evenly: there a step cut short does no harm
        direct_iterations = 200  # So many steps of Newton before a command is approached in load steps
        direct = result = self.relax(begin, goal, known, iterations=direct_iterations, whole=pulled)
        spent = result.iterations
        if _needs_fallback(result) and start and (start[1] != goal).any():
            result = self._in_steps(start, goal)
            spent += result.iterations
        if _needs_fallback(result):
            result = self._in_steps((rest[0], np.zeros_like(goal), rest[1]), goal, with_load=True)
            spent += result.iterations
        if not result.converged:
            result = min(self._failed_result(result, goal), direct, key=lambda found: found.energy)
            result = replace(result, status=NewtonStatus.TIME_LIMIT) if self._late else result
        return replace(result, iterations=spent)

    @property
    def _late(self) -> bool:
        return time.monotonic() >= self.options.deadline

    def _failed_result(self, result: NewtonResult, goal: Vector) -> NewtonResult:
        """Result of a failed solve, with residual and energy at `goal`."""
        assembly = self.assembly.with_active_terms(result.nodes)
        return replace(
            result,
            residual=float(np.abs(assembly.gradient(result.nodes, goal)).max()),
            allowed=self.force_tolerance(result.nodes, goal),
            energy=assembly.value(result.nodes, goal),
        )

    def _in_steps(
        self, start: tuple[Nodes, Vector, FactorizedHessian | None], goal: Vector, *, with_load: bool = False
    ) -> NewtonResult:
        """By load steps that are halved where one fails and doubled where not; the last failure if they get too small.

        A step on the way need not end sharp. With dead loads these grow with the contractions; that is the last resort,
        so where these steps get too small Newton goes on from the last of them, by patience.
        """
        nodes, begin, stiffness = start
        first_step = 0.5  # Share of a command that is tried first
        done, step, spent = 0.0, first_step, 0
        result, last = None, False
        step_iterations = 30  # So many steps of Newton for one load step
        loose = 0.1  # Residual allowed for intermediate states, as a share of the largest applied force
        most_steps = 100  # Load steps of one solve
        smallest_step = 2.0**-7  # No load step is smaller than this share of a command
        for _ in range(most_steps):
            share = min(done + step, 1.0)
            last = share == 1.0
            iterations, tolerance = (None, None) if last else (step_iterations, loose)
            controls = goal if last else begin + share * (goal - begin)
            solver = replace(self, assembly=self.assembly.with_load(share)) if with_load else self
            result = solver.relax(
                nodes, controls, stiffness, iterations=iterations, tolerance=tolerance, whole=step > _MIN_WHOLE_STEP
            )
            spent += result.iterations
            if result.converged and not last:
                nodes, stiffness, done, step = result.nodes, result.stiffness, share, 2 * step
                continue
            step *= 0.5
            if not _needs_fallback(result) or step < smallest_step:
                break
        assert result is not None
        if with_load and _needs_fallback(result):
            result, last = self.relax(nodes, goal, stiffness), True
            spent += result.iterations
        told = last or result.status is NewtonStatus.TIME_LIMIT
        return replace(result, iterations=spent, status=result.status if told else NewtonStatus.ITERATION_LIMIT)


def _needs_fallback(result: NewtonResult) -> bool:
    """Return True if another solution method should be tried."""
    return result.status not in (NewtonStatus.CONVERGED, NewtonStatus.TIME_LIMIT)


_ROUGH_RESIDUAL = 1e-2
"""Residual at which a Hessian serves as that of the result nearby, as a share of the largest applied force."""

_MIN_WHOLE_STEP = 0.05
"""Larger load steps are taken whole or not at all; smaller ones may begin with a step of Newton that is cut short."""
