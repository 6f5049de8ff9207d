"""`Findings`: counts of a robot."""

from dataclasses import dataclass

from hydrostat.robot import Robot


@dataclass(frozen=True, kw_only=True)
class Findings:
    """Counts that are known of a robot without simulating it."""

    nodes: int  # of the mesh
    elements: int  # of it
    kind: str  # what the elements are
    mass: float  # of the body [kg]
    cables: int  # how many there are
    cable_length: float  # of all cables together [m]


def look_over(robot: Robot) -> Findings:
    """Count what a robot has."""
    mesh = robot.body.mesh
    return Findings(
        nodes=len(mesh.nodes),
        elements=len(mesh.elements),
        kind="triangles" if mesh.dim == 2 else "tetrahedra",
        mass=float(mesh.volumes.sum()) * (robot.body.thickness or 1.0) * robot.body.material.density,
        cables=len(robot.cables),
        cable_length=sum(cable.length for cable in robot.cables),
    )
