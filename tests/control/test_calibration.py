"""motors.toml. Oracle: what is written is read again."""

from dataclasses import replace
from pathlib import Path

import pytest
from builders import strip_robot

from hydrostat.control import BusLink, Calibration, open_bus
from hydrostat.errors import HydrostatError


@pytest.mark.parametrize("name", ["left", 'the "left" one', "back\\slash", "größer"])
def test_names_of_winches_are_kept_whatever_is_in_them(name: str, tmp_path: Path) -> None:
    robot = strip_robot(columns=4, rows=1)
    winches = tuple(replace(winch, name=name) for winch in robot.winches[:1])
    cables = tuple(replace(cable, winch=name) for cable in robot.cables[:1])
    robot = replace(robot, winches=winches, cables=cables)
    kept = Calibration(tuple(replace(motor, zero=0.25) for motor in Calibration.usual(robot).motors))
    kept.write(tmp_path)
    assert Calibration.read(tmp_path, robot) == kept
    assert "of this one robot" in kept.write(tmp_path).read_text("utf-8").splitlines()[0]
    unknown = Calibration.usual(robot).write(tmp_path).read_text("utf-8")
    assert "hydrostat calibrate finds where cables begin to pull" in unknown.splitlines()[0]


def test_emulated_motors_of_a_calibration_that_was_cut_short_say_so() -> None:
    robot = strip_robot(columns=4, rows=1)
    calibration = Calibration.usual(robot)  # no zero is known
    link = BusLink(open_bus("emulated", robot, calibration, lambda taken: 9.0 * taken), robot.winches, calibration)
    link.identify()
    with pytest.raises(HydrostatError, match="motors cannot be armed: first calibrate them"):
        link.arm()
    link.close()


def test_a_key_of_400_letters_is_cut(tmp_path: Path) -> None:
    (tmp_path / "motors.toml").write_text(f'[[motor]]\nwinch = "left"\n{"a" * 400} = 1\n')
    with pytest.raises(HydrostatError, match="unknown key") as told:
        Calibration.read(tmp_path, strip_robot(columns=4, rows=1))
    assert len(str(told.value).replace(str(tmp_path), "")) < 200


def test_a_number_of_400_digits_is_refused(tmp_path: Path) -> None:
    for key in ("number", "current"):
        values = {"number": "1", "current": "0.5", key: "9" * 400}
        text = "".join(f"{name} = {value}\n" for name, value in values.items())
        (tmp_path / "motors.toml").write_text(f'[[motor]]\nwinch = "left"\nradius = "5 mm"\n{text}')
        with pytest.raises(HydrostatError, match=f"{key} cannot be 999") as told:
            Calibration.read(tmp_path, strip_robot(columns=4, rows=1))
        assert len(str(told.value)) < 300
