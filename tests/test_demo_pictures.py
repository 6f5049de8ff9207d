"""The README's pictures of `make demo`. Oracles: the Makefile, the model, the refusals of the kit, the files."""

import json
import sys
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageSequence

from hydrostat.design import BuildTolerances, expected_error
from hydrostat.fabrication import Demand, find_refusals
from hydrostat.ik import IKOptions, Limits, solve_ik
from hydrostat.robot import Robot, gallery_folder, load_robot, robot_hash
from hydrostat.simulation import Simulation

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "docs"))

import pictures  # noqa: E402

PICTURES = ROOT / "docs" / "pictures"


@pytest.fixture(scope="module")
def record() -> dict[str, Any]:
    """Network and figures of the pictures: `python docs/pictures.py demo` writes all of them."""
    return json.loads((PICTURES / "demo.json").read_text())


@pytest.fixture(scope="module")
def robot(record: dict[str, Any]) -> Robot:
    """The starfish of the gallery with the network of the pictures."""
    assert record["source_robot"] == robot_hash(load_robot(gallery_folder("starfish"))), (
        "the starfish changed: python docs/pictures.py demo"
    )
    return pictures.demo_robot(record)


@pytest.mark.slow
def test_the_film_of_the_readme_is_drawn_from_the_demo(record: dict[str, Any], tmp_path: Path) -> None:
    """Oracle: the pixels of the film in the repository, which other fonts change a little."""
    pictures.draw_film(record, tmp_path / "film.gif")
    assert (PICTURES / "demo.gif").stat().st_size < 1_500_000
    frames = []
    for file in (PICTURES / "demo.gif", tmp_path / "film.gif"):
        with Image.open(file) as film:
            frames.append(np.array([frame.convert("RGB") for frame in ImageSequence.Iterator(film)], dtype=np.int16))
    assert frames[0].shape == frames[1].shape
    assert np.abs(frames[0] - frames[1]).mean() < 1.0, "python docs/pictures.py film"


def test_pictures_are_those_of_the_command_of_the_makefile(record: dict[str, Any]) -> None:
    assert record["command"] in (ROOT / "Makefile").read_text()
    for name, content in record["pictures"].items():
        assert sha256((PICTURES / name).read_bytes()).hexdigest() == content, f"{name}: python docs/pictures.py demo"
    readme = (ROOT / "README.md").read_text()
    assert "docs/pictures/demo.gif" in readme
    index = (ROOT / "docs" / "index.md").read_text()
    for name in ("activation.png", "network.png", "reached.png"):
        assert f"pictures/{name}" in index
    model, built = 1e3 * record["rms_error"], 1e3 * record["rms_error_as_built"]
    assert f"{model:.2f} mm off in the model, {built:.1f} mm expected as built" in readme


@pytest.mark.slow
def test_the_network_of_the_pictures_has_the_figures_of_the_readme(record: dict[str, Any], robot: Robot) -> None:
    assert robot_hash(robot) == record["robot"]
    simulation, pose = Simulation(robot), robot.poses["wave"]
    start = simulation.solve(np.array(record["contractions"]))
    misses = [np.subtract(start.markers[name], to) for name, to in pose.targets.items()]
    assert np.sqrt(np.mean(np.sum(np.square(misses), axis=1))) == pytest.approx(record["rms_error"], abs=1e-7)
    once, limits = IKOptions(restarts=0, min_tension=False), Limits(tension=record["tension_limit"])
    reached = solve_ik(simulation, pose, limits=limits, start=start, options=once)
    expected = expected_error(simulation, [reached], BuildTolerances.of(robot.body))
    assert expected == pytest.approx(record["rms_error_as_built"], rel=1e-3)
    assert find_refusals(robot, Demand.of_results(robot, [reached])) == ()
