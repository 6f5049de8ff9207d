"""Cables that do not earn their place. Oracle: inverse kinematics with and without them."""

from dataclasses import replace

import pytest
from builders import strip_robot

from hydrostat.design.error import rms_error
from hydrostat.design.trees.judge import cost
from hydrostat.design.trees.prune import prune
from hydrostat.ik import ReachedPose, solve_ik
from hydrostat.robot import Cable, Pose, Robot
from hydrostat.simulation import Simulation

POSES = (Pose(name="up", targets={"tip": (0.18, 0.06)}), Pose(name="down", targets={"tip": (0.19, -0.04)}))
TENSION = 1e3


def reach(robot: Robot) -> tuple[ReachedPose, ...]:
    return tuple(solve_ik(Simulation(robot), pose) for pose in POSES)


def with_idle_cable(robot: Robot) -> tuple[Robot, Cable]:
    """The robot with a cable so slack that it never pulls."""
    idle = replace(robot.cables[0], slack=1.0)
    return robot.with_network(robot.winches, (*robot.cables, idle)), idle


def test_an_idle_cable_is_left_out_and_the_others_stay() -> None:
    robot = strip_robot(columns=10, rows=3)
    crowded, _ = with_idle_cable(robot)
    pruned, reached = prune(crowded, POSES, reach(crowded), tension=TENSION, loss=0.01)
    assert pruned.cables == robot.cables
    assert rms_error(reached) == pytest.approx(rms_error(reach(robot)), rel=1e-4)


def test_every_winch_keeps_a_cable_whatever_may_be_lost() -> None:
    robot, _ = with_idle_cable(strip_robot(columns=10, rows=3))
    pruned, _ = prune(robot, POSES, reach(robot), tension=TENSION, loss=1e9)
    assert sorted(cable.winch for cable in pruned.cables) == sorted(winch.name for winch in pruned.winches)


@pytest.mark.parametrize("loss", [0.0, 0.2])
def test_no_more_is_lost_than_allowed(loss: float) -> None:
    robot, _ = with_idle_cable(strip_robot(columns=10, rows=3))
    before = reach(robot)
    pruned, reached = prune(robot, POSES, before, tension=TENSION, loss=loss)
    assert cost(reached, TENSION) <= (1 + loss) * cost(before, TENSION)
    assert rms_error(reached) == pytest.approx(rms_error(reach(pruned)), rel=1e-6)
