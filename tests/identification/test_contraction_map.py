"""A correction of contractions. Oracle: a robot whose spools are known to wind otherwise than its model says."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import routed_strip

from hydrostat.errors import InputError
from hydrostat.identification import ContractionMap, Measurements, identify
from hydrostat.identification.contraction_map import features
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation

ROUTES = {name: [(0.01, y), (0.07, y), (0.13, y), (0.19, y)] for name, y in (("up", 0.014), ("down", -0.014))}


def strip() -> Robot:
    """A strip with a cable above and one below, and three markers."""
    return routed_strip(ROUTES, travel=0.02)


def wind(commands: np.ndarray) -> np.ndarray:
    """True contractions: layers of cable add 25 % at the end of the travel."""
    return commands * (1 + 0.25 * commands / 0.02)


def rows(true: Callable[[np.ndarray], np.ndarray], noise: float, count: int = 15) -> Measurements:
    """Measured poses of the strip at contractions that are others than commanded."""
    rng = np.random.default_rng(4)
    commands = rng.uniform(0.002, 0.015, (count, 2)) * (rng.random((count, 2)) < 0.7)
    simulation = Simulation(strip())
    found = [simulation.solve(true(command)).markers for command in commands]
    names = ("root", "middle", "tip")
    places = np.array([[each[name] for name in names] for each in found])
    return Measurements(commands=commands, markers=names, places=places + noise * rng.standard_normal(places.shape))


@pytest.mark.slow
def test_a_spool_that_winds_otherwise_is_corrected(tmp_path: Path) -> None:
    identified = identify(strip(), rows(wind, 1e-5), fit=("gain",))
    found, values = identified.correction, identified.fitted.values
    assert found is not None
    assert found.after < found.before / 3
    gains = np.array([values["up.gain"], values["down.gain"]])
    for command in ([0.012, 0.0], [0.005, 0.013]):
        assert found.effective(gains * command) == pytest.approx(wind(np.array(command)), abs=2.5e-4)
    asked = np.array([0.01, 0.004])
    assert found.effective(found.command(asked)) == pytest.approx(asked, abs=1e-9)
    (tmp_path / "correction.json").write_bytes(found.text())
    read = ContractionMap.read(tmp_path, strip())
    assert read is not None
    assert read.weights == pytest.approx(found.weights)


def test_noise_alone_is_not_corrected() -> None:
    assert identify(strip(), rows(lambda command: command, 5e-4), fit=("gain",)).correction is None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[", "is no correction"),
        ('{"winches": ["left"], "travel_m": [1], "cable_lengths_m": [], "weights": [[0], [0]], "held_out_before_m": 1, '
         '"held_out_after_m": 1}', "is for the winches left"),
        ('{"winches": ["up", "down"], "travel_m": [1, 1], "cable_lengths_m": [], "weights": [[0], [0]], '
         '"held_out_before_m": 1, "held_out_after_m": 1}', "is no correction"),
    ],
)  # fmt: skip
def test_other_files_are_refused(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "correction.json").write_text(text)
    with pytest.raises(InputError, match=words):
        ContractionMap.read(tmp_path, strip())
    assert ContractionMap.read(tmp_path / "none", strip()) is None


def test_changes_are_bounded() -> None:
    count = len(features(np.zeros(2)))
    wild = ContractionMap(
        winches=("up", "down"),
        travel=np.full(2, 0.02),
        lengths=np.zeros(0),
        weights=np.full((count, 2), 50.0),
        before=1.0,
        after=1.0,
    )
    assert wild.effective(np.full(2, 0.01)) == pytest.approx(0.01 + 0.2 * 0.02)
    assert replace(wild, weights=0 * wild.weights).command(np.full(2, 0.01)) == pytest.approx(0.01)


def test_a_map_of_another_robot_or_without_inverse_is_refused(tmp_path: Path) -> None:
    robot, count = strip(), len(features(np.zeros(2)))
    lengths, weights = np.array([cable.length for cable in robot.cables]), np.zeros((count, 2))
    made = ContractionMap(
        winches=("up", "down"), travel=np.full(2, 0.02), lengths=lengths, weights=weights, before=1.0, after=0.5
    )
    (tmp_path / "correction.json").write_bytes(made.text())
    assert ContractionMap.read(tmp_path, robot) is not None
    (tmp_path / "correction.json").write_bytes(replace(made, lengths=lengths + 0.001).text())
    with pytest.raises(InputError, match="is for other cables or travel"):
        ContractionMap.read(tmp_path, robot)
    weights[0] = 4.0  # fixed-point steps converge only where the change rises less than the command
    (tmp_path / "correction.json").write_bytes(replace(made, weights=weights).text())
    with pytest.raises(InputError, match="cannot be inverted"):
        ContractionMap.read(tmp_path, robot)
