"""Every command does what its help says; oracle: the library called directly, and the files read back."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from builders import gallery_robot

import hydrostat as hs
from hydrostat.cli.limits import print_overloads
from hydrostat.cli.profiling import PARTS
from hydrostat.robot import robot_hash, save_robot

Run = Callable[..., tuple[int, str, str]]
SQUARE = b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 40"><path d="M0 0H60V40H0Z"/></svg>'


def test_help_lists_every_command(run: Run) -> None:
    code, out, _ = run("--help")
    assert code == 0
    for command in ("new", "check", "simulate", "pose", "trajectory", "play", "design", "fabricate"):
        assert f"  {command} " in out
        assert "Example: hydrostat" in run(command, "--help")[1]


def test_version(run: Run) -> None:
    assert run("--version")[1] == f"hydrostat {hs.__version__}\n"


@pytest.mark.slow
def test_new_from_the_gallery_is_the_gallery_robot(run: Run, tmp_path: Path, starfish: Path) -> None:
    code, out, _ = run("new", tmp_path / "mine", "--from", "gallery:starfish")
    assert code == 0
    assert "Created" in out
    assert robot_hash(hs.load_robot(tmp_path / "mine")) == robot_hash(replace(hs.load_robot(starfish), name="mine"))
    assert (tmp_path / "mine" / "rest.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_new_from_a_drawing_can_be_checked_and_simulated(run: Run, tmp_path: Path) -> None:
    drawing = tmp_path / "my drawing.svg"
    drawing.write_bytes(SQUARE)
    assert run("new", tmp_path / "box", "--from", drawing, "--size", "90 mm")[0] == 0
    robot = hs.load_robot(tmp_path / "box")
    assert np.ptp(robot.body.mesh.nodes, axis=0) == pytest.approx([0.09, 0.06])
    assert run("check", tmp_path / "box")[0] == 0
    assert run("simulate", tmp_path / "box", "--out", tmp_path / "out")[0] == 0


@pytest.mark.slow
def test_check_says_that_all_is_well(run: Run) -> None:
    """A flat robot and one in space; for the others see the reviews in tests/design/test_review_robot.py.

    The reach of markers takes ten times as long as the rest: one robot is asked for it.
    """
    for number, name in enumerate(["letter_s", "tongue"]):
        code, out, _ = run("check", Path("examples") / name, *["--thorough"] * (number == 0))
        assert code == 0
        assert "\nOK: 0 errors, " in out
        assert ("\nMarker workspaces (maximum tension 20 N, 64 poses sampled):\n" in out) == (number == 0)
        assert ("\ncompliance at rest, mm/N: " in out) == (number == 0)
        assert ("\nnot computed: poses, marker workspaces, compliance" in out) == (number > 0)


@pytest.mark.slow
def test_simulate_writes_what_the_library_solves(run: Run, tmp_path: Path, starfish: Path) -> None:
    code, out, _ = run("simulate", starfish, "--contract", "left=12mm", "--jacobian", "--out", tmp_path)
    assert code == 0
    assert "converged" in out
    simulation = hs.Simulation(hs.load_robot(starfish))
    pose = simulation.solve({"left": 0.012})
    facts = json.loads((tmp_path / "pose.json").read_text())
    assert facts["contractions"] == {"right": 0.0, "left": 0.012, "feet": 0.0}
    assert facts["cables"] == ["right 1", "left 1", "left 2", "feet 1", "feet 2"]
    assert facts["tensions"] == pytest.approx(pose.tensions.tolist(), abs=1e-9)
    assert facts["markers"]["left"] == pytest.approx(pose.markers["left"].tolist(), abs=1e-9)
    assert facts["status"] == "converged"
    assert facts["seconds"] > 0
    mesh = meshio.read(tmp_path / "pose.vtu")
    assert np.allclose(mesh.points[:, :2], pose.nodes, atol=1e-9)
    assert np.allclose(mesh.point_data["rest"][:, :2], simulation.robot.body.mesh.nodes)
    assert np.allclose(mesh.point_data["displacement"] + mesh.point_data["rest"], mesh.points, atol=1e-12)
    assert np.allclose(mesh.point_data["strain"], pose.strains, atol=1e-9)
    assert np.allclose(mesh.point_data["stress"], pose.stresses, atol=1e-3)
    lines = meshio.read(tmp_path / "cables.vtu")
    spans = np.linalg.norm(np.diff(lines.points[lines.cells[0].data], axis=1)[:, 0], axis=1)
    tension, winch = lines.cell_data["tension"][0], lines.cell_data["winch"][0]
    assert set(tension) == {float(value) for value in pose.tensions}
    taut = tension == pose.tensions["left 1"]  # its springs of 4 kN/m are longer by T / k, with a soft start
    assert spans[taut].sum() == pytest.approx(simulation.robot.cables[1].length - 0.012, abs=1.5e-3)
    assert (winch[taut] == 1).all()
    jacobian = np.load(tmp_path / "jacobian.npz")["jacobian"]
    assert jacobian == pytest.approx(simulation.jacobian(pose), abs=1e-6)
    assert (tmp_path / "pose.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_simulate_warns_beyond_travel_and_tension(run: Run, tmp_path: Path, starfish: Path) -> None:
    save_robot(replace(hs.load_robot(starfish), max_tension=0.1), tmp_path / "weak")
    asked = ("--contract", "left=-30mm", "--contract", "right=20mm")
    out = run("simulate", tmp_path / "weak", *asked, "--out", tmp_path / "out")[1]
    assert "is outside its range (-10 to 60 mm)" in out
    assert "more than its max_tension of 0.1 N" in out


@pytest.mark.slow
def test_simulate_warns_beyond_the_limits_of_the_robot(capsys: pytest.CaptureFixture[str]) -> None:
    """Oracle: by hand: 2 N at a spool of 6 mm are 12 N mm; 1.004 N are 1 N as far as a solver tells."""
    robot = gallery_robot("starfish")
    robot = replace(robot, max_tension=1.0, max_torque=0.01)
    tensions = np.full(len(robot.cables), 1.004)
    tensions[1] = 2.0
    print_overloads(robot, tensions, np.array([0.012, *[0.01] * (len(robot.winches) - 1)]))
    assert capsys.readouterr().out.splitlines() == [
        "warning: cable 2: 2 N, more than its max_tension of 1 N",
        f"warning: winch {robot.winches[0].name}: 12 N mm, more than its max_torque of 10 N mm",
    ]


def test_pose_writes_one_pose_or_a_folder_for_each(run: Run, tmp_path: Path, starfish: Path) -> None:
    robot = hs.load_robot(starfish)
    assert run("pose", starfish, "--pose", "wave", "--out", tmp_path / "one")[0] == 0
    reached = hs.solve_ik(hs.Simulation(robot), robot.poses["wave"])
    taken = json.loads((tmp_path / "one" / "contractions.json").read_text())
    assert list(taken.values()) == pytest.approx(reached.pose.contractions.tolist(), abs=1e-6)
    assert run("pose", starfish, "--out", tmp_path / "all")[0] == 0
    assert {folder.name for folder in (tmp_path / "all").iterdir()} == set(robot.poses)


@pytest.mark.slow
def test_design_writes_robot_report_score_and_kit(run: Run, tmp_path: Path, starfish: Path) -> None:
    arguments = (
        *("--pose", "wave", "--method", "trees", "--winches", 2, "--cables", 2, "--kit"),
        *("--out", tmp_path / "out"),
    )
    code, out, err = run("design", starfish, *arguments)
    assert code == 0
    assert "report.html" in out
    assert "Judging networks" in err
    robot = hs.load_robot(tmp_path / "out" / "robot")
    card = json.loads((tmp_path / "out" / "score.json").read_text())
    assert card["robot"] == robot_hash(robot)
    assert card["source_robot"] == robot_hash(hs.load_robot(starfish))
    again = hs.solve_ik(hs.Simulation(robot), robot.poses["wave"])
    assert card["poses"]["wave"]["rms_error"] == pytest.approx(again.rms_error, rel=1e-6)
    assert card["rms_error"] < card["rms_error_at_rest"]
    for file in ("report.html", "kit/pattern/pattern.svg", "kit/assembly_sheet.pdf"):
        assert (tmp_path / "out" / file).stat().st_size > 1000
    told = json.loads((tmp_path / "out" / "kit" / "manifest.json").read_text())
    assert told["robot"]["sha256"] == card["robot"]


def test_parts_of_a_profile_are_files_that_there_are() -> None:
    """Oracle: the folder of the package; a file that was renamed must keep its part."""
    files = {path.stem for path in Path(hs.__file__).parent.rglob("*.py")}
    assert set(PARTS) <= files
