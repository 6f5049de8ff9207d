"""`find_history_equilibrium`: an energy minimum consistent with the quantities held fixed, such as friction limits."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics import Assembly, NewtonResult, Reason, Stiffness

Relax = Callable[[Assembly, Nodes, Stiffness | None], NewtonResult]
"""Minimizes the sum of energies from nodes [m], with the Hessian there if it is known."""


def find_history_equilibrium(
    assembly: Assembly, start: tuple[Nodes, Stiffness | None], controls: Vector, relax: Relax, floor: float
) -> tuple[Assembly, NewtonResult]:
    """Minimize and correct the quantities held fixed, such as friction limits, until both agree (E14).

    Without energies that have a history this is one minimization.

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
    while True:
        result = relax(assembly, nodes, stiffness)
        nodes, stiffness, iterations = result.nodes, result.stiffness, iterations + result.iterations
        assembly = assembly.with_active_terms(nodes)
        allowed = max(tolerance * assembly.largest_force(nodes, controls), floor)
        missed = assembly.history_residual(nodes, controls)
        if not result.converged or missed <= allowed:
            break
        if missed < falls * least:
            least, last = missed, corrections
        if corrections == min(_CORRECTIONS, last + assembly.patience):
            result = replace(result, reason=Reason.NO_BALANCE)
            break
        sharp = corrections < newton and stiffness is not None and not stiffness.singular
        assembly = assembly.with_corrected_history(nodes, controls, stiffness if sharp else None)
        corrections += 1
    return assembly, replace(result, iterations=iterations)


_CORRECTIONS = 40
