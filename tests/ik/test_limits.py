"""Limits of inverse kinematics. Oracles: the limits themselves, scipy's SLSQP on the same problem."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_robot, strip_robot
from scipy.optimize import minimize, minimize_scalar

from hydrostat.errors import InputError
from hydrostat.ik import InverseReason, Limits, solve_ik
from hydrostat.robot import Winch
from hydrostat.simulation import Simulation

FAR = {"tip": (0.05, 0.2)}


def test_a_range_in_place_of_travel() -> None:
    simulation = Simulation(strip_robot())
    reached = solve_ik(simulation, FAR, limits=Limits(contraction={"up": (-0.005, 0.012), "down": (-0.004, 0.0)}))
    assert reached.pose.contractions[0] == pytest.approx(0.012, abs=1e-9)
    assert -0.004 <= reached.pose.contractions[1] <= 0.0
    assert reached.held[0] == "up: taken in as far as it may, 12 mm"
    assert reached.reason is InverseReason.OPTIMAL


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
    assert any("pulls as hard as it may" in words for words in reached.held)
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


WRONG = {
    "unknown winch": (Limits(contraction={"left": (0.0, 0.1)}), "left"),
    "empty range": (Limits(contraction={"up": (0.02, 0.01)}), "two rising numbers"),
    "not a range": (Limits(contraction={"up": (0.0, float("nan"))}), "two rising numbers"),
    "no tension": (Limits(tension=0.0), "tension must be above 0 N"),
    "tension of an unknown winch": (Limits(tension={"left": 1.0}), "left"),
    "no rate": (Limits(rate=-1.0, interval=1.0), "rate must be above 0 m/s"),
    "rate without interval": (Limits(rate=1.0), "interval above 0 s"),
    "in two groups": (Limits(equal=[["up", "down"], ["down"]]), "two groups"),
    "no group": (Limits(equal=["up"]), "must be groups"),  # type: ignore[arg-type]
    "group of strangers": (Limits(equal=[["up", "left"]]), "left"),
    "ranges of a group that do not meet": (
        Limits(contraction={"up": (0.0, 0.01), "down": (0.02, 0.03)}, equal=[["up", "down"]]),
        "within all of its limits",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_limits_are_told_in_one_line(name: str) -> None:
    limits, words = WRONG[name]
    with pytest.raises(InputError, match=words) as error:
        solve_ik(Simulation(strip_robot()), FAR, limits=limits)
    assert "\n" not in str(error.value)


def test_a_winch_without_cables_keeps_out_of_it() -> None:
    robot = strip_robot()
    robot = replace(robot, winches=(Winch(name="idle", at=(0.02, 0.0)), *robot.winches))
    simulation = Simulation(robot)
    hidden = simulation.solve(np.array([0.0, 0.02, 0.0]))
    reached = solve_ik(simulation, {"tip": tuple(hidden.markers["tip"].tolist())})
    assert reached.reason is InverseReason.REACHED
    assert reached.pose.contractions[0] == 0.0
