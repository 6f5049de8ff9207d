"""`Coloring`: what the body is colored by: felt, strain, stress, or the muscles that pull."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.robot import Robot
from hydrostat.simulation import node_strains, node_stresses
from hydrostat.studio.view.scene_items import RobotShape


class Coloring(StrEnum):
    """Quantity that the body's colors show."""

    FELT = "felt"
    STRAIN = "strain"
    STRESS = "stress"
    MUSCLES = "muscles"


@dataclass(frozen=True, kw_only=True)
class Scale:
    """Content of a legend."""

    title: str  # what is shown, such as "strain"
    most: float  # value of the last color, in SI; the first is 0. It does not change as the body moves.
    low: str  # the first as text, with its unit
    high: str  # the last as text, with its unit; more than that has the same color


def scale(robot: Robot, coloring: Coloring) -> Scale | None:
    """Return the color scale of a robot; None for plain felt.

    The last color of the stress is what uniaxial tension of the last strain would be, were the body linear.
    """
    material = robot.body.material
    full = 0.5  # strain of the last color, if the material does not say how far it can be stretched
    strain = full if material.largest_stretch is None else min(material.largest_stretch - 1.0, 1.0)
    if coloring is Coloring.STRAIN:
        return Scale(title="Strain", most=strain, low="0 %", high=f"{100 * strain:.3g} %")
    if coloring is Coloring.STRESS:
        stress = strain * material.young
        return Scale(title="Stress (von Mises)", most=stress, low="0 kPa", high=f"{1e-3 * stress:.3g} kPa")
    if coloring is Coloring.MUSCLES:
        return Scale(title="Muscles", most=1.0, low="none", high="strongest")
    return None


def node_values(robot: Robot, shape: RobotShape, coloring: Coloring) -> Vector | None:
    """A value from 0 to 1 for each node, as a share of the `scale`; None for plain felt, and where no muscle is."""
    if coloring is Coloring.MUSCLES:
        return shape.muscles
    legend, nodes = scale(robot, coloring), shape.nodes
    if legend is None:
        return None
    found = node_strains(robot, nodes) if coloring is Coloring.STRAIN else node_stresses(robot, nodes)
    return np.clip(found / legend.most, 0.0, 1.0)
