"""Limits of inverse kinematics. Oracles: the limits themselves, scipy's SLSQP on the same problem."""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders import box_robot, strip_robot
from scipy.optimize import minimize, minimize_scalar

from hydrostat.errors import InputError
from hydrostat.ik import IKOptions, IKStatus, Limits, solve_ik
from hydrostat.ik.limits import bounds
from hydrostat.robot import Winch
from hydrostat.simulation import Simulation

FAR = {"tip": (0.05, 0.2)}
STRIP = Simulation(strip_robot())


def test_a_range_in_place_of_travel() -> None:
    simulation = Simulation(strip_robot())
    reached = solve_ik(simulation, FAR, limits=Limits(contraction={"up": (-0.005, 0.012), "down": (-0.004, 0.0)}))
    assert reached.pose.contractions[0] == pytest.approx(0.012, abs=1e-9)
    assert -0.004 <= reached.pose.contractions[1] <= 0.0
    assert reached.active_limits[0] == "up: at maximum contraction, 12 mm"
    assert reached.status is IKStatus.LOCAL_OPTIMUM


def test_a_range_may_begin_above_rest() -> None:
    simulation = Simulation(strip_robot())
    reached = solve_ik(simulation, {"tip": (0.2, 0.0)}, limits=Limits(contraction={"up": (0.01, 0.02)}))
    assert 0.01 <= reached.pose.contractions[0] <= 0.02


@pytest.mark.parametrize("most", [0.3, 1.0, 2.5])
def test_tension(most: float) -> None:
    """The limit holds to 1e-6 and is used to the full, as the target is out of reach."""
    simulation = Simulation(strip_robot())
    reached = solve_ik(simulation, FAR, limits=Limits(tension={"up": most}))
    assert reached.pose.tensions[0] == pytest.approx(most, rel=2e-6)
    assert any("at maximum tension" in words for words in reached.active_limits)
    assert reached.optimality < 1e-5
    assert solve_ik(simulation, FAR).pose.tensions[0] > 1.2 * most


@pytest.mark.parametrize("robot", [strip_robot(), box_robot()], ids=["flat", "space"])
def test_scipy_finds_nothing_better_under_a_limit_of_tension(robot, unchecked: None) -> None:
    """SLSQP on the same objective, with the tensions as constraints, begun at our answer and at rest."""
    simulation = Simulation(robot)
    most = 0.6
    goal = np.array([0.15, 0.08]) if robot.body.mesh.dim == 2 else np.array([0.09, 0.04, 0.02])
    reached = solve_ik(simulation, {"tip": tuple(goal)}, limits=Limits(tension=most))
    ours = max(reached.errors.values()) ** 2
    bounds = [(-winch.release, winch.travel) for winch in robot.winches]

    def pose(contractions: np.ndarray):
        return simulation.solve(np.clip(contractions, *np.transpose(bounds)))

    def error(contractions: np.ndarray) -> float:
        return float(np.sum((pose(contractions).markers["tip"] - goal) ** 2))

    limit = {"type": "ineq", "fun": lambda contractions: most - pose(contractions).tensions}
    for begin in (reached.pose.contractions, np.full(len(bounds), 1e-3)):
        other = minimize(error, begin, method="SLSQP", bounds=bounds, constraints=[limit], options={"maxiter": 40})
        kept = pose(other.x).tensions.max() <= most * (1 + 1e-4)
        assert not kept or ours <= other.fun * (1 + 1e-3)


def test_rate_counts_from_the_start() -> None:
    simulation = Simulation(strip_robot())
    start = simulation.solve(np.array([0.01, 0.0]))
    reached = solve_ik(simulation, FAR, start=start, limits=Limits(rate={"up": 0.03}, interval=0.1))
    assert reached.pose.contractions[0] == pytest.approx(0.013, abs=1e-9)


def test_equal_contractions() -> None:
    """Two winches as one, against a search over the one contraction that is left."""
    simulation = Simulation(strip_robot())
    goal = np.array([0.17, 0.01])
    pair = solve_ik(simulation, {"tip": tuple(goal.tolist())}, limits=Limits(equal=[["up", "down"]]))
    assert pair.pose.contractions[0] == pair.pose.contractions[1]

    def error(contraction: float) -> float:
        pose = simulation.solve(np.array([contraction, contraction]), strict=False)
        return float(np.linalg.norm(pose.markers["tip"] - goal))

    other = minimize_scalar(error, bounds=(0.0, 0.06), method="bounded", options={"xatol": 1e-7})
    assert pair.rms_error == pytest.approx(other.fun, rel=1e-6)
    assert pair.pose.contractions[0] == pytest.approx(other.x, abs=1e-4)


RANGE = "must lie between two rising numbers"
WRONG: Mapping[str, tuple[dict[str, Any], str]] = {
    "unknown winch": ({"contraction": {"left": (0.0, 0.1)}}, "left"),
    "empty range": ({"contraction": {"up": (0.02, 0.01)}}, RANGE),
    "not a range": ({"contraction": {"up": (0.0, float("nan"))}}, RANGE),
    "one number for a range": ({"contraction": {"up": 0.05}}, f"{RANGE} [m], not 0.05"),
    "three numbers for a range": ({"contraction": {"up": (0.0, 0.01, 0.02)}}, f"{RANGE} [m], not (0.0, 0.01, 0.02)"),
    "words for a range": ({"contraction": {"up": ("0", "1")}}, f"{RANGE} [m], not ('0', '1')"),
    "nothing for a range": ({"contraction": {"up": None}}, f"{RANGE} [m], not None"),
    "ranges in a list": ({"contraction": [(0.0, 0.1)]}, "contraction must be given by name"),
    "no ranges": ({"contraction": None}, "contraction must be given by name"),
    "no tension": ({"tension": 0.0}, "tension must be a number above 0 N, not 0"),
    "tension with a unit": ({"tension": "5 N"}, "tension must be a number above 0 N, not '5 N'"),
    "tensions in a list": ({"tension": [1, 2]}, "tension must be a number above 0 N, not [1, 2]"),
    "tension of nothing": ({"tension": {"up": None}}, "tension must be a number above 0 N, not None"),
    "a truth for a tension": ({"tension": True}, "tension must be a number above 0 N, not True"),
    "tension of an unknown winch": ({"tension": {"left": 1.0}}, "left"),
    "no rate": ({"rate": -1.0, "interval": 1.0}, "rate must be a number above 0 m/s, not -1"),
    "rate with a unit": ({"rate": "50 mm/s", "interval": 1.0}, "rate must be a number above 0 m/s, not '50 mm/s'"),
    "rate without interval": ({"rate": 1.0}, "interval above 0 s"),
    "interval without rate": ({"interval": 0.1}, "an interval of 0.1 s limits nothing without a rate"),
    "no interval": ({"rate": 1.0, "interval": 0}, "interval of limits must be a number above 0 s, not 0"),
    "interval with a unit": ({"rate": 1.0, "interval": "1s"}, "must be a number above 0 s, not '1s'"),
    "in two groups": ({"equal": [["up", "down"], ["down"]]}, "is in two groups of equal contraction; join them"),
    "twice in a group": ({"equal": [["up", "up"]]}, 'winch "up" is named twice in a group'),
    "no group": ({"equal": ["up"]}, "must be groups of winches"),
    "a name for groups": ({"equal": "up"}, "must be groups of winches"),
    "nothing for groups": ({"equal": None}, "must be groups of winches"),
    "nothing for a group": ({"equal": [None]}, "must be groups of winches"),
    "group of strangers": ({"equal": [["up", "left"]]}, "left"),
    "ranges of a group that do not meet": (
        {"contraction": {"up": (0.0, 0.01), "down": (0.02, 0.03)}, "equal": [["up", "down"]]},
        "within all of its limits",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_limits_are_told_in_one_line(name: str, unchecked: None) -> None:
    given, words = WRONG[name]
    with pytest.raises(InputError, match=re.escape(words)) as error:
        solve_ik(STRIP, FAR, limits=Limits(**given))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("given", [None, STRIP.robot])
def test_only_a_simulation_has_limits(given: Any, unchecked: None) -> None:
    with pytest.raises(InputError, match=r"simulation must be a Simulation\(robot\), not (None|a Robot)$"):
        bounds(given, Limits())


def test_limits_are_limits(unchecked: None) -> None:
    given: Any = {"tension": 3}
    with pytest.raises(InputError, match=r"limits must be Limits\(...\), .* not {'tension': 3}"):
        bounds(STRIP, given)


def test_limits_left_out_are_those_of_the_robot(unchecked: None) -> None:
    """Oracle: by hand; a torque of 0.03 N m on spools of 6 mm is 5 N."""
    simulation = Simulation(replace(strip_robot(), max_tension=3.0, max_torque=0.03))
    assert bounds(simulation, Limits()).most == pytest.approx([3.0, 3.0, 0.03, 0.03])
    assert bounds(simulation, Limits(tension=7.0)).most == pytest.approx([7.0, 7.0, 0.03, 0.03])
    assert bounds(simulation, Limits(torque=0.05)).most == pytest.approx([3.0, 3.0, 0.05, 0.05])


def test_a_winch_without_cables_keeps_out_of_it() -> None:
    robot = strip_robot()
    robot = replace(robot, winches=(Winch(name="idle", at=(0.02, 0.0)), *robot.winches))
    simulation = Simulation(robot)
    hidden = simulation.solve(np.array([0.0, 0.02, 0.0]))
    reached = solve_ik(simulation, {"tip": tuple(hidden.markers["tip"].tolist())})
    assert reached.status is IKStatus.REACHED
    assert reached.pose.contractions[0] == 0.0


def test_a_start_above_the_limit_of_tension_is_brought_below_it() -> None:
    simulation = Simulation(strip_robot())
    start = simulation.solve(np.array([0.05, 0.0]))
    options = IKOptions(restarts=0, min_tension=False)
    for most in (0.3, 2.0):
        reached = solve_ik(simulation, FAR, limits=Limits(tension=most), start=start, options=options)
        assert reached.pose.tensions.max() <= most * (1 + 1e-6)
        assert reached.status is IKStatus.LOCAL_OPTIMUM


def test_limits_that_cannot_be_kept_together_are_told() -> None:
    """At 30 mm the cable pulls more than it may."""
    simulation = Simulation(strip_robot())
    reached = solve_ik(simulation, FAR, limits=Limits(tension=0.3, contraction={"up": (0.03, 0.06)}))
    assert reached.status is IKStatus.INFEASIBLE
    assert reached.pose.result.converged


def test_a_rate_bounds_both_directions() -> None:
    """Oracle: rate times interval, on both sides of the contractions at the start."""
    start = np.array([0.01, 0.02])
    near = bounds(STRIP, Limits(rate=0.03, interval=0.1)).near(start)
    np.testing.assert_allclose(near.high, start + 0.003, rtol=1e-12)
    np.testing.assert_allclose(near.low, start - 0.003, rtol=1e-12)


@pytest.mark.parametrize("most", [0.002, 0.006])
def test_torque_of_a_winch_that_pulls_two_cables(most: float) -> None:
    """The sum of radius times tension holds to 2e-6 and is used to the full; one cable pulls more than its even share.

    The target is out of reach, and a tension limit of the even share would leave a larger error.
    """
    robot = strip_robot()
    up, down = robot.cables
    second = replace(up, name="up 2", points=tuple((x, 0.4 * y) for x, y in up.points), spool_radius=0.004)
    simulation = Simulation(robot.with_network(robot.winches, [up, second, down]))
    arms = np.array([robot.winches[0].spool_radius, 0.004])
    reached = solve_ik(simulation, FAR, limits=Limits(torque={"up": most}))
    tensions = reached.pose.tensions[:2]
    assert float(arms @ tensions) == pytest.approx(most, rel=2e-6)
    assert f"up: at maximum torque, {1e3 * most:.4g} N mm" in reached.active_limits
    share = most / arms.sum()
    assert tensions.max() > share
    shared = solve_ik(simulation, FAR, limits=Limits(tension={"up": share}))
    assert reached.rms_error < shared.rms_error
