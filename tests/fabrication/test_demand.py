"""What poses ask of motors and cables, against the equilibria themselves."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot
from plush_robots import crossed

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.fabrication import KitOptions
from hydrostat.fabrication.demand import Demand


def _posed(robot: hs.Robot, reach: float) -> hs.Robot:
    """The robot with a pose that its winch makes by taking in `reach` [m]."""
    made = hs.Simulation(robot).solve({"pull": reach})
    targets = {name: tuple(place.tolist()) for name, place in made.markers.items()}
    return replace(robot, poses={"made": hs.PoseTarget(name="made", targets=targets)})


def test_loads_are_those_of_the_pose_that_is_reached():
    robot = _posed(crossed(), 0.006)
    made = hs.Simulation(robot).solve({"pull": 0.006})
    demand = Demand.find(robot)
    assert demand.poses == ('pose "made"',)
    np.testing.assert_allclose(demand.tensions, made.tensions, rtol=1e-3)
    np.testing.assert_allclose(demand.taken, [[0.0, 0.006]], atol=1e-5)
    np.testing.assert_allclose(demand.torques, [0.006 * made.tensions.sum()], rtol=1e-3)


def test_a_step_of_its_own_is_the_lever_of_its_cable():
    robot = crossed()
    stepped = replace(robot, cables=(robot.cables[0], replace(robot.cables[1], spool_radius=0.009)))
    robot = _posed(stepped, 0.006)
    tensions = hs.Simulation(robot).solve({"pull": 0.006}).tensions
    np.testing.assert_allclose(Demand.find(robot).torques, [0.006 * tensions[0] + 0.009 * tensions[1]], rtol=1e-3)


def test_without_poses_each_winch_pulls_alone_as_far_as_it_goes():
    robot = replace(crossed(), winches=(replace(crossed().winches[0], travel=0.008),))
    demand = Demand.find(robot)
    full = hs.Simulation(robot).solve({"pull": 0.008})
    assert demand.poses == ('winch "pull" at its full travel',)
    np.testing.assert_allclose(demand.tensions, full.tensions, rtol=1e-6)


def test_with_friction_contractions_and_loads_are_those_that_reach_the_pose():
    """Oracle: a pose that the rough robot makes by known contractions, and its own equilibrium there."""
    smooth = crossed()
    rough = replace(smooth, cables=tuple(replace(cable, friction=0.3) for cable in smooth.cables))
    robot = _posed(rough, 0.004)
    demand = Demand.find(robot)
    there = hs.Simulation(rough).solve({"pull": 0.004})
    assert demand.poses == ('pose "made"',)
    np.testing.assert_allclose(demand.taken, [[0.0, 0.004]], atol=1e-6)
    np.testing.assert_allclose(demand.tensions, there.tensions, rtol=1e-3)
    less = Demand.find(replace(robot, cables=smooth.cables)).taken[0, 1]
    assert demand.taken[0, 1] > less + 1e-5, "without friction less cable would do"


def test_a_pose_far_out_of_reach_is_told():
    """Oracle: a target 3 m away from a body of 100 mm."""
    robot = replace(crossed(), poses={"away": hs.PoseTarget(name="away", targets={"tip": (3.0, 3.0)})})
    (sentence,) = Demand.find(robot).far
    assert sentence.startswith('pose "away" is missed by 4')
    assert Demand.find(_posed(crossed(), 0.006)).far == ()


def test_poses_are_asked_with_the_tension_that_cables_bear():
    """Oracles: the limit itself, and the loads without one, which are those of the pose."""
    robot = _posed(crossed(), 0.006)
    free = Demand.find(robot)
    most = 0.5 * float(free.tensions.max())
    bound = Demand.find(robot, tension=most)
    assert bound.tensions.max() == pytest.approx(most, rel=1e-3)
    assert bound.torques == pytest.approx(bound.tensions.sum() * 0.006, rel=1e-6)
    np.testing.assert_allclose(Demand.find(robot, tension=2 * float(free.tensions.max())).tensions, free.tensions)


def test_a_tension_must_pull():
    with pytest.raises(InputError, match="tension must be above 0 N, not -1 N"):
        KitOptions(tension=-1.0)


def test_loads_of_solved_poses_are_those_that_are_found():
    """Oracle: the same poses by inverse kinematics."""
    robot = _posed(crossed(), 0.006)
    reached = hs.solve_ik(hs.Simulation(robot), robot.poses["made"])
    known, found = Demand.of_results(robot, [reached]), Demand.find(robot)
    assert known.poses == found.poses
    np.testing.assert_allclose(known.tensions, found.tensions, rtol=1e-3)
    np.testing.assert_allclose(known.torques, found.torques, rtol=1e-3)
    np.testing.assert_allclose(known.taken, found.taken, atol=1e-5)


def test_if_no_pose_can_be_solved_winches_are_pulled_alone(monkeypatch: pytest.MonkeyPatch):
    """Oracle: inverse kinematics that always gives up."""

    def gives_up(*args: object, **options: object) -> None:
        raise InputError("no way")

    monkeypatch.setattr("hydrostat.fabrication.demand.solve_ik", gives_up)
    demand = Demand.find(_posed(crossed(), 0.006))
    assert demand.missed == ('pose "made": no way',)
    assert demand.poses == ('winch "pull" at its full travel',)


def test_a_robot_without_cables_asks_for_nothing():
    robot = replace(crossed(), cables=())
    demand = Demand.find(robot)
    assert demand.tensions.shape == (0,)
    assert demand.torques == pytest.approx([0.0])


def test_cable_that_is_paid_out_counts() -> None:
    """Oracle: a pose that two winches make by known contractions, the one below zero."""
    robot = strip_robot()
    made = hs.Simulation(robot).solve({"up": 0.012, "down": -0.004})
    targets = {name: tuple(place.tolist()) for name, place in made.markers.items()}
    reached = hs.IKResult(
        target=hs.PoseTarget(name="made", targets=targets),
        pose=made,
        errors={},
        status=hs.IKStatus.REACHED,
        iterations=0,
        solves=0,
        optimality=0.0,
        active_limits=(),
    )
    np.testing.assert_allclose(Demand.of_results(robot, [reached]).taken, [[0.0, 0.012], [-0.004, 0.0]], atol=1e-12)
