"""Newton's method with a safeguarded step: the statics solver."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from itertools import count

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics.assembly import Assembly
from hydrostat.mechanics.factorisation import Factorisation


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
    """

    nodes: Nodes
    reason: Reason
    residual: float
    allowed: float
    energy: float
    iterations: int
    stable: bool

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
) -> NewtonResult:
    """Nodes of least energy near `start` at fixed controls (R15, R17, R19).

    The full Hessian is used wherever it is positive definite, mixed with the projected one elsewhere (E6). The step is
    halved until no element is inverted and the energy falls.

    Args:
        assembly: the energy.
        start: positions to begin at [m].
        controls: contractions [m] or tensions [N].
        force_scale: largest applied force [N] at given nodes; `options.tolerance` is relative to it.
        round_off: forces and energies too small to be told apart.
        options: tolerance and limits.
    """
    nodes = start
    energy = assembly.value(nodes, controls)
    if not np.isfinite(energy):
        return NewtonResult(
            nodes=start,
            reason=Reason.BAD_START,
            residual=np.inf,
            allowed=0.0,
            energy=np.inf,
            iterations=0,
            stable=False,
        )
    gradient = assembly.gradient(nodes, controls)
    for iteration in count():
        allowed = max(options.tolerance * force_scale(nodes), round_off.force)
        residual = float(np.abs(gradient).max())
        factor = Factorisation(assembly.hessian(nodes, controls))
        if residual <= allowed:
            reason = Reason.CONVERGED
        elif iteration == options.iterations:
            reason = Reason.ITERATION_LIMIT
        else:
            step = _descent(assembly, nodes, controls, gradient, factor)
            found = None
            if step is not None:
                found = _line_search(assembly, nodes, controls, energy, gradient, step, round_off.energy, options)
            if found is not None:
                nodes, energy, gradient = found
                continue
            reason = Reason.NO_DESCENT
        return NewtonResult(
            nodes=nodes,
            reason=reason,
            residual=residual,
            allowed=allowed,
            energy=energy,
            iterations=iteration,
            stable=factor.definite,
        )
    raise AssertionError("count() never ends")


def _descent(
    assembly: Assembly, nodes: Nodes, controls: Vector, gradient: Vector, factor: Factorisation
) -> Vector | None:
    """Newton's direction, with a definite matrix in place of a Hessian that is not.

    Near a buckling load the full Hessian is indefinite by a hair only. There the projected one is far too stiff: it
    drops the whole effect of compression, and Newton creeps for hundreds of steps. So as little of it as needed is
    mixed in. None where nothing makes it definite: it is not finite, or 0.
    """
    if factor.definite:
        return -factor.solve(gradient)
    full, projected = (assembly.hessian(nodes, controls, project=project) for project in (False, True))
    for share in _SHARES:
        factor = Factorisation(full + share * (projected - full))
        if factor.definite:
            return -factor.solve(gradient)
    diagonal = projected.diagonal()
    for shift in _SHIFTS:
        projected.setdiag(diagonal + shift * diagonal.max())
        factor = Factorisation(projected)
        if factor.definite:
            return -factor.solve(gradient)
    return None


_SHARES = (1 / 16, 1 / 4, 1.0)
"""Parts of the projected Hessian to try."""

_SHIFTS = tuple(np.logspace(-10, 1, 12))
"""What is added to the diagonal of the projected Hessian, if even that is singular: fractions of its largest entry."""


def _line_search(
    assembly: Assembly,
    nodes: Nodes,
    controls: Vector,
    energy: float,
    gradient: Vector,
    step: Vector,
    noise: float,
    options: NewtonOptions,
) -> tuple[Nodes, float, Vector] | None:
    """Next nodes, energy and gradient; None if no length of the step lowers the energy.

    Near the end the energy falls by less than its own noise; then the slope along the step must fall instead.
    """
    slope = float(gradient @ step)
    length = 1.0
    for _ in range(options.halvings):
        trial = nodes + length * step.reshape(nodes.shape)
        value = assembly.value(trial, controls)
        if -length * slope > noise:
            if value <= energy + 1e-4 * length * slope:
                return trial, value, assembly.gradient(trial, controls)
        elif value <= energy + 10 * noise:
            after = assembly.gradient(trial, controls)
            if abs(after @ step) <= 0.9 * abs(slope):
                return trial, value, after
        length *= 0.5
    return None
