"""`response`: displacement of the nodes under small forces at an equilibrium."""

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics import Assembly, Stiffness

_REFINEMENTS = 4
"""Most steps of iterative refinement with factors of a state close by."""


def response(
    assembly: Assembly,
    stiffness: Stiffness,
    state: tuple[Nodes, Vector],
    forces: Float[np.ndarray, "dofs columns"],
) -> Float[np.ndarray, "dofs columns"]:
    """Solution u [m] of H u = f, by the full Hessian at `state`, to rounding.

    Args:
        assembly: the energies that count there.
        stiffness: the Hessian there, or at a state close by.
        state: nodes [m] and contractions [m].
        forces: force on every degree of freedom [N], a column for each load case.
    """
    body, springs = assembly.hessian(*state), assembly.coupling(*state)
    allowed = 1e-11 * np.abs(forces).max(axis=0, initial=0.0)
    rounding = 1e-15 * np.abs(body.data).max(initial=0.0)
    moves = stiffness.solve(forces)
    for _ in range(_REFINEMENTS):
        missing = forces - body @ moves - springs.columns @ (springs.weights @ (springs.columns.T @ moves))
        hidden = rounding * np.abs(moves).max(axis=0, initial=0.0)
        if (np.abs(missing).max(axis=0, initial=0.0) <= allowed + hidden).all():
            return moves
        moves += stiffness.solve(missing)
    return assembly.stiffness(*state).solve(forces)
