"""Poses that can be reached, because contractions of them are known; and the same problems for SciPy's solvers."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, TypeVar

from machine import machine as machine  # before NumPy: it sets one thread

import numpy as np  # isort: skip
from scipy.optimize import least_squares, minimize

from hydrostat.arrays import Vector
from hydrostat.given import Point
from hydrostat.ik import EquilibriumState, MarkerTarget, StateJacobian
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation

Answer = TypeVar("Answer")

REACHED = 1e-6
"""Largest error of a marker, in sizes of the body, of a pose that is reached."""


def ranges(robot: Robot) -> tuple[Vector, Vector]:
    """Least and largest contraction of each winch [m]."""
    low = np.array([-winch.release for winch in robot.winches])
    return low, np.array([winch.travel for winch in robot.winches])


def hidden_contractions(robot: Robot, count: int, seed: int) -> Iterator[Vector]:
    """Contractions drawn evenly from the whole range of every winch [m]."""
    draw, (low, high) = np.random.default_rng(seed), ranges(robot)
    return (draw.uniform(low, high) for _ in range(count))


def rests(pose: Equilibrium) -> bool:
    """Whether it is a stable equilibrium."""
    return pose.result.converged and pose.result.stable


def hidden_poses(simulation: Simulation, count: int, seed: int) -> list[Equilibrium]:
    """The poses to which hidden contractions lead from rest; those without a stable equilibrium are left out."""
    poses = (simulation.solve(drawn, strict=False) for drawn in hidden_contractions(simulation.robot, count, seed))
    return [pose for pose in poses if rests(pose)]


def places(pose: Equilibrium) -> dict[str, Point]:
    """Where all markers are [m], as targets."""
    return {name: tuple(map(float, place)) for name, place in pose.markers.items()}


def largest_error(pose: Equilibrium, targets: Mapping[str, Point]) -> float:
    """Largest distance of a marker from its target [m], measured afresh."""
    return max(float(np.linalg.norm(pose.markers[name] - target)) for name, target in targets.items())


def timed(call: Callable[[], Answer]) -> tuple[Answer, float]:
    """What a call answers, and the CPU time it takes [ms]."""
    began = time.process_time()
    found = call()
    return found, 1e3 * (time.process_time() - began)


def middle(values: Sequence[float], form: str = ".3g") -> str:
    """Median and 99th percentile."""
    return " / ".join(format(float(value), form) for value in np.percentile(values, [50, 99])) if values else "-"


class Problem:
    """A pose to reach, as functions of the contractions for SciPy's solvers.

    Contractions count as shares of their ranges. Every evaluation is a sharp equilibrium, begun at the last one. Where
    there is none the residual is a body's size in every row, so that no solver stays there.

    Attributes:
        best: the pose of the least objective seen [m^2].
        least: that objective, half the squares of residual and effort [m^2].
        solves: equilibria asked for.
    """

    def __init__(
        self,
        simulation: Simulation,
        targets: Mapping[str, Point],
        *,
        start: Equilibrium | None = None,
        effort: float = 0.0,
        stop: bool = True,
    ) -> None:
        """The problem.

        Args:
            simulation: the robot's physics.
            targets: where markers should go [m].
            start: where the first equilibrium is begun; the rest pose if left out.
            effort: error, in sizes of the body, that full travel of one winch is worth.
            stop: end a solver as soon as the pose is reached.
        """
        size = simulation.robot.body.mesh.size
        self.simulation, self.targets = simulation, dict(targets)
        self.low, self.high = ranges(simulation.robot)
        self._term = MarkerTarget(targets=self.targets).bind(simulation)
        self._effort = effort * size / self.high
        self._size, self._enough = size, REACHED * size if stop else -1.0
        self._pose, self._lost = start or simulation.rest, False
        self._shares: Vector | None = None
        self.best, self.least, self.solves = self._pose, np.inf, 0

    def objective(self, pose: Equilibrium) -> float:
        """Half the squares of residual and effort in a pose [m^2]."""
        residual = self._rows_at(pose)
        return 0.5 * float(residual @ residual)

    def least_squares(self, begin: Vector, *, differences: bool = False) -> None:
        """SciPy's trust region in its bounds ("trf"), from contractions [m]; by differences or dx/da."""
        matrix: Any = self._differences if differences else self._matrix
        shares = self._inside(begin)
        ends = {"ftol": _END, "xtol": _END, "gtol": _END, "max_nfev": _MOST}
        self._run(lambda: least_squares(self._residual, shares, matrix, bounds=(0, 1), **ends))

    def quasi_newton(self, begin: Vector) -> None:
        """SciPy's L-BFGS-B from contractions [m], on the gradient by the adjoint."""
        bounds = [(0.0, 1.0)] * len(begin)
        options = {"ftol": 0.0, "gtol": _END, "maxiter": _MOST, "maxfun": _MOST}
        shares = self._inside(begin)
        self._run(lambda: minimize(self._slope, shares, jac=True, method="L-BFGS-B", bounds=bounds, options=options))

    def _inside(self, contractions: Vector) -> Vector:
        """As shares of the ranges, a hair within their ends, as the trust region wants to begin."""
        return np.clip((contractions - self.low) / (self.high - self.low), 1e-9, 1 - 1e-9)

    def _run(self, solver: Callable[[], object]) -> None:
        with suppress(_Enough):
            solver()

    def _residual(self, shares: Vector) -> Vector:
        if self._shares is None or (shares != self._shares).any():
            self._shares = np.array(shares)
            self.solves += 1
            found = self.simulation.solve(self.low + shares * (self.high - self.low), start=self._pose, strict=False)
            self._lost = not rests(found)
            if not self._lost:
                self._pose = found
        if self._lost:
            return np.full(self._rows, self._size)
        residual = self._rows_at(self._pose)
        objective = 0.5 * float(residual @ residual)
        if objective < self.least:
            self.best, self.least = self._pose, objective
        if largest_error(self._pose, self.targets) <= self._enough:
            raise _Enough
        return residual

    @property
    def _rows(self) -> int:
        return len(self.targets) * self.simulation.robot.body.mesh.dim + len(self.low)

    def _rows_at(self, pose: Equilibrium) -> Vector:
        missed = self._term.residual(EquilibriumState.at(self.simulation, pose))
        return np.concatenate([missed, self._effort * pose.contractions])

    def _matrix(self, shares: Vector) -> np.ndarray:
        self._residual(shares)
        slopes = self._term.jacobian(
            EquilibriumState.at(self.simulation, self._pose), StateJacobian.at(self.simulation, self._pose)
        )
        return np.vstack([slopes, np.diag(self._effort)]) * (self.high - self.low)

    def _differences(self, shares: Vector) -> np.ndarray:
        """Forward differences; backward ones at the far end of a range.

        The step is the same wherever a winch stands. SciPy's own steps are relative to the shares: near 0 they are
        below the noise of an equilibrium.
        """
        first, columns = self._residual(shares).copy(), []
        for winch, share in enumerate(shares):
            beside = np.array(shares)
            beside[winch] += _STEP if share + _STEP <= 1.0 else -_STEP
            columns.append((self._residual(beside) - first) / (beside[winch] - share))
        return np.column_stack(columns)

    def _slope(self, shares: Vector) -> tuple[float, Vector]:
        """The objective in squares of the body's size, and its slope: L-BFGS-B takes the slope as its first step."""
        residual = self._residual(shares)
        if self._lost:
            return 0.5 * float(residual @ residual) / self._size**2, np.zeros_like(shares)
        anchors, rows = self.simulation.marker_anchors, residual[: -len(shares)].reshape(len(self.targets), -1)
        pulls = anchors.matrix(len(self._pose.nodes)).T @ rows
        slope = self.simulation.adjoint(self._pose, pulls).contractions + self._effort**2 * self._pose.contractions
        return 0.5 * float(residual @ residual) / self._size**2, slope * (self.high - self.low) / self._size**2


class _Enough(Exception):  # noqa: N818
    """The pose is reached."""


_END = 1e-12
"""Relative changes at which SciPy's solvers end, where they have not reached the pose before."""

_MOST = 100
"""Evaluations before a solver is stopped, not counting those for differences; SciPy's trf counts so by itself."""

_STEP = 1e-5
"""Of a finite difference, in shares of a range; by it slopes of the starfish are wrong by less than 1e-4."""
