"""Rims of obstacles. Oracle: their distance fields, which are 0 there."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_robot, strip_robot

from hydrostat.robot import Obstacle, obstacle_lines

FAR = (0.5, 0.4, 0.3)
TO = (0.6, 0.55, 0.5)


def obstacles(dim: int) -> list[Obstacle]:
    at, to = FAR[:dim], TO[:dim]
    return [
        Obstacle(name="a", shape="plane", at=at, normal=(-1.0, -2.0, 0.5)[:dim]),
        Obstacle(name="b", shape="sphere", at=at, radius=0.05),
        Obstacle(name="c", shape="capsule", at=at, to=to, radius=0.05),
        Obstacle(name="d", shape="box", at=at, to=to),
        *([Obstacle(name="e", shape="cylinder", at=at, to=to, radius=0.05)] if dim == 3 else []),
    ]


@pytest.mark.parametrize("dim", [2, 3])
def test_lines_are_where_the_distance_is_none(dim: int) -> None:
    robot = strip_robot() if dim == 2 else box_robot()
    for obstacle in obstacles(dim):
        lines = obstacle_lines(replace(robot, obstacles=(obstacle,)))
        points = np.concatenate(lines)
        assert points.shape[1] == dim
        inside = points + 1e-6 * (np.mean([obstacle.at, obstacle.to or obstacle.at], axis=0) - points)
        assert np.abs(obstacle.field()(points).values).max() < 1e-9
        if obstacle.shape != "plane":
            assert obstacle.field()(inside).values.max() < 0


def test_without_obstacles_there_are_none() -> None:
    assert obstacle_lines(strip_robot()) == []
