"""`find_history_equilibrium`: an energy minimum consistent with the quantities held fixed, such as friction limits."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics import Assembly, FactorizedHessian, NewtonResult, NewtonStatus

Relax = Callable[[Assembly, Nodes, FactorizedHessian | None, float], NewtonResult]
"""Minimizes the sum of energies from nodes [m], with the Hessian there if it is known, to a tolerance if that is looser
than its own: a share of the largest applied force."""


def find_history_equilibrium(
    assembly: Assembly, start: tuple[Nodes, FactorizedHessian | None], controls: Vector, relax: Relax, floor: float
) -> tuple[Assembly, NewtonResult]:
    """Minimize and correct the quantities held fixed, such as friction limits, until both agree (E14).

    Minimizations on the way are as sharp as the imbalance left after the next correction asks for. Without energies
    that have a history this is one minimization.

    Args:
        assembly: the sum, with a first guess of what is held fixed.
        start: initial positions [m], and the Hessian there if it is known.
        controls: contractions [m].
        relax: function that minimizes the energy.
        floor: force that rounding hides [N].

    Returns:
        The sum as corrected, and how the last minimization ended; its iterations are of all.
    """
    nodes, stiffness = start
    iterations = corrections = last = 0
    least = np.inf
    tolerance = 1e-8  # Forces in balance to this share of the largest one are right
    newton = 12  # Most corrections of one minimum, and how many of these by Newton's method
    # A correction counts as progress if it leaves less than this share of the least imbalance before
    falls = 0.5
    # Tolerance of the first minimization, and of others as a share of the imbalance that a correction may leave
    loose, sharpness = 1e-3 if assembly.has_history else 0.0, 0.1
    before, quick, slow, least_loose, tiny = np.inf, 0.1, 0.2, 1e-9, np.finfo(float).tiny
    # Iterations for each correction that patience allows, after which an imbalance above this share is given up
    most, far = 20, 1e-2
    while True:
        result = relax(assembly, nodes, stiffness, loose)
        nodes, stiffness, iterations = result.nodes, result.stiffness, iterations + result.iterations
        assembly = assembly.with_active_terms(nodes)
        largest = assembly.largest_force(nodes, controls)
        allowed = max(tolerance * largest, floor)
        missed = assembly.history_residual(nodes, controls)
        if not result.converged or (missed <= allowed and not loose):
            break
        left = min(missed / before, 1.0) if corrections else quick
        before, loose = max(missed, tiny), sharpness * left**2 * missed / max(largest, floor, tiny)
        loose = loose if loose > least_loose and missed > allowed else 0.0
        if missed < falls * least:
            least, last = missed, corrections
        hopeless = missed > far * largest and iterations > most * assembly.max_stalled_corrections
        if hopeless or corrections == min(_CORRECTIONS, last + assembly.max_stalled_corrections):
            result = replace(result, status=NewtonStatus.NO_BALANCE)
            break
        if left > slow and stiffness is not None:  # factors of a place nearby no longer serve
            stiffness = assembly.stiffness(nodes, controls)
        sharp = corrections < newton and stiffness is not None and not stiffness.singular
        assembly = assembly.with_corrected_history(nodes, controls, stiffness if sharp else None)
        corrections += 1
    return assembly, replace(result, iterations=iterations)


_CORRECTIONS = 40
