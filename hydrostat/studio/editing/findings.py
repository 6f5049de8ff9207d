"""`Findings`: what the check says of a robot, and its counts."""

import re
from dataclasses import dataclass

from hydrostat.robot import Robot, find_risks

_NAMED = re.compile(r"\b(winch|marker)\[\d+\](?= )")
_PART = re.compile(r"\b(pin|winch|cable|marker|pose)\[(\d+)\]")


@dataclass(frozen=True, kw_only=True)
class Findings:
    """What is known of a robot without simulating it."""

    nodes: int  # of the mesh
    elements: int  # of it
    kind: str  # what the elements are
    mass: float  # of the body [kg]
    cables: int  # how many there are
    cable_length: float  # of all cables together [m]
    risks: tuple[str, ...]  # what is allowed but may disappoint, a line each


def look_over(robot: Robot) -> Findings:
    """Count and check a robot; takes a tenth of a second for a body of a thousand nodes."""
    mesh = robot.body.mesh
    return Findings(
        nodes=len(mesh.nodes),
        elements=len(mesh.elements),
        kind="triangles" if mesh.dim == 2 else "tetrahedra",
        mass=float(mesh.volumes.sum()) * (robot.body.thickness or 1.0) * robot.body.material.density,
        cables=len(robot.cables),
        cable_length=sum(cable.length for cable in robot.cables),
        risks=tuple(find_risks(robot)),
    )


def in_words(risk: str) -> str:
    """A risk with parts called as on the screen: "cable 1" for "cable[0]", "winch left" for "winch[0] left"."""
    return _PART.sub(lambda match: f"{match[1]} {int(match[2]) + 1}", _NAMED.sub(r"\1", risk))
