"""`make_load_energies`, `driven_loads`: energies of the forces, pressures and moments on a robot; `hung_masses`."""

import numpy as np

from hydrostat.arrays import Float, Nodes
from hydrostat.geometry import locate
from hydrostat.mechanics import DrivenLoadEnergy, Energy, LoadEnergy, MomentEnergy, PressureEnergy
from hydrostat.robot import Load, Robot


def make_load_energies(robot: Robot, rest: Nodes) -> tuple[list[Energy], dict[int, Load]]:
    """Energies of all loads but driven ones, weights of hung masses too, on unknowns that are at `rest` [m].

    Returns:
        The energies, and the load of each that varies along a path, by its index among them.
    """
    still = [not load.path and load.drive is None for load in robot.loads]
    energies: list[Energy] = [_pull(robot, rest, still)] if robot.loads else []
    paths: dict[int, Load] = {}
    for index, load in enumerate(robot.loads):
        if load.path:
            paths[len(energies)] = load
        if load.drive is None and (load.path or load.pressure is not None or load.moment is not None):
            energies.append(_load_energy(robot, rest, index))
    return energies, paths


def driven_loads(robot: Robot, rest: Nodes) -> list[DrivenLoadEnergy]:
    """Energies of the loads that drives scale, whose controls follow those of the winches."""
    controls = {drive.name: number for number, drive in enumerate(robot.drives, start=len(robot.winches))}
    return [
        DrivenLoadEnergy(_load_energy(robot, rest, index), controls[load.drive])
        for index, load in enumerate(robot.loads)
        if load.drive is not None
    ]


def _load_energy(robot: Robot, rest: Nodes, index: int) -> Energy:
    """Energy of one load alone, all of it."""
    load, body = robot.loads[index], robot.body
    if load.pressure is not None:
        return PressureEnergy(rest, body.mesh.cavity(np.array(load.at)), load.pressure, body.thickness or 1.0)
    if load.moment is not None:  # on all elements that share a node with the one where it acts
        stencil = locate(body.mesh, robot.load_points()).stencils[index]
        around = np.isin(body.mesh.elements, stencil).any(axis=1)
        return MomentEnergy(rest, body.mesh.elements[around], np.array(load.moment), index=index)
    return _pull(robot, rest, [other is load for other in robot.loads])


def _pull(robot: Robot, rest: Nodes, chosen: list[bool]) -> LoadEnergy:
    """Energy of the forces of some loads."""
    anchors, forces, nodal = locate(robot.body.mesh, robot.load_points()), robot.load_forces(), np.zeros_like(rest)
    np.add.at(nodal, anchors.stencils[chosen], anchors.weights[chosen][:, :, None] * forces[chosen][:, None])
    return LoadEnergy(rest, nodal)


def hung_masses(robot: Robot) -> Float[np.ndarray, " nodes"]:
    """Mass of the loads at each node [kg]."""
    masses = np.zeros(len(robot.body.mesh.nodes))
    if robot.loads:
        anchors, hung = locate(robot.body.mesh, robot.load_points()), [load.mass or 0.0 for load in robot.loads]
        np.add.at(masses, anchors.stencils, anchors.weights * np.array(hung)[:, None])
    return masses
