"""`hydrostat check`."""

from hydrostat.cli.arguments import RobotFolder


def check(robot: RobotFolder) -> None:
    """Say what is wrong with a robot and what is risky.

    Example: hydrostat check examples/starfish
    """
    from hydrostat.geometry import smallest_angle
    from hydrostat.robot import find_risks, load_robot
    from hydrostat.units import counted

    found = load_robot(robot)
    mesh = found.body.mesh
    kind = "triangles" if mesh.dim == 2 else "tetrahedra"
    angle = f", smallest angle {smallest_angle(mesh):.0f} degrees" if mesh.dim == 2 else ""
    print(f"{found.name}: {1e3 * mesh.size:.0f} mm, {len(mesh.nodes)} nodes, {len(mesh.elements)} {kind}{angle}")
    parts = {"pin": found.pins, "winch": found.winches, "cable": found.cables, "marker": found.markers}
    counts = ", ".join(counted(len(entries), noun) for noun, entries in parts.items())
    print(f"{counts}, poses: {', '.join(found.poses) or 'none'}")
    risks = find_risks(found)
    for risk in risks:
        print(f"risky: {risk}")
    print("Nothing is wrong." if not risks else f"Nothing is wrong, {len(risks)} risky.")
