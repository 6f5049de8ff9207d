"""One round of correction. Oracles: the model itself, the order of what winches miss, least squares of one winch."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.errors import InputError
from hydrostat.ik import IKResult, Limits, correct_contractions, solve_ik
from hydrostat.robot import PoseTarget
from hydrostat.simulation import Simulation

ROBOT = strip_robot(columns=10, rows=3)
SIMULATION = Simulation(ROBOT)


@pytest.fixture(scope="module")
def reached() -> IKResult:
    """A pose within reach, held by both cables."""
    tip = SIMULATION.solve(np.array([0.014, 0.004])).markers["tip"]
    return solve_ik(SIMULATION, PoseTarget(name="up", targets={"tip": tuple(tip.tolist())}))


def test_a_robot_like_its_model_keeps_its_contractions(reached: IKResult) -> None:
    corrected = correct_contractions(SIMULATION, reached, {"tip": reached.pose.markers["tip"]})
    assert corrected == pytest.approx(reached.pose.contractions, abs=1e-7)


def test_what_winches_miss_is_taken_back_up_to_second_order(reached: IKResult) -> None:
    """Winches of the built robot take in less than they should; half of that leaves a quarter of the error."""
    left = []
    for missing in (np.array([1e-3, 2e-4]), np.array([5e-4, 1e-4])):
        played = SIMULATION.solve(reached.pose.contractions - missing).markers["tip"]
        corrected = correct_contractions(SIMULATION, reached, {"tip": played}, damping=0.0)
        again = SIMULATION.solve(corrected - missing).markers["tip"]
        left.append(float(np.linalg.norm(again - reached.pose_target.targets["tip"])))
        assert left[-1] < 0.1 * np.linalg.norm(played - reached.pose_target.targets["tip"])
    assert left[0] / left[1] == pytest.approx(4.0, rel=0.3)


def test_damping_leaves_its_share_of_a_single_winch(reached: IKResult) -> None:
    """Oracle: J^2 / (J^2 + d^2), the share that least squares move one winch, with J by finite differences."""
    robot = replace(ROBOT, winches=ROBOT.winches[:1], cables=ROBOT.cables[:1])
    simulation = Simulation(robot)
    high, tip, low = (simulation.solve(np.array([value])).markers["tip"] for value in (0.0101, 0.01, 0.0099))
    slope = float(np.linalg.norm(high - low)) / 2e-4
    pulled = solve_ik(simulation, PoseTarget(name="up", targets={"tip": tuple(tip.tolist())}))
    for damping in (0.0, 0.35, 1.0):
        corrected = correct_contractions(simulation, pulled, {"tip": low}, damping=damping)
        assert corrected[0] - 0.01 == pytest.approx(1e-4 * slope**2 / (slope**2 + damping**2), rel=0.03)


def test_a_correction_stays_within_the_travel_of_winches(reached: IKResult) -> None:
    least = reached.pose.contractions.max() + 1e-4
    robot = replace(ROBOT, winches=tuple(replace(winch, travel=float(least)) for winch in ROBOT.winches))
    far = np.subtract(reached.pose.markers["tip"], (0.0, 0.02))
    kept = solve_ik(Simulation(robot), reached.pose_target)
    corrected = correct_contractions(Simulation(robot), kept, {"tip": far})
    assert corrected.max() == pytest.approx(least, abs=1e-9)
    assert corrected.min() >= 0.0
    gentle = Limits(tension=1.1 * float(reached.pose.tensions.max()))
    held = SIMULATION.solve(correct_contractions(SIMULATION, reached, {"tip": far}, limits=gentle, damping=0.0))
    assert held.tensions.max() < 1.25 * reached.pose.tensions.max()


@pytest.mark.parametrize(
    ("measured", "words"),
    [
        ({"nose": (0.1, 0.0)}, 'no target for marker "nose"'),
        ({"tip": (0.1, 0.0, 0.0)}, "2 finite numbers"),
        ({"tip": (0.1, float("nan"))}, "2 finite numbers"),
        ({}, "at least one marker"),
    ],
)
def test_what_was_not_measured_so_is_told_in_one_line(measured: dict, words: str, reached: IKResult) -> None:
    with pytest.raises(InputError, match=words) as error:
        correct_contractions(SIMULATION, reached, measured)
    assert "\n" not in str(error.value)
