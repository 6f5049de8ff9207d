"""`hydrostat check`."""

from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import RobotFolder
from hydrostat.cli.waiting import read_robot
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.robot import Body, Robot


def check(
    robot: RobotFolder,
    filled: Annotated[
        bool,
        typer.Option("--filled", help="Also play its poses on the filled body, cables on the front or on both faces."),
    ] = False,
) -> None:
    """Say what is wrong with a robot and what is risky.

    Example: hydrostat check examples/starfish --filled
    """
    from hydrostat.robot import find_risks
    from hydrostat.units import counted

    found = read_robot(robot)
    mesh = found.body.mesh
    kind = "triangles" if mesh.dim == 2 else "tetrahedra"
    print(f"{found.name}: {1e3 * mesh.size:.0f} mm, {len(mesh.nodes)} nodes, {len(mesh.elements)} {kind}")
    for line in _body_lines(found.body):
        print(line)
    parts = {"pin": found.pins, "winch": found.winches, "cable": found.cables, "marker": found.markers}
    counts = ", ".join(counted(len(entries), noun) for noun, entries in parts.items())
    print(f"{counts}, poses: {', '.join(found.poses) or 'none'}")
    if filled:
        _print_filled(found)
    risks = find_risks(found)
    for risk in risks:
        print(f"risky: {risk}")
    print("Nothing is wrong." if not risks else f"Nothing is wrong, {len(risks)} risky.")


def _print_filled(robot: "Robot") -> None:
    """How far a flat robot comes out of its plane once it is filled, by face."""
    from hydrostat.ik import solve_ik
    from hydrostat.robot import Face
    from hydrostat.simulation import Simulation, filled_motion

    if robot.body.outline is None:
        raise InputError("--filled is for flat robots with a drawing; leave it out")
    if not robot.poses or not robot.cables:
        raise InputError("--filled plays the poses of a robot by its cables; it needs at least one of each")
    simulation = Simulation(robot)
    pulled = [solve_ik(simulation, pose).pose.contractions for pose in robot.poses.values()]
    print("Filled, with the commands of the flat model (mm, the most of all markers and poses):")
    for face in Face:
        found = filled_motion(robot, pulled, face)
        print(
            f"  cables {_WHERE[face]:<18} {1e3 * found.out:5.1f} out of the plane, {1e3 * found.aside:5.1f} aside of "
            f"the flat model, which moves {1e3 * found.moved:.1f}"
        )


_WHERE = {"front": "on the front", "back": "on the back", "pairs": "on both faces", "middle": "in the middle"}


def _body_lines(body: "Body") -> list[str]:
    """Material with mass and volume; thickness of nine tenths of the body, and the worst angle of its mesh."""
    from hydrostat.geometry import dihedral_angles, smallest_angle

    mesh, material = body.mesh, body.material
    volume = float(mesh.volumes.sum()) * (body.thickness or 1.0)
    thickness = body.measured_thickness
    (thin, few), (thick, many) = thickness.part(0.05), thickness.part(0.95)
    if mesh.dim == 2:
        angle = f"smallest angle {smallest_angle(mesh):.0f} degrees"
    else:
        angle = f"smallest angle between faces {dihedral_angles(mesh.nodes, mesh.elements).min():.2g} degrees"
    name = material.name or "material by its numbers"
    return [
        f"{name}: {1e3 * volume * material.density:.3g} g, {1e6 * volume:.3g} cm^3",
        f"{1e3 * thin:.0f} to {1e3 * thick:.0f} mm across, that is {few:.1f} to {many:.0f} elements; {angle}",
    ]
