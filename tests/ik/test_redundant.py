"""Cables that can reach a goal in many ways. Oracles: one answer from all starts, with less effort than others."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_robot, strip_robot

from hydrostat.ik import IKOptions, IKResult, IKStatus, MarkerTarget, solve_ik
from hydrostat.robot import Cable, Marker, Robot, Winch
from hydrostat.simulation import Simulation


def crowded(robot: Robot) -> Robot:
    """A strip with two more winches, whose cables end halfway."""
    stops = np.linspace(0.01, 0.1, 4)
    more = {
        "up short": tuple((float(x), 0.012) for x in stops),
        "down short": tuple((float(x), -0.014) for x in stops),
    }
    return replace(
        robot,
        winches=(*robot.winches, *(Winch(name=name, at=points[0], release=0.01) for name, points in more.items())),
        cables=(*robot.cables, *(Cable(winch=name, points=points) for name, points in more.items())),
    )


@pytest.fixture(scope="module")
def simulation() -> Simulation:
    return Simulation(crowded(strip_robot()))


def reach(simulation: Simulation, start: list[float] | None, **options) -> IKResult:
    target = {"tip": tuple(simulation.solve(np.array([0.02, 0.0, 0.006, 0.0])).markers["tip"].tolist())}
    begin = None if start is None else simulation.solve(np.array(start))
    return solve_ik(simulation, target, start=begin, options=IKOptions(**options))


STARTS = [[0.03, 0.02, 0.0, 0.0], [0.0, 0.02, 0.01, 0.01], [0.0, 0.0, 0.0, 0.02], [0.02, 0.02, 0.01, 0.01]]


def test_one_answer_whatever_the_start(simulation: Simulation) -> None:
    """Contractions agree to 1e-3 of the travel, with the error below the tolerance."""
    first = reach(simulation, None)
    for start in STARTS:
        other = reach(simulation, start)
        assert other.status is IKStatus.REACHED
        assert max(other.errors.values()) <= 1e-6 * simulation.robot.body.mesh.size
        assert np.abs(other.pose.contractions - first.pose.contractions).max() < 6e-5


def test_it_pulls_least(simulation: Simulation) -> None:
    """No answer from another start has smaller squared tensions."""
    least = np.sum(reach(simulation, None).pose.tensions ** 2)
    for start in STARTS:
        assert np.sum(reach(simulation, start, min_tension=False).pose.tensions ** 2) > least * (1 - 1e-3)


def test_no_drift(simulation: Simulation) -> None:
    """Asked again from its own answer, it stays."""
    once = reach(simulation, None)
    twice = solve_ik(simulation, once.target, start=once.pose)
    assert np.abs(twice.pose.contractions - once.pose.contractions).max() < 6e-5


def test_a_marker_that_no_cable_moves() -> None:
    """Beside the pin: no singular solve; the others are reached as if it were not there."""
    robot = strip_robot()
    robot = replace(robot, markers=(*robot.markers, Marker(name="held", at=(0.0, 0.0))))
    simulation = Simulation(robot)
    pose = simulation.solve(np.array([0.02, 0.005]))
    tip = tuple(pose.markers["tip"].tolist())
    alone = solve_ik(simulation, {"held": (0.01, 0.0)})
    assert alone.status is IKStatus.LOCAL_OPTIMUM
    assert np.isfinite(alone.pose.nodes).all()
    both = solve_ik(simulation, {"tip": tip, "held": (0.0, 0.0)})
    assert both.errors["tip"] < 1e-4
    free = solve_ik(simulation, {"tip": tip})
    assert both.pose.contractions == pytest.approx(free.pose.contractions, abs=1e-3)


def test_free_directions_leave_a_choice() -> None:
    simulation = Simulation(strip_robot())
    goal = MarkerTarget(targets={"tip": (0.17, 0.5)}, free={"tip": "y"})
    found = [
        solve_ik(simulation, objectives=[goal], start=simulation.solve(np.array(start))).pose
        for start in ([0.0, 0.0], [0.03, 0.01], [0.01, 0.03])
    ]
    assert all(abs(pose.markers["tip"][0] - 0.17) <= 2e-7 for pose in found)
    sides = {bool(pose.markers["tip"][1] > 0) for pose in found}
    assert len(sides) == 1
    options = IKOptions(min_tension=False)
    other = solve_ik(simulation, objectives=[goal], start=simulation.solve(np.array([0.01, 0.03])), options=options)
    assert bool(other.pose.markers["tip"][1] > 0) not in sides  # the start shows where one answer is not asked for


def test_space() -> None:
    simulation = Simulation(box_robot())
    hidden = simulation.solve(np.array([0.01, 0.006]))
    goal = MarkerTarget(targets={"tip": tuple(hidden.markers["tip"].tolist())}, free={"tip": "xz"})
    starts = (np.zeros(2), np.array([0.015, 0.0]), np.array([0.0, 0.01]))
    found = [solve_ik(simulation, objectives=[goal], start=simulation.solve(start)).pose for start in starts]
    assert np.ptp([pose.contractions for pose in found], axis=0).max() < 1e-4
