"""`hydrostat pose` with limits and drawings; oracle: the library called directly, and hidden contractions."""

import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import strip_robot

import hydrostat as hs
from hydrostat.cli.pose import _note_other_pose
from hydrostat.design import activate, edge_fibres
from hydrostat.geometry import read_drawing
from hydrostat.plot import FlatSkin

Run = Callable[..., tuple[int, str, str]]

pytestmark = pytest.mark.usefixtures("unchecked")

HIDDEN = {"right": 0.03, "left": 0.012, "feet": 0.012}


@pytest.fixture
def drawing(starfish: Path, tmp_path: Path) -> Path:
    """The drawing of the starfish, with its outline as it is under the hidden contractions."""
    robot = hs.load_robot(starfish)
    body = robot.body
    page = read_drawing(body.content, name=body.file, size=body.size).page
    nodes = hs.Simulation(robot).solve(HIDDEN).nodes
    ring = FlatSkin.of(body).shape(nodes)[0] / np.array(page.scale) + np.array(page.origin)
    path = "M" + "L".join(f"{x:.3f} {y:.3f}" for x, y in ring) + "Z"
    file = tmp_path / "bent.svg"
    file.write_text(re.sub(r' d="[^"]*"', f' d="{path}"', body.content.decode(), count=1, flags=re.DOTALL))
    return file


@pytest.mark.slow
def test_a_drawing_leads_to_the_contractions_behind_it(run: Run, starfish: Path, drawing: Path, tmp_path: Path) -> None:
    code, out, _ = run("pose", starfish, "--drawing", drawing, "--out", tmp_path / "out")
    assert code == 0
    assert out.startswith("bent: rms error 0.")
    taken = json.loads((tmp_path / "out" / "contractions.json").read_text())
    assert taken == pytest.approx(HIDDEN, abs=5e-4)
    facts = json.loads((tmp_path / "out" / "pose.json").read_text())
    assert set(facts["errors"]) == {"outline"}
    assert facts["pose"] == "bent"
    assert (tmp_path / "out" / "pose.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_markers_and_a_drawing_together(run: Run, starfish: Path, drawing: Path, tmp_path: Path) -> None:
    assert run("pose", starfish, "--drawing", drawing, "--pose", "wave", "--out", tmp_path / "out")[0] == 0
    facts = json.loads((tmp_path / "out" / "pose.json").read_text())
    assert set(facts["errors"]) == {"outline", *hs.load_robot(starfish).poses["wave"].targets}


@pytest.mark.slow
def test_a_target_beyond_the_body_is_told_before_the_search(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: the distance of 700 mm to the marker, more than the 279 mm of the body."""
    robot = hs.load_robot(starfish)
    place = next(marker.at for marker in robot.markers if marker.name == "left")
    target = (place[0] - 0.7, place[1])
    far = replace(robot, poses={"far": hs.PoseTarget(name="far", targets={"left": target})})
    hs.save_robot(far, tmp_path / "far")
    out = run("pose", tmp_path / "far", "--restarts", "0", "--out", tmp_path / "out")[1]
    assert out.startswith("warning: pose far: left should move 700 mm, farther than the body is long\n")


@pytest.mark.slow
def test_a_limit_on_the_tension_holds_and_is_told(run: Run, starfish: Path, tmp_path: Path) -> None:
    code, out, _ = run("pose", starfish, "--pose", "wave", "--tension", "8 N", "--out", tmp_path / "out")
    assert code == 0
    facts = json.loads((tmp_path / "out" / "pose.json").read_text())
    assert max(facts["tensions"]) == pytest.approx(8.0, rel=1e-4)
    assert facts["held"] == ["right: at maximum tension, 8 N"]
    assert "  limit: right: at maximum tension, 8 N" in out
    assert "  optimality: " in out
    assert facts["optimality"] < 1e-3
    assert facts["tension_limit"] == 8.0


@pytest.mark.slow
def test_equal_winches_take_in_the_same(run: Run, starfish: Path, tmp_path: Path) -> None:
    options = ("--pose", "wave", "--equal", "left,right", "--restarts", "0")
    assert run("pose", starfish, *options, "--out", tmp_path / "out")[0] == 0
    taken = json.loads((tmp_path / "out" / "contractions.json").read_text())
    assert taken["left"] == taken["right"]
    robot = hs.load_robot(starfish)
    wave = robot.poses["wave"]
    limits = hs.Limits(equal=[["left", "right"]])
    alone = hs.solve_ik(hs.Simulation(robot), wave, limits=limits, options=hs.IKOptions(restarts=0))
    assert list(taken.values()) == pytest.approx(alone.pose.contractions.tolist(), abs=1e-6)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--tension", "20"), "--tension 20: "),
        (("--tension", "-3 N"), "--tension -3 N: must be above 0"),
        (("--equal", "left"), "--equal left: too few winches"),
        (("--equal", "left,right", "--equal", "right,feet"), "in two groups"),
        (("--restarts", "-1"), "--restarts -1: must be 0 or more"),
        (("--drawing", "none.svg"), "none.svg: there is no such file"),
        (("--target", "tip=1mm,2mm"), '--target tip=1mm,2mm: unknown marker "tip"'),
        (("--target", "top=1,2"), "--target top=1,2: missing unit. Write MARKER=X,Y, e.g. top=30mm,110mm."),
        (("--target", "top=1mm"), "1 value for 2 coordinates. Write MARKER=X,Y"),
        (("--target", "top=1,2mm", "--target", "top=1,2mm"), '"top" is given twice'),
        (("--target", "top=1,2mm", "--pose", "wave"), "--pose and --target: mutually exclusive"),
        (("--store", "nod"), "--store: there is nothing to store"),
        (("--muscles", "--drawing", "a.svg"), "--muscles and --drawing: mutually exclusive"),
    ],
)
def test_bad_options_are_one_line(
    run: Run, starfish: Path, tmp_path: Path, options: tuple[str, ...], words: str
) -> None:
    code, _, errors = run("pose", starfish, *options, "--out", tmp_path / "out")
    assert code == 2
    assert words in errors
    assert errors.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_pose_on_another_branch_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    """A pose that is not the one to which its contractions lead from rest; and one that is."""
    simulation = hs.Simulation(strip_robot())
    reached = hs.solve_ik(simulation, {"tip": (0.18, 0.05)})
    _note_other_pose(simulation, reached)
    assert capsys.readouterr().out == ""
    elsewhere = replace(reached.pose, nodes=reached.pose.nodes + np.array([0.0, 0.003]))
    _note_other_pose(simulation, replace(reached, pose=elsewhere))
    assert "another pose, up to 3.0 mm away" in capsys.readouterr().out


@pytest.mark.slow
def test_targets_on_the_command_line_are_a_pose(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: the pose of these targets in robot.toml; comments of the file."""
    shutil.copytree(starfish, tmp_path / "robot")
    wave = hs.load_robot(starfish).poses["wave"].targets
    given = [text for name, (x, y) in wave.items() for text in ("--target", f"{name}={1e3 * x:g},{1e3 * y:g}mm")]
    code, out, _ = run("pose", tmp_path / "robot", *given, "--store", "hello", "--out", tmp_path / "out")
    assert code == 0
    assert 'added pose "hello" to ' in out
    robot = hs.load_robot(tmp_path / "robot")
    stored = robot.poses["hello"].targets
    assert {name: pytest.approx(place) for name, place in wave.items()} == stored
    again = run("pose", tmp_path / "robot", *given, "--store", "hello", "--out", tmp_path / "other")[2]
    assert 'the robot has a pose "hello"' in again
    assert "# One arm curls up" in (tmp_path / "robot" / "robot.toml").read_text()
    expected = hs.solve_ik(hs.Simulation(robot), robot.poses["wave"]).pose.contractions
    taken = json.loads((tmp_path / "out" / "contractions.json").read_text())
    assert list(taken.values()) == pytest.approx(expected.tolist(), abs=1e-6)
    errors = run("pose", "gallery:starfish", *given, "--store", "hello", "--out", tmp_path / "other")[2]
    assert "the gallery is read-only. Make a copy: hydrostat new my_starfish --from gallery:starfish" in errors


def test_muscles_show_a_pose_before_there_are_cables(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: the same activation, called directly."""
    robot = replace(hs.load_robot(starfish), winches=(), cables=())
    hs.save_robot(robot, tmp_path / "bare")
    code, out, _ = run("pose", tmp_path / "bare", "--target", "top=30mm,110mm", "--muscles", "--out", tmp_path / "out")
    assert code == 0
    target = hs.PoseTarget(name="target", targets={"top": (0.03, 0.11)})
    found = activate(robot, target, edge_fibres(robot.body.mesh))
    assert found.rms_error < 0.1 * np.linalg.norm(np.subtract(robot.marker("top").at, (0.03, 0.11)))
    assert f"target: rms error {1e3 * found.rms_error:.2f} mm by muscles" in out
    assert (tmp_path / "out" / "activation.png").read_bytes().startswith(b"\x89PNG")


def test_a_pose_that_cannot_be_solved_is_not_stored(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: robot.toml as it was."""
    shutil.copytree(starfish, tmp_path / "robot")
    before = (tmp_path / "robot" / "robot.toml").read_text()
    asked = ("pose", tmp_path / "robot", "--target", "top=30mm,110mm", "--store", "nod", "--out", tmp_path / "out")
    assert run(*asked, "--model", tmp_path / "none.hsm")[0] != 0
    assert (tmp_path / "robot" / "robot.toml").read_text() == before
    errors = run(*asked, "--muscles", "--tension", "5N")[2]
    assert "--muscles and --tension: mutually exclusive" in errors
