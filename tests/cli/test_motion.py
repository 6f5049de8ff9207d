"""`simulate --dynamic`; oracle: the library called directly, and what its files say."""

import csv
import json
from collections.abc import Callable
from pathlib import Path
from shutil import copytree

import numpy as np
import pytest

import hydrostat as hs
from hydrostat.robot import gallery_folder

Run = Callable[..., tuple[int, str, str]]


@pytest.mark.slow
def test_a_ramp(run: Run, starfish: Path, tmp_path: Path) -> None:
    options = ("--dynamic", "--duration", "0.1s", "--time-step", "20 ms", "--ramp", "50ms")
    code, out, _ = run("simulate", starfish, *options, "--contract", "left=5mm", "--out", tmp_path)
    assert code == 0
    assert "5 steps to 0.1 s" in out
    simulation = hs.Simulation(hs.load_robot(starfish))
    *_, last = simulation.play(hs.ContractionProfile.ramp(simulation.as_contractions({"left": 0.005}), 0.05), 0.1, 0.02)
    with (tmp_path / "motion.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 6
    assert float(rows[-1]["left_mm"]) == pytest.approx(5.0)
    assert float(rows[-1]["left_x_mm"]) == pytest.approx(1e3 * last.markers["left"][0], rel=1e-8)
    facts = json.loads((tmp_path / "pose.json").read_text())
    assert facts["time"] == pytest.approx(0.1)
    assert facts["tensions"] == pytest.approx(last.tensions)
    for name in ("motion.png", "pose.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "frames" / "motion_0000.vtu").exists()


@pytest.mark.slow
def test_a_table_is_played(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: the contractions of the table, for as long as it lasts, but a second at least."""
    played = tmp_path / "wave.csv"
    played.write_text("time_s,left\n0,0\n0.2,6\n1.2,2\n")
    code, _, _ = run(
        "simulate", starfish, "--dynamic", "--play", played, "--time-step", "0.1s", "--out", tmp_path / "out"
    )
    assert code == 0
    with (tmp_path / "out" / "motion.csv").open() as file:
        rows = list(csv.DictReader(file))
    times = [float(row["time_s"]) for row in rows]
    assert times[-1] == pytest.approx(1.2)
    expected = np.interp(times, [0, 0.2, 1.2], [0, 6, 2])
    assert [float(row["left_mm"]) for row in rows] == pytest.approx(expected.tolist())


@pytest.mark.parametrize(
    ("options", "fragments"),
    [
        (("--duration", "2s"), ("--dynamic", "--duration")),
        (("--dynamic", "--duration", "2"), ("--duration 2", "no unit")),
        (("--dynamic", "--time-step", "0s"), ("--time-step 0s", "above 0")),
        (
            ("--dynamic", "--time-step", "1h"),
            ("--time-step 1h: longer than the simulated time (1 s)", "Choose a shorter one"),
        ),
        (("--dynamic", "--time-step", "5mm"), ("--time-step 5mm",)),
        (("--dynamic", "--jacobian"), ("--jacobian",)),
        (("--dynamic", "--play", "none.csv"), ("none.csv", "there is no such file")),
        (("--dynamic", "--play", "none.csv", "--contract", "left=5mm"), ("--play", "--contract")),
    ],
)
def test_one_clear_line(
    run: Run, starfish: Path, tmp_path: Path, options: tuple[str, ...], fragments: tuple[str, ...]
) -> None:
    code, _, err = run("simulate", starfish, *options, "--out", tmp_path / "out")
    assert code == 2
    assert err.count("\n") == 1
    for fragment in fragments:
        assert fragment in err
    assert not (tmp_path / "out").exists()


def test_a_table_that_takes_in_a_whole_cable_is_refused(run: Run, starfish: Path, tmp_path: Path) -> None:
    played = tmp_path / "wave.csv"
    played.write_text("time_s,left\n0,0\n1,900\n")
    code, _, err = run("simulate", starfish, "--dynamic", "--play", played, "--out", tmp_path / "out")
    assert code == 2
    assert "takes in the whole cable (116 mm)" in err


def test_a_motion_begins_under_the_loads_of_its_first_instant(run: Run, tmp_path: Path) -> None:
    """Oracle: the same robot without the load, which does not act before half a second."""
    names = ("plain", "late")
    for name in names:
        assert run("new", tmp_path / name, "--from", "gallery:starfish")[0] == 0
    with (tmp_path / "late" / "robot.toml").open("a") as file:
        file.write('\n[[load]]\nname = "late"\nmarker = "top"\nforce = ["0 N", "0.3 N"]\n')
        file.write(
            'path = [{ time = "0 s", share = 0 }, { time = "0.5 s", share = 0 }, { time = "0.6 s", share = 1 }]\n'
        )
    for name in names:
        code, _, _ = run(
            "simulate", tmp_path / name, "--dynamic", "--duration", "20ms", "--out", tmp_path / "out" / name
        )
        assert code == 0
    plain, late = (json.loads((tmp_path / "out" / name / "pose.json").read_text())["markers"]["top"] for name in names)
    assert late == pytest.approx(plain, abs=1e-6)


@pytest.mark.slow
def test_an_object_that_nothing_holds_is_told(run: Run, tmp_path: Path) -> None:
    """A ball on a flat starfish. Oracle: no force in the table after the first row."""
    code, out, _ = run("grasp", "gallery:starfish", "--pose", "wave", "--out", tmp_path / "out")
    assert (code, "warning: the robot does not hold the object" in out) == (0, True)
    rows = (tmp_path / "out" / "pull.csv").read_text().splitlines()[2:]
    assert all(float(row.split(",")[2]) == 0 for row in rows)


@pytest.mark.parametrize(
    ("at", "begins"), [((), "object at ("), (("--at", "500,500"), "--at 500,500: nothing touches")]
)
def test_at_is_named_where_it_was_typed(run: Run, tmp_path: Path, at: tuple[str, ...], begins: str) -> None:
    """Oracle: a place that was computed is no option."""
    options = ("--contract", "left=1mm", "--object", "sphere:3mm", "--direction", "+y")
    robot = (gallery_folder("starfish") / "robot.toml").read_text()
    folder = copytree(gallery_folder("starfish"), tmp_path / "robot")
    obstacle = '\n[[obstacle]]\nname = "object"\nshape = "plane"\nat = [0, -400]\nnormal = [0, 1]\n'
    (folder / "robot.toml").write_text(robot + ("" if at else obstacle))
    code, _, err = run("grasp", folder, *options, *at, "--out", tmp_path / "out")
    assert code == 2
    assert err.startswith(f"hydrostat: error: {begins}")
