"""Measurements that tell most. Oracle: all subsets of a small set of candidates, and a heavy strip."""

from dataclasses import replace
from importlib import import_module
from itertools import combinations

import numpy as np
import pytest
from builders import routed_strip

from hydrostat.errors import InputError
from hydrostat.identification import MarkerPredictor, Measurements, named_model, suggest_measurements
from hydrostat.identification.suggest_measurements import choose_measurements
from hydrostat.robot import Robot

UPPER = ((0.0083, 0.0137), (0.0587, 0.0161), (0.1129, 0.0147), (0.1833, 0.0143))


@pytest.mark.parametrize("seed", range(8))
def test_the_choice_is_that_of_all_subsets(seed: int) -> None:
    slopes = np.random.default_rng(seed).standard_normal((10, 2, 4)) * [3.0, 1.0, 0.3, 2.0]
    alone = np.einsum("rci,rcj->rij", slopes, slopes)
    found = choose_measurements(slopes, 3)
    best = max(combinations(range(10), 3), key=lambda rows: np.linalg.slogdet(np.eye(4) + alone[list(rows)].sum(0))[1])
    assert sorted(found.tolist()) == list(best)


def strip() -> Robot:
    """A flat strip with a cable and weight, and two markers."""
    robot = routed_strip({"up": UPPER}, gravity=(0.0, -9.81), slack=0.001, travel=0.02)
    return replace(robot, markers=robot.markers[1:])


@pytest.mark.slow
def test_a_mass_is_hung_where_it_shows_the_modulus(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(import_module("hydrostat.identification.suggest_measurements"), "CANDIDATES", 12)
    robot = strip()
    bare = suggest_measurements(robot, 3, fit=("young", "gain", "density"))
    hung = suggest_measurements(robot, 3, fit=("young", "gain", "density"), masses=[0.01])
    tip = hung.markers.index("tip")
    assert hung.masses[:, tip].any()
    assert hung.deviations["body.young"] < 0.7 * bare.deviations["body.young"]
    assert hung.commands.max() <= 0.02
    calm = suggest_measurements(robot, 2, fit=("young", "gain"), tension=0.3)
    assert calm.commands.max() < hung.commands.max()


@pytest.mark.slow
def test_requests_that_cannot_be_met_are_refused() -> None:
    with pytest.raises(InputError, match="has no gravity"):
        suggest_measurements(replace(strip(), gravity=None), 3, masses=[0.01])
    with pytest.raises(InputError, match="poses tried are within the limits"):
        suggest_measurements(strip(), 40)


@pytest.mark.slow
def test_friction_is_shown_by_strokes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: places of a motion at two frictions, by differences; a strip with bends."""
    monkeypatch.setattr(import_module("hydrostat.identification.suggest_measurements"), "STROKES", 3)
    found = suggest_measurements(strip(), 8, fit=("friction",))
    assert found.in_order
    pulls = found.commands[:, 0].reshape(2, 4)
    assert pulls[0, 1] > 0
    assert pulls == pytest.approx(np.outer(pulls[:, 1], [0.5, 1.0, 0.5, 0.0]))
    path = Measurements(commands=found.commands, markers=found.markers, places=np.zeros((8, 2, 2)), in_order=True)
    model, step = named_model(strip(), ("friction",)), 0.02
    less, more = (
        MarkerPredictor(model, path).predict(np.array([s]), with_jacobian=False).places for s in (-step, step)
    )
    information = 1 + np.sum(((more - less) / (2 * step * found.noise)) ** 2)
    assert found.deviations["friction"] == pytest.approx(information**-0.5, rel=0.02)
    with pytest.raises(InputError, match="takes 4 photographs"):
        suggest_measurements(strip(), 3, fit=("friction",))
