"""`posture_at` and `moves_at`: what an objective sees of a solved pose, and how that changes with the contractions."""

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Nodes, Vector
from hydrostat.ik.objectives.objective import Moves, Posture
from hydrostat.simulation import Simulation, SolvedPose


def posture_at(simulation: Simulation, pose: SolvedPose) -> Posture:
    """What an objective may look at in a pose."""
    return posture_of(simulation, pose.nodes, pose.contractions)


def posture_of(simulation: Simulation, nodes: Nodes, contractions: Vector) -> Posture:
    """The same of nodes at some contractions [m]."""
    elongations = simulation.cables.elongations(nodes, contractions)
    tensions = simulation.cables.law.tension(elongations)
    return Posture(nodes=nodes, contractions=contractions, elongations=elongations, tensions=tensions)


def follows(simulation: Simulation) -> Float[np.ndarray, "cables winches"]:
    """B: what a cable takes in when its winch takes in 1 m; 0 for other winches."""
    cables, winches = simulation.cables, np.arange(len(simulation.robot.winches))
    return np.where(cables.winches[:, None] == winches, cables.ratios[:, None], 0.0)


def moves_at(simulation: Simulation, pose: SolvedPose) -> Moves:
    """Derivatives of that posture: ds/da = B + (dl/dx)^T dx/da, and dT/da = T' ds/da (R33).

    Cables that rub are not covered: their tension differs along the cable.

    Raises:
        NotConvergedError: the pose is about to snap, its Hessian is singular.
    """
    cables, nodes = simulation.cables, simulation.jacobian(pose)
    elongations = follows(simulation) + cables.columns(pose.nodes).T @ nodes.reshape(pose.nodes.size, -1)
    tangents = cables.law.tangent(cables.elongations(pose.nodes, pose.contractions))
    return Moves(nodes=nodes, elongations=elongations, tensions=tangents[:, None] * elongations)
