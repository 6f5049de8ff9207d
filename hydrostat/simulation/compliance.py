"""`marker_compliance`: displacement of markers under small forces at a pose."""

import numpy as np

from hydrostat.arrays import Float
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.simulation import Simulation


def marker_compliance(simulation: Simulation, pose: Equilibrium) -> Float[np.ndarray, "markers dim dim"]:
    """Return the displacement of each marker under a small force on itself at an equilibrium [m/N]: dx/dF, symmetric.

    Raises:
        InputError: path-dependent physics, such as cables with friction.
        NotConvergedError: the Hessian is singular: the pose is at a snap-through.
    """
    anchors, (rows, dim) = simulation.marker_anchors, simulation.assembly.shape
    count = len(anchors.stencils)
    forces = np.zeros((rows, dim, count, dim))
    for marker, (nodes, weights) in enumerate(zip(anchors.stencils, anchors.weights, strict=True)):
        for axis in range(dim):
            np.add.at(forces[:, axis, marker, axis], nodes, weights)
    moves = simulation.response(pose, forces.reshape(rows * dim, count * dim)).reshape(forces.shape)
    return np.einsum("pc,pcipj->pij", anchors.weights, moves[anchors.stencils])
