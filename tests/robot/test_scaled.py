"""Robots of another size. Oracle: similarity; what scales keeps its ratios, what is bought stays."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.errors import InputError
from hydrostat.robot import Contact, Obstacle, Robot, load_robot, save_robot
from hydrostat.robot.scaled import scaled_robot


@pytest.mark.parametrize("name", ["starfish", "fish_tail"])
def test_all_lengths_scale_together(name: str, tmp_path: object) -> None:
    robot = gallery_robot(name)
    made = scaled_robot(robot, 1.5)
    for one, other in zip(robot.cables, made.cables, strict=True):
        np.testing.assert_allclose(other.points, 1.5 * np.array(one.points), atol=1e-12)
        assert (other.stiffness, other.slack) == (one.stiffness, pytest.approx(1.5 * one.slack))
    assert [winch.travel for winch in made.winches] == pytest.approx([1.5 * winch.travel for winch in robot.winches])
    for one, other in zip(robot.markers, made.markers, strict=True):
        np.testing.assert_allclose(other.at, 1.5 * np.array(one.at), atol=1e-12)
    for title, pose in robot.poses.items():
        for marker, place in pose.targets.items():
            np.testing.assert_allclose(made.poses[title].targets[marker], 1.5 * np.array(place), atol=1e-12)
    low, high = robot.body.mesh.nodes.min(axis=0), robot.body.mesh.nodes.max(axis=0)
    np.testing.assert_allclose(made.body.mesh.nodes.min(axis=0), 1.5 * low, atol=1e-3)
    np.testing.assert_allclose(made.body.mesh.nodes.max(axis=0), 1.5 * high, atol=1e-3)
    assert made.body.material == robot.body.material
    save_robot(made, tmp_path)  # type: ignore[arg-type]
    assert load_robot(tmp_path) == made  # type: ignore[arg-type]


def test_obstacles_and_contact_scale_too() -> None:
    table = Obstacle(name="table", shape="sphere", at=(0.0, -0.2), radius=0.05)
    robot: Robot = replace(gallery_robot("starfish"), obstacles=(table,), contact=Contact(distance=1e-3, friction=0.3))
    made = scaled_robot(robot, 0.5)
    assert made.obstacles[0].at == (0.0, -0.1)
    assert made.obstacles[0].radius == 0.025
    assert made.contact == Contact(distance=5e-4, friction=0.3)


@pytest.mark.parametrize("factor", [0.0, -1.0, 1000.0, float("nan"), True])
def test_a_factor_that_is_none_is_refused(factor: float) -> None:
    with pytest.raises(InputError, match=r"the factor must be from 0\.01 to 100"):
        scaled_robot(gallery_robot("starfish"), factor)
