"""`RobotShape`, `Prediction`, `Dot`, `Strand`, `Ghost`, `Cloud`, `Area`: where the body is, what is shown beside it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.given import Point
from hydrostat.robot import Robot
from hydrostat.simulation import ContactPatch


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """Prediction of the networks for held markers."""

    markers: Mapping[str, Point]  # where they expect each [m]
    error: float  # mean distance from the targets that they expect [m]
    uncertainty: float  # how far they disagree about it [m]
    exact: bool  # whether the shape beside it is the exact answer; else it is on its way


@dataclass(frozen=True, kw_only=True, eq=False)
class RobotShape:
    """A robot as it is shown."""

    nodes: Nodes  # positions [m]
    tensions: Vector  # of each cable [N]
    contractions: Vector  # of each winch [m]
    errors: dict[str, float] = field(default_factory=dict)  # distance of each held marker from its target [m]
    muscles: Vector | None = None  # how hard they pull around each node, 1 for the hardest; None where none move it
    touches: tuple[ContactPatch, ...] = ()  # where it touches itself and obstacles, the hardest first
    carried: Points | None = None  # where obstacles that move are, as `Equilibrium.carried` [m]; None: where they begin
    crossing: Point | None = None  # a place where it passes through itself [m]
    prediction: Prediction | None = None  # what networks say of it; None where none are asked
    notes: tuple[str, ...] = ()  # what to mind, a line each: limits that hold, why a solver stopped


def rest_shape(robot: Robot) -> RobotShape:
    """A robot as it was drawn."""
    return RobotShape(
        nodes=robot.body.mesh.nodes, tensions=np.zeros(len(robot.cables)), contractions=np.zeros(len(robot.winches))
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
    FLAG = "flag"
    TOUCH = "touch"


class Stroke(StrEnum):
    """Style of a line; a cable becomes thicker and takes the color of its tension with its load."""

    CABLE = "cable"
    SHEATH = "sheath"
    MISS = "miss"
    RIM = "rim"
    PATH = "path"
    DRAWN = "drawn"


@dataclass(frozen=True, kw_only=True)
class Dot:
    """A small sign of the same size at every distance."""

    key: str = ""  # what a click on it names, such as "winch:left"; "": it cannot be picked
    at: Point  # a place in the rest shape if it is stuck to the body, else in the world [m]
    look: Look  # how it is drawn
    color: str  # such as "#0b5fa5"
    label: str = ""  # written beside it; "" for nothing
    short: str = ""  # written in it, as W1; "": what its label begins with
    about: str = ""  # of a flag: key of the part whose words it shows while the pointer is there
    stuck: bool = True  # whether it moves with the body
    chosen: bool = False  # whether it is selected
    radius: float = 0.0  # in meters, for pins that reach so far; 0: just the sign
    faint: bool = False  # whether it is proposed only


@dataclass(frozen=True, kw_only=True)
class Strand:
    """A line through some points."""

    key: str = ""  # what a click on it names, such as "cable:0"; "": it cannot be picked
    points: tuple[Point, ...]  # in the rest shape where stuck to the body, else in the world [m]
    stroke: Stroke  # how it is drawn
    color: str  # such as "#0b5fa5"
    loose: int = 0  # how many points at its beginning are not stuck to the body; -1: none is
    load: float = 0.0  # tension as a share of the largest on the scale, 0 to 1
    chosen: bool = False  # whether it is selected
    faint: bool = False  # whether it is proposed only


@dataclass(frozen=True, kw_only=True, eq=False)
class Ghost:
    """The body in another shape, faintly."""

    name: str  # one of each name is shown; such as "rest" or "target"
    nodes: Nodes  # of that shape [m]
    color: str  # such as "#b4afbc"


@dataclass(frozen=True, kw_only=True, eq=False)
class Cloud:
    """Many small points in the world, such as all that a marker can reach."""

    name: str  # one of each name is shown
    points: Points  # [m]
    color: str  # such as "#0b5fa5"


@dataclass(frozen=True, kw_only=True)
class Area:
    """A part of the rest shape: a disc or ball, or a polygon in the plane."""

    key: str = ""  # what a click on it names, such as "zone:0"
    color: str  # such as "#c8243f"
    at: Point = ()  # middle of the disc or ball [m]
    radius: float = 0.0  # of it [m]
    outline: tuple[Point, ...] = ()  # corners of the polygon [m], if it is one
    label: str = ""  # written in it
    chosen: bool = False  # whether it is selected


SceneItem = Dot | Strand | Ghost | Cloud | Area
