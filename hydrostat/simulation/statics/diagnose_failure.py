"""`diagnose_failure`: explanation of a solve that found no equilibrium."""

from collections.abc import Sequence

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.errors import NotConvergedError
from hydrostat.mechanics import CableEnergy, NewtonResult
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
    if now[flat] < _FLAT * before[flat]:
        place = mesh.nodes[mesh.elements[flat]].mean(axis=0)
        told.append(f"element {flat}, {_at(place)} at rest, compressed to {now[flat] / before[flat]:.2g} of its volume")
    if not told:
        node = int(np.argmax(np.abs(forces).max(axis=1)))
        told.append(f"largest residual force at node {node}, {_at(mesh.nodes[node])} at rest")
    return tuple(told)


def not_converged(result: NewtonResult, reasons: Sequence[str]) -> NotConvergedError:
    """Return the error of a solve that stopped early: reason, residual force and diagnosis."""
    return NotConvergedError(
        f"no equilibrium found after {result.iterations} iterations: {result.reason} (residual force "
        f"{result.residual:.2g} N, allowed {result.allowed:.2g} N); {'; '.join(reasons)}",
        result,
    )


def _at(place: Vector) -> str:
    return f"at ({', '.join(f'{1e3 * value:.4g}' for value in place)}) mm"


_FLAT = 0.2
"""An element that keeps less than this share of its volume is told."""
