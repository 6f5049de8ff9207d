"""`Shape`: where the body is now."""

from dataclasses import dataclass, field

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.robot import Robot


@dataclass(frozen=True, kw_only=True, eq=False)
class Shape:
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


def rest_shape(robot: Robot) -> Shape:
    """A robot as it was drawn."""
    return Shape(
        nodes=robot.body.mesh.nodes,
        tensions=np.zeros(len(robot.cables)),
        contractions=np.zeros(len(robot.winches)),
    )
