"""`posture_at` and `moves_at`: what an objective sees of a solved pose, and how that changes with the contractions."""

import numpy as np

from hydrostat.ik.objectives.objective import Moves, Posture
from hydrostat.simulation import Simulation, SolvedPose


def posture_at(simulation: Simulation, pose: SolvedPose) -> Posture:
    """What an objective may look at in a pose."""
    return Posture(
        nodes=pose.nodes,
        contractions=pose.contractions,
        stretches=simulation.cables.stretches(pose.nodes, pose.contractions),
        tensions=simulation.cables.tensions(pose.nodes, pose.contractions),
    )


def moves_at(simulation: Simulation, pose: SolvedPose) -> Moves:
    """Derivatives of that posture: ds/da = B + (dl/dx)^T dx/da, and dT/da = T' ds/da (R33).

    B is 1 where a cable belongs to a winch. Cables that rub are not covered: their tension differs along the cable.

    Raises:
        NotConvergedError: the pose is about to snap, its Hessian is singular.
    """
    cables, nodes = simulation.cables, simulation.jacobian(pose)
    follows = (cables.winches[:, None] == np.arange(len(pose.contractions))).astype(float)
    stretches = follows + cables.columns(pose.nodes).T @ nodes.reshape(pose.nodes.size, -1)
    tangents = cables.law.tangent(cables.stretches(pose.nodes, pose.contractions))
    return Moves(nodes=nodes, stretches=stretches, tensions=tangents[:, None] * stretches)
