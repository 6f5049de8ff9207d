"""`RobotShape`, `Dot`, `Strand`, `Ghost`, `Cloud`, `Area`: where the body is, and all that is shown beside it."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.robot import Point, Robot


@dataclass(frozen=True, kw_only=True, eq=False)
class RobotShape:
    """A robot as it is shown.

    Attributes:
        nodes: positions [m].
        tensions: of each cable [N].
        contractions: of each winch [m].
        errors: distance of each held marker from its target [m].
        notes: what to mind, a line each: limits that hold, why a solver stopped.
    """

    nodes: Nodes
    tensions: Vector
    contractions: Vector
    errors: dict[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def rest_shape(robot: Robot) -> RobotShape:
    """A robot as it was drawn."""
    return RobotShape(
        nodes=robot.body.mesh.nodes,
        tensions=np.zeros(len(robot.cables)),
        contractions=np.zeros(len(robot.winches)),
    )


class Look(StrEnum):
    """Sign that a dot is drawn as."""

    WINCH = "winch"
    MARKER = "marker"
    TARGET = "target"
    PIN = "pin"
    VIA = "via"
    STOPPER = "stopper"
    HANDLE = "handle"


class Stroke(StrEnum):
    """Style of a line; a cable becomes thicker and takes the colour of its tension with its load."""

    CABLE = "cable"
    SHEATH = "sheath"
    MISS = "miss"
    RIM = "rim"
    PATH = "path"


@dataclass(frozen=True, kw_only=True)
class Dot:
    """A small sign of the same size at every distance.

    Attributes:
        key: what a click on it names, such as "winch:left"; "": it cannot be picked.
        at: a place in the rest shape if it is stuck to the body, else in the world [m].
        look: how it is drawn.
        colour: such as "#0b5fa5".
        label: written beside it; "" for nothing.
        stuck: whether it moves with the body.
        chosen: whether it is selected.
        radius: in metres, for pins that reach so far; 0: just the sign.
    """

    key: str = ""
    at: Point
    look: Look
    colour: str
    label: str = ""
    stuck: bool = True
    chosen: bool = False
    radius: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Strand:
    """A line through some points.

    Attributes:
        key: what a click on it names, such as "cable:0"; "": it cannot be picked.
        points: in the rest shape where stuck to the body, else in the world [m].
        stroke: how it is drawn.
        colour: such as "#0b5fa5".
        loose: how many points at its beginning are not stuck to the body; -1: none is.
        load: tension as a share of the largest on the scale, 0 to 1.
        chosen: whether it is selected.
    """

    key: str = ""
    points: tuple[Point, ...]
    stroke: Stroke
    colour: str
    loose: int = 0
    load: float = 0.0
    chosen: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Ghost:
    """The body in another shape, faintly.

    Attributes:
        name: one of each name is shown; such as "rest" or "target".
        nodes: of that shape [m].
        colour: such as "#b4afbc".
    """

    name: str
    nodes: Nodes
    colour: str


@dataclass(frozen=True, kw_only=True, eq=False)
class Cloud:
    """Many small points in the world, such as all that a marker can reach.

    Attributes:
        name: one of each name is shown.
        points: [m].
        colour: such as "#0b5fa5".
    """

    name: str
    points: Points
    colour: str


@dataclass(frozen=True, kw_only=True)
class Area:
    """A part of the rest shape: a disc or ball, or a polygon in the plane.

    Attributes:
        key: what a click on it names, such as "zone:0".
        colour: such as "#c8243f".
        at: middle of the disc or ball [m].
        radius: of it [m].
        outline: corners of the polygon [m], if it is one.
        label: written in it.
        chosen: whether it is selected.
    """

    key: str = ""
    colour: str
    at: Point = ()
    radius: float = 0.0
    outline: tuple[Point, ...] = ()
    label: str = ""
    chosen: bool = False


Thing = Dot | Strand | Ghost | Cloud | Area
