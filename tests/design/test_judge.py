"""Which robot reaches poses best. Oracle: inverse kinematics of every robot to the end."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design.judge import judge, rms_error
from hydrostat.ik import solve_ik
from hydrostat.robot import Pose, Robot
from hydrostat.simulation import Simulation

POSES = (Pose(name="up", targets={"tip": (0.18, 0.06)}), Pose(name="down", targets={"tip": (0.19, -0.04)}))


def shifted(shift: float) -> Robot:
    """The strip with both cables moved up or down."""
    robot = strip_robot(columns=10, rows=3)
    cables = tuple(replace(cable, points=tuple((x, y + shift) for x, y in cable.points[:4])) for cable in robot.cables)
    winches = tuple(replace(winch, at=cable.points[0]) for winch, cable in zip(robot.winches, cables, strict=True))
    return robot.with_network(winches, cables)


def test_the_best_robot_is_found_with_what_it_reaches() -> None:
    robots = [shifted(shift) for shift in np.linspace(-0.01, 0.008, 8)]
    robots.insert(5, strip_robot(columns=10, rows=3))
    expected = [rms_error([solve_ik(Simulation(robot), pose) for pose in POSES]) for robot in robots]
    calls: list[tuple[str, int, int]] = []
    best, reached = judge(robots, POSES, progress=lambda *call: calls.append(call))
    assert best == int(np.argmin(expected))
    assert rms_error(reached) == pytest.approx(min(expected), rel=1e-4)
    assert [pose.target for pose in reached] == list(POSES)
    assert [done for _, done, _ in calls] == list(range(10))
