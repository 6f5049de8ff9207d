"""Energies and masses of reinforcements: rods in a body, sheets on its skin."""

import numpy as np

from hydrostat.arrays import Float, Nodes
from hydrostat.geometry import locate
from hydrostat.mechanics import RodEnergy, RodTwistEnergy, SheetEnergy, rod_points
from hydrostat.robot import Membrane, Plane, Robot, Rod


def make_rod_energies(robot: Robot, rod: Rod, rest: Nodes) -> tuple[RodEnergy, RodTwistEnergy | None]:
    """Energies of a rod on unknowns that are at `rest` [m]: of stretch and bending, and of twist if it resists that."""
    mesh, (axial, bending), torsion = robot.body.mesh, rod.stiffnesses, rod.torsional_stiffness
    points = rod_points(mesh, np.array(rod.points))
    bent = RodEnergy(rest, locate(mesh, points), axial_stiffness=axial, bending_stiffness=bending)
    return bent, None if torsion is None else RodTwistEnergy(rest, mesh, points, torsional_stiffness=torsion)


def make_sheet_energies(robot: Robot, sheet: Membrane, rest: Nodes) -> list[SheetEnergy]:
    """Energies of a sheet on unknowns that are at `rest` [m]: on triangles, and on the outline of a flat body."""
    body, found = robot.body, []
    triangles, edges = sheet.find_facets(body.mesh)
    given = {"lame": sheet.material.lame, "wrinkles": sheet.wrinkles}
    if len(triangles):
        layers = 1 if body.thickness is None else 2
        found.append(SheetEnergy(rest, triangles, thickness=layers * sheet.thickness, **given))
    if len(edges):
        strip = {"width": body.thickness, "is_held_across": body.plane is Plane.STRAIN}
        found.append(SheetEnergy(rest, edges, thickness=sheet.thickness, **strip, **given))
    return found


def sheet_masses(robot: Robot, sheets: list[list[SheetEnergy]]) -> Float[np.ndarray, " nodes"]:
    """Mass of the sheets at each node [kg], from the energies of each."""
    masses = np.zeros(len(robot.body.mesh.nodes))
    for sheet, energies in zip(robot.sheets, sheets, strict=True):
        for energy in energies:
            shares = sheet.material.density * energy.volumes / energy.stencils.shape[1]
            np.add.at(masses, energy.stencils, shares[:, None])
    return masses
