"""The Python examples: each runs in a folder of its own, draws its figure, and prints a number that an oracle holds."""

import runpy
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hydrostat.simulation import Simulation

EXAMPLES = sorted((Path(__file__).parents[2] / "examples" / "python").glob("[0-9]*.py"))


def left_tip(names: dict[str, Any]) -> float:
    """Distance that the left tip moves for 12 mm, by the integral of the Jacobian [m]."""
    simulation = names["simulation"]
    row = [marker.name for marker in names["robot"].markers].index("left")
    poses = [simulation.solve({"left": 0.001 * (step + 0.5)}) for step in range(12)]
    return float(np.linalg.norm(sum(0.001 * simulation.marker_jacobian(pose)[row, :, 1] for pose in poses)))


def step(targets: np.ndarray) -> float:
    """Largest step of a moving target from one update to the next."""
    return float(np.linalg.norm(np.diff(targets, axis=0), axis=1).max())


def is_inside_grid(names: dict[str, Any]) -> bool:
    """Areas: the box of the places, and the hull of half of them."""
    spans = np.ptp(names["places"], axis=0)
    half = names["ConvexHull"](names["places"][::2]).volume / 100.0
    return half <= names["area"] < spans[0] * spans[1] / 100.0


HELD: dict[str, tuple[str, Callable[[dict[str, Any]], bool]]] = {
    "01_bend": ("integral of the Jacobian", lambda names: abs(names["travel"] / left_tip(names) - 1) < 0.01),
    "02_workspace": ("areas", is_inside_grid),
    "03_beam_theory": ("Timoshenko", lambda names: abs(names["ratio"] - 1) < 0.02),
    "04_inverse_kinematics": ("limit", lambda names: 1.9 < names["limited"].pose.tensions.max() < 2.002),
    "05_own_objective": ("markers", lambda names: names["level"] < 1e-6 and feet_differ(names) < 1e-6),
    "06_load_and_compliance": ("a solve with the load", lambda names: names["error"] < 0.01),
    "07_bone_in_an_arm": ("rigid", lambda names: names["strain"] < 1e-3 < names["with_bone"] < names["soft"]),
    "08_dynamics": ("statics", lambda names: names["off"] < 1e-4),
    "09_tracker": ("twice the target's step", lambda names: names["error"] < 2 * step(names["targets"])),
    "10_contact": ("distance of nodes", lambda names: 0.0 < names["gap"] < 3e-3),
    "11_snap_through": ("two poses between two folds", lambda names: names["folds"] == names["stable"] == 2),
    "12_friction": ("none without friction", lambda names: 1e4 * abs(work_without(names)) < names["work"]),
    "13_design": ("as built is worse", lambda names: names["network"].rms_error < names["built"] < 6e-3),
    "14_build_kit": ("its own checks", lambda names: all(check.passed for check in names["kit"].checks)),
    "15_drawing_to_robot": ("size asked for", lambda names: abs(names["size"] - 0.24) < 1e-3),
    "16_gradients": ("central difference", lambda names: names["error"] < 1e-6),
    "17_identify": ("hidden modulus", lambda names: abs(names["young"] / names["true"] - 1) < 0.03),
    "18_trajectory": ("speed limit", lambda names: 0.045 < names["fastest"] <= 0.05 * (1 + 1e-6)),
    "19_pulls": ("tensions at contractions", lambda names: names["error"] < 0.05),
    "20_environment": ("length of an episode", lambda names: names["steps"] == 40 and max(names["rewards"]) < 0),
}
"""Number of each example: its oracle, and whether it holds."""


def work_without(names: dict[str, Any]) -> float:
    """Area of the loop without friction [J]."""
    bare = replace(names["robot"], cables=tuple(replace(cable, friction=0.0) for cable in names["robot"].cables))
    tensions = names["tension_on_the_way"](Simulation(bare))
    return float((tensions[1:] + tensions[:-1]) / 2 @ np.diff(names["there_and_back"]))


def feet_differ(names: dict[str, Any]) -> float:
    """Difference in height of the feet, from the markers of a new solve [m]."""
    again = Simulation(names["simulation"].robot).solve(names["found"].pose.contractions)
    return float(abs(again.markers["left_foot"][1] - again.markers["right_foot"][1]))


def test_every_example_is_held() -> None:
    assert [path.stem for path in EXAMPLES] == list(HELD)


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, unchecked: None) -> None:
    if path.stem == "20_environment":
        pytest.importorskip("gymnasium")
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        names = runpy.run_path(str(path))
    oracle, holds = HELD[path.stem]
    assert holds(names), oracle
    names["figure"].savefig(tmp_path / "figure.png", dpi=40)
    assert not set(tmp_path.iterdir()) - {tmp_path / "figure.png"}  # it leaves nothing else
    assert 8 <= len(path.read_text(encoding="utf-8").splitlines()) <= 70
