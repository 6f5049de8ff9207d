"""`make_load_energies`: energies of the forces, pressures and moments on a robot; `hung_masses`."""

import numpy as np

from hydrostat.arrays import Float, Nodes
from hydrostat.geometry import locate
from hydrostat.mechanics import Energy, LoadEnergy, MomentEnergy, PressureEnergy
from hydrostat.robot import Robot


def make_load_energies(robot: Robot, rest: Nodes) -> list[Energy]:
    """Energies of all loads, weights of hung masses too, on unknowns that are at `rest` [m]."""
    if not robot.loads:
        return []
    body = robot.body
    forces, anchors = np.zeros_like(rest), locate(body.mesh, robot.load_points())
    np.add.at(forces, anchors.stencils, anchors.weights[:, :, None] * robot.load_forces()[:, None])
    energies: list[Energy] = [LoadEnergy(rest, forces)]
    for load in robot.loads:
        if load.pressure is not None:
            facets = body.mesh.cavity(np.array(load.at))
            energies.append(PressureEnergy(rest, facets, load.pressure, body.thickness or 1.0))
    for index, load in enumerate(robot.loads):
        if load.moment is not None:  # on all elements that share a node with the one where it acts
            around = np.isin(body.mesh.elements, anchors.stencils[index]).any(axis=1)
            energies.append(MomentEnergy(rest, body.mesh.elements[around], np.array(load.moment), index=index))
    return energies


def hung_masses(robot: Robot) -> Float[np.ndarray, " nodes"]:
    """Mass of the loads at each node [kg]."""
    masses = np.zeros(len(robot.body.mesh.nodes))
    if robot.loads:
        anchors, hung = locate(robot.body.mesh, robot.load_points()), [load.mass or 0.0 for load in robot.loads]
        np.add.at(masses, anchors.stencils, anchors.weights * np.array(hung)[:, None])
    return masses
