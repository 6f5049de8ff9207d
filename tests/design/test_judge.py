"""Which robot reaches poses best, which cables earn their place. Oracle: inverse kinematics of all, to the end."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design.network import rms_error
from hydrostat.design.trees.judge_robots import cost, judge, prune
from hydrostat.ik import IKResult, solve_ik
from hydrostat.progress import no_progress
from hydrostat.robot import Cable, PoseTarget, Robot
from hydrostat.simulation import Simulation

POSES = (PoseTarget(name="up", targets={"tip": (0.18, 0.06)}), PoseTarget(name="down", targets={"tip": (0.19, -0.04)}))


def shifted(shift: float) -> Robot:
    """The strip with both cables moved up or down."""
    robot = strip_robot(columns=10, rows=3)
    cables = tuple(replace(cable, points=tuple((x, y + shift) for x, y in cable.points[:4])) for cable in robot.cables)
    winches = tuple(replace(winch, at=cable.points[0]) for winch, cable in zip(robot.winches, cables, strict=True))
    return robot.with_network(winches, cables)


@pytest.mark.slow
def test_the_best_robot_is_found_with_what_it_reaches() -> None:
    robots = [shifted(shift) for shift in np.linspace(-0.01, 0.008, 8)]
    robots.insert(5, strip_robot(columns=10, rows=3))
    expected = [rms_error([solve_ik(Simulation(robot), pose) for pose in POSES]) for robot in robots]
    calls: list[tuple[str, int, int]] = []
    best, reached = judge(robots, POSES, tension=100.0, progress=lambda *call: calls.append(call))
    assert best == int(np.argmin(expected))
    assert rms_error(reached) == pytest.approx(min(expected), rel=1e-4)
    assert [pose.target for pose in reached] == list(POSES)
    assert [done for _, done, _ in calls] == list(range(10))


def test_cost_is_the_error_until_a_cable_bears_too_much() -> None:
    """Oracle: the formula, at a tension limit above and at half of the largest tension."""
    reached = [solve_ik(Simulation(strip_robot(columns=10, rows=3)), pose) for pose in POSES]
    largest = max(float(pose.pose.tensions.max()) for pose in reached)
    assert cost(reached, 2 * largest) == rms_error(reached)
    assert cost(reached, largest / 2) == pytest.approx(2 * rms_error(reached))


def test_a_robot_that_pulls_too_hard_is_not_chosen() -> None:
    """Oracle: the same two robots, whose order turns when the limit lies between their tensions."""
    robots = [strip_robot(columns=10, rows=3), shifted(-0.008)]
    reached = [[solve_ik(Simulation(robot), pose) for pose in POSES] for robot in robots]
    for limit in (1e-3, 0.5, 100.0):
        best, _ = judge(robots, POSES, tension=limit, progress=no_progress)
        assert best == int(np.argmin([cost(found, limit) for found in reached]))


POSES = (PoseTarget(name="up", targets={"tip": (0.18, 0.06)}), PoseTarget(name="down", targets={"tip": (0.19, -0.04)}))
TENSION = 1e3


def reach(robot: Robot) -> tuple[IKResult, ...]:
    return tuple(solve_ik(Simulation(robot), pose) for pose in POSES)


def with_idle_cable(robot: Robot) -> tuple[Robot, Cable]:
    """The robot with a cable so slack that it never pulls."""
    idle = replace(robot.cables[0], name="idle", slack=1.0)
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
