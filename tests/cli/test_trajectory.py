"""`hydrostat trajectory`; oracle: the library called directly, and the files read back."""

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import hydrostat as hs
from hydrostat.cli.trajectory import free_speeds, read_fitting_motors, warn_of_speed
from hydrostat.control import Calibration
from hydrostat.fabrication import Motor
from hydrostat.ik import IKOptions, IKStatus, TrajectoryOptions, solve_ik_trajectory
from hydrostat.simulation import ContractionProfile

Run = Callable[..., tuple[int, str, str]]

pytestmark = pytest.mark.usefixtures("unchecked")


def test_winches_faster_than_their_motor_are_named(tmp_path: Path) -> None:
    """Oracle: the no-load speed of the motor on its spool, 2 pi r n."""
    robot = hs.load_robot("gallery:starfish")
    free = 2 * np.pi * robot.winches[1].spool_radius * Motor.choose("sts3215").speed / 60
    speeds = free_speeds(robot, read_fitting_motors(robot, tmp_path), "sts3215")
    assert speeds == pytest.approx([free] * 3)
    assert free_speeds(robot, None, "auto") == []
    usual = Calibration.usual(robot).motors
    Calibration((*usual[:2], replace(usual[2], radius=2 * usual[2].radius))).write(tmp_path)
    known = read_fitting_motors(robot, tmp_path)
    assert free_speeds(robot, known, "sts3215") == pytest.approx([free, free, 2 * free])
    assert warn_of_speed(robot, speeds, "sts3215", np.array([0.0, 0.99 * free, 0.0])) == ""
    assert warn_of_speed(robot, [], "auto", np.array([0.0, 9.0, 0.0])) == ""
    warning = warn_of_speed(robot, speeds, "sts3215", np.array([0.0, 1.01 * free, 0.0]))
    assert warning.startswith(f"warning: winch {robot.winches[1].name} takes in {1010 * free:.3g} mm/s, its sts3215")
    assert warning.endswith(f'--max-speed "{int(1e3 * free)} mm/s" or less')


def test_the_motor_limits_the_usual_speed(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: the speed limits that are written, against 2 pi r n of the robot's motor."""
    own = shutil.copytree(starfish, tmp_path / "robot")
    robot = hs.load_robot(own)
    least = 2 * np.pi * min(winch.spool_radius for winch in robot.winches) * Motor.choose("sts3215").speed / 60
    assert 0.03 < least < 0.05
    for motor, typed, speed in (
        ("auto", (), 0.05),
        ("sts3215", (), least),
        ("sts3215", ("--max-speed", "0.1 m/s"), 0.1),
    ):
        hs.save_robot(replace(robot, motor=motor), own)
        out = tmp_path / f"{motor}{len(typed)}"
        code, text, _ = run("trajectory", own, "--poses", "rest", *typed, "--width", "160", "--out", out)
        limits = json.loads((out / "trajectory.json").read_text())["speed_limit"]
        assert (code, [*limits.values()]) == (0, pytest.approx([speed] * 3, abs=1e-3))
        assert max(limits.values()) <= speed
        assert ("note: at most 32 mm/s, the no-load speed of the sts3215. A loaded" in text) == (speed == least)


def test_motors_that_do_not_fit_stop_no_plan(run: Run, starfish: Path, tmp_path: Path) -> None:
    """Oracle: the usual speed, as without motors.toml, and one warning that names the file."""
    own = shutil.copytree(starfish, tmp_path / "robot")
    usual = Calibration.usual(hs.load_robot(own)).motors
    Calibration((*usual[:2], replace(usual[2], winch="tail", model="sts3215"))).write(own)
    code, text, _ = run("trajectory", own, "--poses", "rest", "--width", "160", "--out", tmp_path / "out")
    limits = json.loads((tmp_path / "out" / "trajectory.json").read_text())["speed_limit"]
    assert (code, [*limits.values()]) == (0, [0.05] * 3)
    (warning,) = [line for line in text.splitlines() if line.startswith("warning:")]
    assert warning.startswith(f'warning: {own / "motors.toml"}: winch "{usual[2].winch}" has no motor; ')
    assert warning.endswith(". This plan uses the spools of robot.toml")


@pytest.mark.slow
def test_files_are_what_the_library_finds(run: Run, starfish: Path, tmp_path: Path) -> None:
    options = (
        "--poses",
        "star_jump,rest",
        "--max-speed",
        "0.1 m/s",
        "--max-acceleration",
        "500 mm/s^2",
        "--width",
        "200",
    )
    code, out, err = run("trajectory", starfish, *options, "--out", tmp_path / "out")
    assert code == 0
    assert "following the path" in err
    robot = hs.load_robot(starfish)
    simulation = hs.Simulation(robot)
    keyframes = [robot.poses["star_jump"], hs.Keyframe(target=simulation.rest, name="rest")]
    found = hs.solve_ik_trajectory(simulation, keyframes, speed=0.1, acceleration=0.5)
    assert found.lines()[-3] in out
    profile = ContractionProfile.read(tmp_path / "out" / "trajectory.csv", robot)
    assert profile.times == pytest.approx(found.times, rel=1e-8)
    assert profile.values == pytest.approx(found.contractions, abs=1e-9)
    facts = json.loads((tmp_path / "out" / "trajectory.json").read_text())
    assert [key["name"] for key in facts["keyframes"]] == ["star_jump", "rest"]
    assert facts["keyframes"][0]["errors"] == pytest.approx(dict(found.keyframes[0].errors), abs=1e-8)
    assert facts["duration"] == pytest.approx(found.seconds)
    assert np.array(facts["markers"]["left"]) == pytest.approx(found.markers["left"], abs=1e-8)
    assert np.array(facts["tensions"]) == pytest.approx(found.tensions, abs=1e-5)
    assert facts["speed_limit"] == {"right": 0.1, "left": 0.1, "feet": 0.1}
    assert (tmp_path / "out" / "trajectory.png").read_bytes().startswith(b"\x89PNG")
    with Image.open(tmp_path / "out" / "trajectory.gif") as image:
        assert image.size[0] == 200
        assert getattr(image, "n_frames", 1) > 10


@pytest.mark.slow
def test_the_profile_can_be_played(run: Run, starfish: Path, tmp_path: Path) -> None:
    options = ("--poses", "wave", "--path", "linear", "--max-speed", "200 mm/s", "--width", "200")
    assert run("trajectory", starfish, *options, "--out", tmp_path / "way")[0] == 0
    file = tmp_path / "way" / "trajectory.csv"
    played = ("--dynamic", "--play", file, "--time-step", "50ms", "--duration", "0.2s")
    assert run("simulate", starfish, *played, "--out", tmp_path / "motion")[0] == 0
    facts = json.loads((tmp_path / "motion" / "pose.json").read_text())
    values = ContractionProfile.read(file, hs.load_robot(starfish)).at(0.2)
    assert list(facts["contractions"].values()) == pytest.approx(values.tolist(), abs=1e-9)
    limits = json.loads((tmp_path / "way" / "trajectory.json").read_text())["acceleration_limit"]
    assert limits == {"right": None, "left": None, "feet": None}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--max-speed", "50"), "--max-speed 50: "),
        (("--max-speed", "0 mm/s"), "--max-speed 0 mm/s: must be above 0"),
        (("--max-acceleration", "5 mm"), "--max-acceleration 5 mm: "),
        (("--hold", "-1s"), "--hold -1s: must be 0 or more"),
        (("--path", "round"), '--path must be one of smooth, linear, straight, not "round"'),
        (("--poses", "wave,dance"), "dance"),
        (("--poses", ","), "--poses: no pose named"),
        (("--poses", "wave,,rest"), "--poses: no pose named"),
        (("--equal", "left"), "--equal left: too few winches"),
        (("--equal", "left,tail"), "tail"),
        (("--path", "linear", "--max-acceleration", "1 m/s^2"), "no limit on the acceleration can hold"),
        (("--width", "2"), "--width 2"),
    ],
)
def test_bad_options_are_one_line(
    run: Run, starfish: Path, tmp_path: Path, options: tuple[str, ...], words: str
) -> None:
    code, _, errors = run("trajectory", starfish, *options, "--out", tmp_path / "out")
    assert code == 2
    assert words in errors
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_search_that_is_stuck_ends_with_1(
    run: Run, starfish: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One step is too few to reach a pose; the files are written all the same."""
    hasty = TrajectoryOptions(rate=5, compare=False, inverse=IKOptions(iterations=1))
    monkeypatch.setattr("hydrostat.ik.solve_ik_trajectory", partial(solve_ik_trajectory, options=hasty))
    code, out, _ = run("trajectory", starfish, "--poses", "wave", "--width", "160", "--out", tmp_path / "out")
    assert code == 1
    assert str(IKStatus.ITERATION_LIMIT) in out
    assert (tmp_path / "out" / "trajectory.csv").exists()


@pytest.mark.slow
def test_cables_with_friction_follow_a_trajectory(run: Run, starfish: Path, tmp_path: Path) -> None:
    robot = tmp_path / "rubbing"
    hs.save_robot(hs.load_robot(starfish), robot)
    text = (robot / "robot.toml").read_text()
    (robot / "robot.toml").write_text(text.replace("[[cable]]\n", "[[cable]]\nfriction = 0.3\n"))
    code, _, errors = run("trajectory", robot, "--poses", "rest", "--out", tmp_path / "out")
    assert code == 0, errors
    assert (tmp_path / "out" / "trajectory.csv").exists()


def test_help_has_an_example(run: Run) -> None:
    assert "Example: hydrostat trajectory" in run("trajectory", "--help")[1]
