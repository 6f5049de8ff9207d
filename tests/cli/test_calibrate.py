"""`hydrostat calibrate` on emulated motors. Oracle: they stand at their zeros, which only they know."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from own_time import run_in_own_time

from hydrostat.control import (
    CALIBRATION,
    EMULATED_CALIBRATION,
    BusLink,
    Calibration,
    WinchPull,
    add_cable_layers,
    open_bus,
)
from hydrostat.errors import HydrostatError
from hydrostat.robot import load_robot

PULL = WinchPull(taut=0.0, places=np.array([-1.0, 0.0, 1.0]), pulls=np.array([0.0, 0.0, 100.0]))
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def copy(starfish: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(starfish, tmp_path / "starfish"))


@pytest.mark.slow
def test_emulated_motors_are_calibrated_and_saved(copy: Path) -> None:
    """Its spools are 1 % larger than told, and cable lies on cable after a turn: by hand 2.09 mm more in 60 mm."""
    code, out, err = run_in_own_time("calibrate", copy, "--motors", "emulated", "--spools", "right")
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert all(line.startswith("emulated: ") for line in lines)
    assert sum("repeatability" in line for line in lines) == 3
    assert not any("warning:" in line for line in lines)
    motors = Calibration.read(copy, load_robot(copy), name=EMULATED_CALIBRATION).motors
    assert not (copy / CALIBRATION).exists(), "what was measured on real motors is another file"
    assert [motor.zero for motor in motors] == pytest.approx([0.0] * 3, abs=5e-4 / 0.006)
    page = (copy / "calibration.html").read_text("utf-8")
    assert "Emulated motors: nothing here was measured on a robot." in page
    assert "Nothing stands out." in page
    assert page.count("<svg") == 4
    assert [bool(motor.curve) for motor in motors] == [True, False, False]
    robot = load_robot(copy)
    known = Calibration.usual(robot).assume_zeros(robot)
    true, ends = add_cable_layers(known).motors[0], np.linspace(0.0, 0.06, 50).tolist()
    beside = [[true.contraction(each.angle(end)) - end for end in ends] for each in (known.motors[0], motors[0])]
    told, measured = np.abs(beside).max(axis=1)
    assert told == pytest.approx(2.09e-3, abs=2e-5)
    assert measured < 4e-4


def test_a_spool_that_is_none_is_named(run: Run, copy: Path) -> None:
    code, _, err = run("calibrate", copy, "--motors", "emulated", "--spools", "right,tail")
    assert (code, err) == (
        2,
        'hydrostat: error: --spools right,tail: unknown winch "tail". Available: right, left, feet, or all.\n',
    )


@pytest.mark.parametrize(
    ("port", "told"),
    [("nonsense", "write emulated, or one such as"), ("dynamixel:/dev/nowhere", "cannot open /dev/nowhere")],
)
def test_ports_that_are_none_leave_nothing(run: Run, copy: Path, port: str, told: str) -> None:
    before = sorted(copy.iterdir())
    code, _, err = run("calibrate", copy, "--motors", port)
    assert code in (1, 2)
    assert told in err
    assert err.count("\n") == 1
    assert sorted(copy.iterdir()) == before


def test_a_restarted_motor_has_no_zero_until_it_is_measured(
    run: Run, copy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A Dynamixel loses its count of turns. Calibration ends before it is measured: no program may arm it."""
    robot = load_robot(copy)
    known = Calibration.usual(robot).assume_zeros(robot)
    known.write(copy, name=EMULATED_CALIBRATION)

    def open_overloaded(*arguments: object) -> object:
        bus = open_bus(*arguments)  # type: ignore[arg-type]
        motor = bus._port.servos[1]  # type: ignore[attr-defined]
        motor.ails = replace(motor.ails, overloaded=True)
        return bus

    def end(*_: object) -> None:
        raise HydrostatError("right: no pull")

    monkeypatch.setattr("hydrostat.control.open_bus", open_overloaded)
    monkeypatch.setattr("hydrostat.control.find_cable_zeros", end)
    monkeypatch.setattr("hydrostat.control.WinchPull.of_robot", lambda _: (PULL,) * 3)
    code, out, err = run("calibrate", copy, "--motors", "emulated", "--restart")
    assert (code, err) == (1, "hydrostat: error: right: no pull\n")
    assert f"restarted: {robot.winches[1].name}\n" in out
    left = Calibration.read(copy, robot, name=EMULATED_CALIBRATION)
    assert [motor.zero for motor in left.motors] == [0.0, None, 0.0]
    bus = open_bus("emulated", robot, known, lambda taken: 0 * taken)
    link = BusLink(bus, robot.winches, left)
    try:
        link.identify()
        with pytest.raises(HydrostatError, match="cannot be armed: first calibrate them"):
            link.arm()
    finally:
        link.close()


def test_emulated_motors_keep_a_file_of_their_own(copy: Path) -> None:
    """Oracle: zeros that are written, one for motors that were measured, one for those that are not there."""
    robot = load_robot(copy)
    usual = Calibration.usual(robot)

    def at(zero: float) -> Calibration:
        return Calibration(tuple(replace(motor, zero=zero) for motor in usual.motors))

    assert Calibration.emulate(None, robot) == Calibration.emulate(copy, robot) == at(0.0)
    at(1.0).write(copy)
    assert Calibration.emulate(copy, robot) == at(1.0), "as real ones, until they are calibrated themselves"
    at(2.0).write(copy, name=EMULATED_CALIBRATION)
    assert (Calibration.read(copy, robot), Calibration.emulate(copy, robot)) == (at(1.0), at(2.0))
