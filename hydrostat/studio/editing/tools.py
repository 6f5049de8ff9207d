"""`Tool`: what the pointer does in the stage "edit", and the keys."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.drawing import Color
from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.robot import Robot
from hydrostat.studio.view.scene_items import Dot, Look, SceneItem, Strand, Stroke


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
        kind=mesh.kind,
        mass=robot.body.mass,
        cables=len(robot.cables),
        cable_length=sum(cable.length for cable in robot.cables),
    )


@dataclass(frozen=True)
class Ruler:
    """A ruler that is laid on one place, then on another."""

    points: tuple[Point, ...]  # one or two places [m]

    def to(self, at: Point) -> "Ruler":
        """The same laid on one more place; one that was full begins again there."""
        return Ruler((*self.points, at) if len(self.points) < 2 else (at,))

    @property
    def words(self) -> str:
        """The straight distance and its parts, such as "50.0 mm (x 30.0, y 40.0)"; "" for one place."""
        if len(self.points) < 2:
            return ""
        ways = 1e3 * np.abs(np.subtract(self.points[1], self.points[0]))
        parts = ", ".join(f"{axis} {way:.1f}" for axis, way in zip("xyz", ways, strict=False))
        return f"{np.linalg.norm(ways):.1f} mm ({parts})"

    def scene_items(self) -> list[SceneItem]:
        """The line, and its ends."""
        label = self.words.partition(" (")[0]
        dots: list[SceneItem] = [
            Dot(
                at=point,
                look=Look.VIA,
                color=Color.INK,
                label=label if number else "",
                chosen=bool(number),
                stuck=False,
            )
            for number, point in enumerate(self.points)
        ]
        if len(self.points) < 2:
            return dots
        return [Strand(points=self.points, stroke=Stroke.PATH, color=Color.INK, loose=-1), *dots]


def lay_ruler(ruler: Ruler | None, at: Point | None) -> Ruler:
    """Lay a ruler on one more place [m] (InputError: None, as neither part nor body is there)."""
    if at is None:
        raise InputError("click a part or the body to measure from there")
    return Ruler((at,)) if ruler is None else ruler.to(at)


class Tool(StrEnum):
    """The tools."""

    MOVE = "move"
    PIN = "pin"
    MARKER = "marker"
    WINCH = "winch"
    CABLE = "cable"
    PART = "part"
    RULER = "ruler"


KEYS = {  # the key of each tool
    "v": Tool.MOVE, "p": Tool.PIN, "m": Tool.MARKER, "w": Tool.WINCH, "c": Tool.CABLE, "b": Tool.PART, "d": Tool.RULER,
}  # fmt: skip
