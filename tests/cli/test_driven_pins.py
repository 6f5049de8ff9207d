"""`hydrostat simulate --move`, drives in `hydrostat pose`. Oracle: a body on one servo turns as a rigid one."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hydrostat.robot import load_robot

Run = Callable[..., tuple[int, str, str]]
SHEET = 'xmlns="http://www.w3.org/2000/svg" width="60mm" height="20mm" viewBox="0 0 60 20"'
BAR = f'<svg {SHEET}><path d="M0 0H60V20H0Z"/></svg>'
TEXT = """\
format = 1
name = "bar"
[body]
outline = "bar.svg"
element_size = "10 mm"
thickness = "10 mm"
material = "ecoflex 00-30"
[[pin]]
at = [-30, 0]
radius = 12
drive = "servo"
[[drive]]
name = "servo"
at = [-30, 0]
[[marker]]
name = "tip"
at = [28, 0]
[[pose]]
name = "up"
targets = { tip = [-30, 58] }
"""


@pytest.fixture
def bar(tmp_path: Path) -> Path:
    (tmp_path / "bar.svg").write_text(BAR)
    (tmp_path / "robot.toml").write_text(TEXT)
    return tmp_path


def test_a_servo_turns_a_bar(bar: Path, run: Run) -> None:
    code, out, _ = run("simulate", str(bar), "--move", "servo=-90deg", "--out", str(bar / "out"))
    assert code == 0, out
    pose = json.loads((bar / "out" / "pose.json").read_text())
    tip = np.array(load_robot(bar).marker("tip").at)
    assert pose["drives"]["servo"]["angle_deg"] == pytest.approx(-90)
    np.testing.assert_allclose(pose["markers"]["tip"], [-0.03, -0.03 - tip[0]], atol=1e-9)
    assert (bar / "out" / "pose.png").is_file()


@pytest.mark.slow
def test_a_servo_turns_a_bar_in_time(bar: Path, run: Run) -> None:
    """The last row of motion.csv is the target of the ramp; a table of moves plays the same."""
    times = ("--dynamic", "--duration", "0.2s", "--time-step", "20ms")
    code, out, told = run("simulate", bar, "--move", "servo=5deg", "--ramp", "0.2s", *times, "--out", bar / "ramp")
    assert code == 0, told
    head, *rows = (bar / "ramp" / "motion.csv").read_text().splitlines()
    assert head.split(",")[:2] == ["time_s", "servo_deg"]
    assert float(rows[-1].split(",")[1]) == pytest.approx(5.0)
    moves = bar / "moves.csv"
    moves.write_text("time_s,servo_deg\n0,0\n0.2,200\n")
    code, out, _ = run("simulate", bar, "--play", moves, *times, "--out", bar / "played")
    assert code == 0
    assert "drive servo: 200 deg is outside its range (-180 deg to 180 deg)" in out
    code, _, err = run("simulate", bar, "--play", moves, "--move", "servo=5deg", *times, "--out", bar / "both")
    assert (code, err) == (
        2,
        "hydrostat: error: --play: not available with --contract or --move. Remove one of them.\n",
    )


def test_more_than_a_turn_is_refused_in_degrees(bar: Path, run: Run) -> None:
    code, _, err = run("simulate", str(bar), "--move", "servo=400deg", "--out", str(bar / "out"))
    assert code == 2
    told = "hydrostat: error: --move servo=400deg: 400 deg is more than a turn. Allowed: -360 to 360 deg.\n"
    assert err == told


def test_the_angle_of_a_pose_is_printed(bar: Path, run: Run) -> None:
    code, out, _ = run("pose", str(bar), "--pose", "up", "--out", str(bar / "out"))
    assert code == 0, out
    assert "drives: servo 90 deg" in out


@pytest.mark.parametrize(
    ("value", "told"),
    [
        ("leg=3deg", '--move leg=3deg: unknown drive "leg". Available: servo.'),
        ("servo=3mm", '--move servo=3mm: "mm" does not measure an angle'),
        ("servo", '--move servo: missing "=". Write DRIVE=VALUE'),
        ("servo=1deg,other=2deg", "--move servo=1deg,other=2deg: more than one value. Repeat --move for each."),
    ],
)
def test_what_is_wrong_is_told_in_one_line(value: str, told: str, bar: Path, run: Run) -> None:
    code, _, err = run("simulate", str(bar), "--move", value, "--out", str(bar / "out"))
    assert code != 0
    assert told in err


def test_check_names_the_pin_of_a_rigid_part_and_a_rod_too_short(bar: Path, run: Run) -> None:
    """The pin holds all within 12 mm of x = -30 mm; the part begins there."""
    part = '[[body.part]]\nname = "horn"\nshape = "box"\nat = [-30, -10]\nto = [-10, 10]\nrigid = true\n'
    rod = '[[rod]]\nname = "wire"\npoints = [[0, 0], [3, 0]]\ndiameter = "1 mm"\nyoung = "200 GPa"\n'
    (bar / "robot.toml").write_text(TEXT + part + 'density = "1 g/cm^3"\n' + rod)
    code, out, _ = run("check", str(bar))
    assert code == 0, out
    assert "pin 1 touches rigid part horn and moves by drive servo all of it" in out
    assert "rod 1 wire: 3 mm long, shorter than an element" in out


def test_branches_move_drives(bar: Path, run: Run) -> None:
    code, out, _ = run("branches", str(bar), "--move", "servo=20deg", "--starts", "2", "--out", str(bar / "out"))
    assert code == 0, out
    assert "unique pose on 2 loading paths" in out
    assert json.loads((bar / "out" / "branches.json").read_text())["contractions"]["servo"] == pytest.approx(0.349066)
