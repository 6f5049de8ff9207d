"""Time limits of inverse kinematics. Oracle: a clock that counts how often it is looked at."""

import time
from dataclasses import replace
from itertools import count

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.ik import IKStatus, solve_ik
from hydrostat.ik.inverse_kinematics import _follow_friction
from hydrostat.robot import Obstacle
from hydrostat.simulation import Simulation

LOOKS = 12  # of the clock after the time is up: each place that waits looks once or twice, and goes home


def rubbing() -> Simulation:
    robot = gallery_robot("starfish")
    return Simulation(robot.with_network(robot.winches, [replace(cable, friction=0.4) for cable in robot.cables]))


@pytest.mark.parametrize("allowed", [60, 200])
def test_a_search_with_friction_stops_when_time_is_up(allowed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ways are followed increment by increment; each looks at the clock, as does what comes after the search."""
    simulation = rubbing()
    rest = simulation.rest
    clock = count(0.0, 1.0)
    monkeypatch.setattr(time, "monotonic", lambda: next(clock))
    target = {"top": rest.markers["top"] + np.array([0.05, -0.02])}
    reached = solve_ik(simulation, target, start=rest, seconds=float(allowed))
    assert reached.status is IKStatus.TIME_LIMIT
    assert next(clock) <= allowed + LOOKS
    assert reached.pose.result.converged
    left = np.abs(
        simulation.path.with_history(reached.pose).gradient(reached.pose.nodes, reached.pose.contractions)
    ).max()
    assert left <= reached.pose.result.allowed


def test_a_limit_that_is_not_reached_changes_nothing() -> None:
    """Oracle: the same search without a limit."""
    simulation = Simulation(gallery_robot("starfish"))
    target = {"top": simulation.rest.markers["top"] + np.array([0.01, -0.002])}
    free, limited = solve_ik(simulation, target), solve_ik(simulation, target, seconds=1e6)
    assert (free.pose.nodes == limited.pose.nodes).all()
    assert free.status is limited.status


def test_an_answer_followed_with_friction_says_that_time_is_up() -> None:
    """With obstacle friction the answer is solved again along its loading path; here no time is left for that."""
    wall = Obstacle(name="wall", shape="plane", at=(0.0, -0.2), normal=(0.0, 1.0), friction=0.5)
    simulation = Simulation(replace(gallery_robot("starfish"), obstacles=(wall,)))
    target = {"top": simulation.rest.markers["top"] + np.array([0.01, -0.002])}
    found = solve_ik(simulation, target)
    late = _follow_friction(simulation.with_deadline(time.monotonic() - 1.0), found, None)
    assert found.status is not IKStatus.TIME_LIMIT
    assert late.status is IKStatus.TIME_LIMIT
