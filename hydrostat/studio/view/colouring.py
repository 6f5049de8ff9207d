"""`Colouring`: what the body is coloured by."""

from enum import StrEnum

from hydrostat.arrays import Nodes, Vector
from hydrostat.robot import Robot


class Colouring(StrEnum):
    """What the colours of the body mean."""

    FELT = "felt"
    STRAIN = "strain"
    STRESS = "stress"


def node_values(robot: Robot, nodes: Nodes, colouring: Colouring) -> Vector | None:
    """A value from 0 to 1 for each node; None for plain felt."""
    return None
