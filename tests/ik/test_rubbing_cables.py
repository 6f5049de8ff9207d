"""Inverse kinematics of cables that rub. Oracles: playing the answer, cables without friction, differences."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

import hydrostat as hs
from hydrostat import friction_hysteresis
from hydrostat.ik.ik_result import IKStatus
from hydrostat.ik.objectives.objective import StateJacobian

SIZE = 0.2  # about that of the strip [m]
WAVY = (0.005, 0.018, 0.008, 0.016, 0.004, 0.012)


def rubbing(friction: float) -> hs.Simulation:
    """A strip whose upper cable zigzags, so that it turns at every point."""
    robot = strip_robot()
    first, *others = robot.cables
    waves = tuple((x, y) for (x, _), y in zip(first.points[1:], WAVY, strict=True))
    cables = [replace(first, points=(first.points[0], *waves)), *others]
    return hs.Simulation(robot.with_network(robot.winches, [replace(cable, friction=friction) for cable in cables]))


@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_the_answer_is_where_the_robot_ends_that_plays_it_from_rest(friction: float) -> None:
    simulation = rubbing(friction)
    target = simulation.solve(np.array([0.012, 0.001])).markers
    reached = hs.solve_ik(simulation, {name: tuple(place) for name, place in target.items()})
    played = simulation.solve(reached.pose.contractions)
    assert reached.rms_error <= 1e-6 * SIZE
    assert np.abs(played.nodes - reached.pose.nodes).max() < 1e-9
    assert played.tensions == pytest.approx(reached.pose.tensions, rel=1e-6, abs=1e-9)
    assert played.history == pytest.approx(reached.pose.history, abs=1e-9)


def test_a_way_may_begin_in_another_pose() -> None:
    """Oracle: the answer played from that pose; from rest it ends elsewhere, for cable has slipped back."""
    simulation = rubbing(0.3)
    start = simulation.solve(np.array([0.02, 0.0]))
    target = simulation.solve(np.array([0.012, 0.0]), start=start).markers["tip"]
    reached = hs.solve_ik(simulation, {"tip": tuple(target)}, start=start, options=hs.IKOptions(min_tension=False))
    played = simulation.solve(reached.pose.contractions, start=start)
    assert np.abs(played.nodes - reached.pose.nodes).max() < 1e-9
    assert np.abs(simulation.solve(reached.pose.contractions).nodes - played.nodes).max() > 1e-5


def test_next_to_no_friction_is_none() -> None:
    plain, rough = rubbing(0.0), rubbing(1e-12)
    target = {"tip": tuple(plain.solve(np.array([0.01, 0.0])).markers["tip"])}
    one, other = (hs.solve_ik(simulation, target) for simulation in (plain, rough))
    assert not one.friction_hysteresis
    assert max(other.friction_hysteresis.values()) < 1e-8
    assert np.abs(one.pose.nodes - other.pose.nodes).max() < 1e-5 * SIZE


def test_slopes_of_tensions_and_elongations_are_differences() -> None:
    simulation, step = rubbing(0.3), 1e-6
    middle = np.array([0.012, 0.0])
    moves = StateJacobian.at(simulation, simulation.solve(middle))
    up, down = (simulation.solve(middle * (1 + sign * step)) for sign in (1, -1))
    along = middle * 2 * step
    assert moves.tensions @ along == pytest.approx(up.tensions - down.tensions, rel=1e-4, abs=1e-9)
    assert np.abs(moves.nodes @ along - (up.nodes - down.nodes)).max() < 1e-4 * np.abs(up.nodes - down.nodes).max()


def test_the_band_is_that_of_coming_from_above() -> None:
    simulation = rubbing(0.3)
    pose = simulation.solve(np.array([0.012, 0.0]))
    band = friction_hysteresis(simulation, pose, overshoot=0.25)
    back = simulation.solve(pose.contractions, start=simulation.solve(np.array([0.015, 0.0]), start=pose))
    assert band["tip"] == pytest.approx(float(np.linalg.norm(back.markers["tip"] - pose.markers["tip"])), abs=1e-9)
    assert band["tip"] > friction_hysteresis(simulation, pose, overshoot=0.02)["tip"] > 1e-6
    with pytest.raises(hs.InputError, match="overshoot must be a share above 0, not 0"):
        friction_hysteresis(simulation, pose, overshoot=0.0)


def test_a_tracker_goes_on_from_pose_to_pose() -> None:
    simulation = rubbing(0.3)
    tracker = hs.Tracker(simulation)
    pose, target = simulation.rest, simulation.solve(np.array([0.012, 0.0])).markers["tip"]
    for _ in range(6):
        reached = tracker.update({"tip": tuple(target)}, seconds=0.03)
        pose = simulation.solve(reached.pose.contractions, start=pose)
        assert np.abs(pose.nodes - reached.pose.nodes).max() < 1e-7
    assert np.linalg.norm(pose.markers["tip"] - target) < 0.01 * SIZE


def test_a_tracker_that_must_turn_back_never_says_that_there_is_no_equilibrium() -> None:
    """Oracle: every pose of the way back is solved from the one before."""
    simulation = rubbing(0.3)
    tracker = hs.Tracker(simulation)
    there, back = (simulation.solve(np.array([pull, 0.0])).markers["tip"] for pull in (0.012, 0.0117))
    reasons = [tracker.update({"tip": tuple(there)}, seconds=0.03).status for _ in range(6)]
    reasons += [tracker.update({"tip": tuple(back)}, seconds=0.03).status for _ in range(8)]
    assert IKStatus.STALLED in reasons
    assert IKStatus.NO_EQUILIBRIUM not in reasons


def test_a_trajectory_remembers_its_way() -> None:
    simulation = rubbing(0.3)
    targets = [{"tip": tuple(simulation.solve(np.array([pull, 0.0])).markers["tip"])} for pull in (0.012, 0.006)]
    found = hs.solve_ik_trajectory(
        simulation, targets, speed=0.05, options=hs.TrajectoryOptions(rate=10.0, compare=False)
    )
    pose = simulation.rest
    for contractions, each in zip(found.contractions, found.poses, strict=True):
        pose = simulation.solve(contractions, start=pose)
        assert np.abs(pose.nodes - each.nodes).max() < 1e-4 * SIZE
