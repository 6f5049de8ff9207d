"""`make_load_energies`: energies of the forces, pressures and moments on a robot; `hung_masses`."""

import numpy as np

from hydrostat.arrays import Float, Nodes
from hydrostat.geometry import locate
from hydrostat.mechanics import Energy, LoadEnergy, MomentEnergy, PressureEnergy
from hydrostat.robot import Load, Robot


def make_load_energies(robot: Robot, rest: Nodes) -> tuple[list[Energy], dict[int, Load]]:
    """Energies of all loads, weights of hung masses too, on unknowns that are at `rest` [m].

    Returns:
        The energies, and the load of each that varies along a path, by its index among them.
    """
    if not robot.loads:
        return [], {}
    body = robot.body
    anchors, forces = locate(body.mesh, robot.load_points()), robot.load_forces()

    def pull(chosen: list[bool]) -> LoadEnergy:
        nodal = np.zeros_like(rest)
        np.add.at(nodal, anchors.stencils[chosen], anchors.weights[chosen][:, :, None] * forces[chosen][:, None])
        return LoadEnergy(rest, nodal)

    energies: list[Energy] = [pull([not load.path for load in robot.loads])]
    paths: dict[int, Load] = {}
    for index, load in enumerate(robot.loads):
        if load.path:
            paths[len(energies)] = load
        if load.pressure is not None:
            facets = body.mesh.cavity(np.array(load.at))
            energies.append(PressureEnergy(rest, facets, load.pressure, body.thickness or 1.0))
        elif load.moment is not None:  # on all elements that share a node with the one where it acts
            around = np.isin(body.mesh.elements, anchors.stencils[index]).any(axis=1)
            energies.append(MomentEnergy(rest, body.mesh.elements[around], np.array(load.moment), index=index))
        elif load.path:
            energies.append(pull([other is load for other in robot.loads]))
    return energies, paths


def hung_masses(robot: Robot) -> Float[np.ndarray, " nodes"]:
    """Mass of the loads at each node [kg]."""
    masses = np.zeros(len(robot.body.mesh.nodes))
    if robot.loads:
        anchors, hung = locate(robot.body.mesh, robot.load_points()), [load.mass or 0.0 for load in robot.loads]
        np.add.at(masses, anchors.stencils, anchors.weights * np.array(hung)[:, None])
    return masses
