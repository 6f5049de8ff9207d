"""`hydrostat branches`; oracle: the library called directly, and the files read back."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import hydrostat as hs

Run = Callable[..., tuple[int, str, str]]

pytestmark = pytest.mark.usefixtures("unchecked")


@pytest.mark.slow
def test_branches_writes_what_the_library_finds(run: Run, tmp_path: Path, starfish: Path) -> None:
    code, out, _ = run("branches", starfish, "--contract", "left=20mm", "--starts", "4", "--out", tmp_path)
    assert code == 0
    assert "unique pose on 4 loading paths" in out
    assert "from rest: goal reached at 100.0 % of the path" in out
    facts = json.loads((tmp_path / "branches.json").read_text())
    simulation = hs.Simulation(hs.load_robot(starfish))
    pose = simulation.solve({"left": 0.02})
    assert facts["contractions"] == {"right": 0.0, "left": 0.02, "feet": 0.0}
    assert facts["poses"][0]["energy"] == pytest.approx(pose.energy)
    assert len(facts["poses"][0]["ways"]) == 4
    (branch,) = facts["branches"]
    assert branch["status"] == "goal reached"
    assert branch["critical"] == []
    assert branch["points"][-1]["markers"]["left"] == pytest.approx(pose.markers["left"].tolist(), abs=1e-7)
    assert all(point["stable"] for point in branch["points"])
    assert np.all(np.diff([point["share"] for point in branch["points"]]) > 0)
    assert (tmp_path / "branches.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], "--contract: no contraction given"),
        (["--contract", "left=0mm"], "--contract: no contraction given"),
        (["--contract", "left=12mm", "--starts", "0"], "--starts 0: must be at least 1"),
        (["--contract", "tail=12mm"], "tail"),
    ],
)
def test_bad_arguments_are_one_line(run: Run, tmp_path: Path, starfish: Path, options: list[str], words: str) -> None:
    code, _, errors = run("branches", starfish, *options, "--out", tmp_path / "out")
    assert code == 2
    assert words in errors
    assert errors.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_with_friction_ways_are_compared_and_no_branch_is_followed(run: Run, tmp_path: Path, starfish: Path) -> None:
    robot = tmp_path / "rubbing"
    hs.save_robot(hs.load_robot(starfish), robot)
    text = (robot / "robot.toml").read_text()
    (robot / "robot.toml").write_text(text.replace("[[cable]]\n", "[[cable]]\nfriction = 0.3\n"))
    code, out, _ = run("branches", robot, "--contract", "left=15mm", "--starts", "3", "--out", tmp_path / "out")
    assert code == 0
    assert "cable friction is on" in out
    assert json.loads((tmp_path / "out" / "branches.json").read_text())["branches"] == []


def test_help_has_an_example(run: Run) -> None:
    assert "Example: hydrostat branches" in run("branches", "--help")[1]
