"""Cables wound the other way round on a winch. Oracles: a winch of their own, differences, poses that are known."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot, strip_robot

from hydrostat.ik import IKOptions, Limits, MarkerTarget, solve_ik
from hydrostat.robot import Robot, Winch, limit_travels, load_robot, save_robot
from hydrostat.simulation import Simulation
from hydrostat.testing import check_objective

RADIUS, RATIO = 0.02, 0.8


def two_way() -> Robot:
    """A strip with a cable above, and one below that is wound the other way round on a smaller step of the shaft."""
    robot = strip_robot(columns=8, rows=2)
    upper, lower = (replace(cable, winch="both", name="") for cable in robot.cables)
    winch = Winch(name="both", at=lower.points[0], spool_radius=RADIUS, travel=0.03, release=0.03)
    return robot.with_network([winch], [upper, replace(lower, reverse=True, spool_radius=RATIO * RADIUS)])


def apart() -> Robot:
    """The same cables, each on a winch of its own."""
    robot = two_way()
    one = replace(robot.winches[0], release=0.06)
    cables = [
        replace(cable, winch=name, reverse=False) for cable, name in zip(robot.cables, ("up", "down"), strict=True)
    ]
    return robot.with_network([replace(one, name="up"), replace(one, name="down")], cables)


@pytest.mark.parametrize("taken", [0.02, 0.0002, -0.02])
def test_a_reversed_cable_is_one_of_a_winch_that_pays_out_as_much(taken: float) -> None:
    robot = two_way()
    assert robot.spool_ratios == pytest.approx([1.0, -RATIO])
    found, expected = Simulation(robot).solve([taken]), Simulation(apart()).solve([taken, -taken])
    assert found.tensions == pytest.approx(expected.tensions, abs=1e-6)
    assert np.abs(found.nodes - expected.nodes).max() < 1e-9


@pytest.mark.parametrize("taken", [0.015, -0.015])
def test_slopes_either_way(taken: float) -> None:
    check_objective(MarkerTarget(targets={"tip": (0.18, 0.03)}), Simulation(two_way()), np.array([taken]))


@pytest.mark.parametrize("taken", [0.02, -0.02])
def test_a_pose_on_either_side_is_found_from_rest_at_the_first_try(taken: float) -> None:
    simulation = Simulation(two_way())
    goal = {"tip": simulation.solve([taken]).markers["tip"]}
    found = solve_ik(simulation, goal, options=IKOptions(restarts=0))
    assert found.pose.contractions == pytest.approx([taken], abs=1e-6)
    across = simulation.solve([-taken])
    assert solve_ik(simulation, goal, start=across, options=IKOptions(restarts=0)).rms_error < 1e-6


@pytest.mark.parametrize("taken", [0.02, -0.02])
def test_a_motor_keeps_to_its_torque_either_way(taken: float) -> None:
    simulation = Simulation(two_way())
    pose = simulation.solve([taken])
    arms = np.array([RADIUS, -RATIO * RADIUS])
    limit = 0.6 * abs(float(arms @ pose.tensions))
    found = solve_ik(simulation, {"tip": pose.markers["tip"]}, limits=Limits(torque=limit))
    assert abs(float(arms @ found.pose.tensions)) == pytest.approx(limit, rel=1e-4)
    assert np.sign(found.pose.contractions[0]) == np.sign(taken)


def test_a_file_keeps_it(tmp_path: Path) -> None:
    robot = gallery_robot("letter_s")
    cables = (replace(robot.cables[0], reverse=True), *robot.cables[1:])
    save_robot(robot.with_network(robot.winches, cables), tmp_path / "robot")
    assert load_robot(tmp_path / "robot").cables == cables


def test_travels_are_of_each_way() -> None:
    """Oracle: the same cable pulled by the travel of its winch."""
    robot = two_way()
    long = replace(robot, winches=(replace(robot.winches[0], travel=1.0, release=1.0),))
    (found,) = limit_travels(long).winches
    alone = [replace(cable, reverse=False) for cable in robot.cables]
    travels = [limit_travels(long.with_network(long.winches, [cable])).winches[0].travel for cable in alone]
    assert [found.travel, found.release] == pytest.approx(travels)
    assert found.travel < found.release < 1.0
