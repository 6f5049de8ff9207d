"""`hydrostat check`."""

from typing import TYPE_CHECKING

from hydrostat.cli.folders import RobotFolder
from hydrostat.cli.waiting import read_robot

if TYPE_CHECKING:
    from hydrostat.robot import Body


def check(robot: RobotFolder) -> None:
    """Say what is wrong with a robot and what is risky.

    Example: hydrostat check examples/starfish
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
    risks = find_risks(found)
    for risk in risks:
        print(f"risky: {risk}")
    print("Nothing is wrong." if not risks else f"Nothing is wrong, {len(risks)} risky.")


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
