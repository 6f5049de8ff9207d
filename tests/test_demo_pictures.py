"""The README's pictures of `make demo`. Oracles: the Makefile, the model, the refusals of the kit, the files."""

import json
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hydrostat.design import BuildTolerances, assign_cable_sides, expected_error
from hydrostat.fabrication import Demand, find_refusals
from hydrostat.ik import IKOptions, Limits, solve_ik
from hydrostat.robot import Cable, Mount, Robot, Winch, gallery_folder, load_robot, robot_hash
from hydrostat.simulation import Simulation

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"


@pytest.fixture(scope="module")
def record() -> dict[str, Any]:
    """Network and figures of the pictures: `python docs/pictures.py demo` writes all of them."""
    return json.loads((PICTURES / "demo.json").read_text())


@pytest.fixture(scope="module")
def robot(record: dict[str, Any]) -> Robot:
    """The starfish of the gallery with the network of the pictures."""
    starfish = load_robot(gallery_folder("starfish"))
    assert record["source_robot"] == robot_hash(starfish), "the starfish changed: python docs/pictures.py demo"
    winches = [Winch(**as_tuples(winch) | {"mount": Mount(winch["mount"])}) for winch in record["winches"]]
    cables = [Cable(**as_tuples(cable)) for cable in record["cables"]]
    return assign_cable_sides(starfish).with_network(winches, cables)


def as_tuples(value: Any) -> Any:
    """Values of JSON with tuples for lists."""
    if isinstance(value, dict):
        return {name: as_tuples(one) for name, one in value.items()}
    return tuple(map(as_tuples, value)) if isinstance(value, list) else value


def test_pictures_are_those_of_the_command_of_the_makefile(record: dict[str, Any]) -> None:
    assert record["command"] in (ROOT / "Makefile").read_text()
    for name, content in record["pictures"].items():
        assert sha256((PICTURES / name).read_bytes()).hexdigest() == content, f"{name}: python docs/pictures.py demo"
    readme = (ROOT / "README.md").read_text()
    for name in ("activation.png", "network.png", "reached.png"):
        assert f"docs/pictures/{name}" in readme
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
