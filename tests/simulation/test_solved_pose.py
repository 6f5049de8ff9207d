"""Distance of two poses, and strain beyond a material. Oracle: a right triangle, a body stretched evenly."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.robot import get_material
from hydrostat.simulation import Simulation, largest_distance


def test_it_is_the_distance_of_one_node() -> None:
    """3, 4 and 5: not the largest component, nor the two nodes together."""
    one = np.zeros((3, 2))
    assert largest_distance(one, one + np.array([[3.0, 4.0], [4.0, 0.0], [0.0, 0.0]])) == 5.0


@pytest.mark.parametrize(
    ("stretch", "told"),
    [((1.4, 0.8), ""), ((1.6, 0.9), "worst -10 and +60 % near"), ((1.2, 0.3), "worst -70 and +20 % near")],
)
def test_strain_beyond_a_material_is_told(stretch: tuple[float, float], told: str) -> None:
    """Polyester fibre is known from -60 to +50 %; all of the body is stretched alike."""
    robot = strip_robot().with_material(get_material("polyester fibre"))
    pose = Simulation(robot).solve([0.0, 0.0])
    words = replace(pose, nodes=robot.body.mesh.nodes * stretch).overstrain
    start = "100 % of the body is strained beyond the known range of polyester fibre (-60 to +50 %), "
    assert words.startswith(start + told) if told else words == ""
