"""Built robots after one correction. Oracles: the model, linear tolerances, places on a line."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design import BuildTolerances, MarkerEstimator, built_errors, corrected_errors
from hydrostat.design.corrected_error import expected_corrected_error, spread_markers
from hydrostat.ik import solve_ik
from hydrostat.robot import Marker, PoseTarget
from hydrostat.simulation import Simulation

ROBOT = strip_robot(columns=10, rows=3)
NONE = BuildTolerances.none()


def test_one_correction_takes_back_what_winches_can(unchecked: None) -> None:
    """Spools of 1 % other radii act as other contractions; a robot as its model keeps its error, and noise adds."""
    tip = Simulation(ROBOT).solve(np.array([0.014, 0.004])).markers["tip"]
    reached = [solve_ik(Simulation(ROBOT), PoseTarget(name="up", targets={"tip": tuple(tip.tolist())}))]
    exact = corrected_errors(ROBOT, reached, NONE, noise=0.0, draws=1)
    assert exact.drawn[0] == pytest.approx(exact.model, abs=1e-7)
    spools = replace(NONE, spool=0.01)
    played = built_errors(ROBOT, [reached[0].pose_target], [reached[0].pose.contractions], spools, draws=4)
    corrected = corrected_errors(ROBOT, reached, spools, noise=0.0, draws=4)
    assert np.linalg.norm(corrected.drawn) < 0.2 * np.linalg.norm(played.drawn)
    noisy = corrected_errors(ROBOT, reached, NONE, noise=5e-4, draws=30)
    assert 0.6 < np.sqrt(np.mean(noisy.drawn**2)) / (np.sqrt(2) * 5e-4) < 1.1


@pytest.mark.slow
def test_the_expected_error_after_a_correction_is_that_of_many_draws(unchecked: None) -> None:
    """Oracle: 60 robots, played, measured, corrected and played again; their mean square is known to a fifth."""
    tip = Simulation(ROBOT).solve(np.array([0.014, 0.004])).markers["tip"]
    reached = [solve_ik(Simulation(ROBOT), PoseTarget(name="up", targets={"tip": tuple(tip.tolist())}))]
    small = BuildTolerances(sewing=5e-4, friction=(0.0, 0.0))
    expected = expected_corrected_error(Simulation(ROBOT), reached, small)
    drawn = corrected_errors(ROBOT, reached, small, draws=60).drawn
    played = built_errors(ROBOT, [reached[0].pose_target], [reached[0].pose.contractions], small, draws=60).drawn
    assert np.sqrt(np.mean(drawn**2)) == pytest.approx(expected, rel=0.2)
    assert expected < 0.5 * np.sqrt(np.mean(played**2))


def test_markers_of_all_poses_show_the_others(unchecked: None) -> None:
    """Oracle: a robot with other holes, played; a marker that is measured nowhere, and one in another pose."""
    robot = replace(ROBOT, markers=(*ROBOT.markers, Marker(name="middle", at=(0.1, 0.0))))
    simulation = Simulation(robot)
    commands = np.array([[0.014, 0.004], [0.003, 0.012]])
    ends = [simulation.solve(command).markers for command in commands]
    targets = [{name: tuple(end[name].tolist()) for name in ("tip", "middle")} for end in ends]
    reached = [solve_ik(simulation, target) for target in targets]
    small = BuildTolerances(sewing=5e-4, friction=(0.0, 0.0))
    estimator = MarkerEstimator.of(simulation, reached, small, noise=1e-5)
    left = []
    for number in range(6):
        built = Simulation(small.draw(robot, np.random.default_rng(number)))
        played = [built.solve(one.pose.contractions).markers for one in reached]
        found = estimator.estimate([{"tip": played[0]["tip"]}, {"tip": tuple(played[1]["tip"])}])
        left.append(
            [
                [np.linalg.norm(places["middle"] - at["middle"]) for places, at in zip(each, played, strict=True)]
                for each in (found, [one.pose.markers for one in reached])
            ]
        )
    guessed, model = np.sqrt(np.mean(np.square(left), axis=(0, 2)))
    assert guessed < 0.5 * model
    assert np.linalg.norm(found[0]["tip"] - played[0]["tip"]) < 0.3 * np.linalg.norm(
        reached[0].pose.markers["tip"] - played[0]["tip"]
    )
    assert estimator.estimate([{}, {}])[0]["tip"] == pytest.approx(reached[0].pose.markers["tip"])


def test_measured_markers_are_far_from_one_another() -> None:
    places = {name: np.array([x, 0.0]) for name, x in zip("abcdefg", (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.5), strict=True)}
    assert spread_markers(places, 3) == ["g", "a", "d"]
    assert spread_markers(places, 7) == list("abcdefg")
