"""`hydrostat calibrate` on emulated motors. Oracle: they stand at their zeros, which only they know."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from hydrostat.control import read_calibration
from hydrostat.robot import load_robot

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def copy(starfish: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(starfish, tmp_path / "starfish"))


@pytest.mark.slow
def test_emulated_motors_are_calibrated_and_saved(run: Run, copy: Path) -> None:
    code, out, err = run("calibrate", copy, "--port", "emulated")
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert all(line.startswith("emulated: ") for line in lines)
    assert sum("measured" in line for line in lines) == 3
    assert not any("note:" in line for line in lines)
    motors = read_calibration(copy, load_robot(copy)).motors
    assert [motor.zero for motor in motors] == pytest.approx([0.0] * 3, abs=5e-4 / 0.006)
    page = (copy / "calibration.html").read_text("utf-8")
    assert "Nothing stands out." in page
    assert page.count("<svg") == 3


@pytest.mark.parametrize(
    ("port", "told"),
    [("nonsense", "write emulated, or one such as"), ("dynamixel:/dev/nowhere", "/dev/nowhere cannot be opened")],
)
def test_ports_that_are_none_leave_nothing(run: Run, copy: Path, port: str, told: str) -> None:
    before = sorted(copy.iterdir())
    code, _, err = run("calibrate", copy, "--port", port)
    assert code in (1, 2)
    assert told in err
    assert err.count("\n") == 1
    assert sorted(copy.iterdir()) == before
