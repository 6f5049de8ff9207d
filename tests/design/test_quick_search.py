"""Networks for the pose of a moment. Oracles: checks of designs, fresh inverse kinematics, a new search."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.design import (
    BuildTolerances,
    Constraints,
    DesignRequest,
    QuickSearch,
    assign_cable_sides,
    expected_error,
    propose_routes,
    violations,
)
from hydrostat.design.region import Region
from hydrostat.ik import solve_ik
from hydrostat.robot import Marker, limit_travels
from hydrostat.simulation import Simulation

pytestmark = pytest.mark.slow


def test_networks_keep_all_limits_and_have_the_error_that_is_told() -> None:
    """The refined one misses in the model what inverse kinematics finds, and as built what the tolerances add."""
    robot = assign_cable_sides(gallery_robot("pig"))
    pose = robot.pose("hello")
    limits = Constraints(tension=15.0)
    request = DesignRequest(poses=(pose,), winches=2, cables=4, constraints=limits)
    first, last = propose_routes(robot, request)
    assert (first.is_refined, last.is_refined, last.is_buildable) == (False, True, True)
    for one in (first, last):
        assert violations(one.robot, limits, Region.of_body(robot.body, limits.clearance)) == []
        assert limit_travels(one.robot).winches == one.robot.winches
    simulation = Simulation(last.robot)
    searched = QuickSearch(robot, request).constraints  # with the torque of the motors that fit
    reached = solve_ik(simulation, pose, limits=searched.limits)
    assert last.error == pytest.approx(reached.rms_error, rel=0.02)
    assert last.expected_error == pytest.approx(
        expected_error(simulation, [reached], BuildTolerances.of(robot.body)), rel=0.02
    )
    places = {marker.name: marker.at for marker in robot.markers}
    at_rest = [np.sum(np.subtract(places[name], goal) ** 2) for name, goal in pose.targets.items()]
    assert last.expected_error < first.expected_error < 0.5 * np.sqrt(np.mean(at_rest))


def test_what_is_kept_between_poses_changes_no_result() -> None:
    """A search that has seen other poses and other markers proposes what a new one does, to the last digit."""
    robot = gallery_robot("pig")
    hello, nod = (DesignRequest(poses=(robot.pose(name),), winches=2, cables=4) for name in ("hello", "nod"))
    used = QuickSearch(robot, nod)
    used.prepare()
    next(used.with_markers((*robot.markers, Marker(name="more", at=robot.winches[0].at))).propose(nod.poses))
    for one, other in zip(used.propose(hello.poses), propose_routes(robot, hello), strict=True):
        assert one.robot.cables == other.robot.cables
        assert (one.expected_error, one.error) == (other.expected_error, other.error)


def test_parts_that_stay_and_mirrors_are_left_to_the_whole_search() -> None:
    robot = gallery_robot("starfish")
    request = DesignRequest(poses=(robot.pose("wave"),), winches=3, cables=6)
    for limits in (Constraints(mirror="x"), Constraints(locked_winches=(robot.winches[0].name,))):
        assert list(propose_routes(robot, replace(request, constraints=limits))) == []
