"""Drives in robot.toml. Oracle: what was written, and the line that tells each fault."""

from math import radians
from pathlib import Path

import pytest
from robot_files import GOOD, load

from hydrostat.errors import InputError
from hydrostat.robot import load_robot, merged_text, save_robot, scaled_robot

DRIVEN = GOOD.replace("radius = 12\n", 'radius = 12\ndrive = "servo"\n')
SERVO = '[[drive]]\nname = "servo"\nat = [-20, 0]\nmin = "-30 deg"\nmax = "77.7 deg"\n'
STAGE = '[[drive]]\nname = "servo"\nslide = [0, 1]\nmin = "-1.5 mm"\nmax = "3 mm"\n'


LOAD = '[[load]]\nname = "push"\nmarker = "tip"\nforce = ["0 N", "-1 N"]\ndrive = "thumb"\n'
THUMB = '[[drive]]\nname = "thumb"\nmin = -0.5\nmax = 2\n'
PRESSED = GOOD + LOAD + THUMB


@pytest.mark.parametrize("drive", [SERVO, STAGE, SERVO[: SERVO.index("min")], f"{SERVO}\n{LOAD}\n{THUMB}"])
def test_what_is_written_is_read(drive: str, tmp_path: Path) -> None:
    robot = load(tmp_path / "a", f"{DRIVEN}\n{drive}")
    save_robot(robot, tmp_path / "b")
    assert load_robot(tmp_path / "b") == robot
    text = f"{DRIVEN}\n# of the leg\n{drive}"
    assert merged_text(text, robot) == text


def test_limits_are_in_their_own_units(tmp_path: Path) -> None:
    servo = load(tmp_path / "a", f"{DRIVEN}\n{SERVO}")
    stage = load(tmp_path / "b", f"{DRIVEN}\n{STAGE}")
    assert servo.drives[0].limits == (radians(-30), radians(77.7))
    assert scaled_robot(servo, 2.0).drives[0].limits == servo.drives[0].limits
    assert scaled_robot(stage, 2.0).drives[0].limits == pytest.approx((-3e-3, 6e-3))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (GOOD + SERVO, r'drive\[0\]: moves no pin. Add drive = "servo" to a \[\[pin\]\]'),
        (DRIVEN, r'pin\[0\].drive: unknown drive "servo". The robot has no drives.'),
        (DRIVEN + SERVO + STAGE, r'drive\[1\].name: "servo" is already the name of a drive or winch'),
        (
            DRIVEN + SERVO.replace("at = [-20, 0]\n", ""),
            r'drive\[0\].min is the text "-30 deg". .* A drive of pins has at',
        ),
        (DRIVEN + STAGE.replace("[0, 1]", "[0, 0]"), r"drive\[0\].slide has no length; give a direction"),
        (DRIVEN + SERVO.replace("[-20, 0]", "[0, 0, 0]\naxis = [0, 0, 0]"), r"drive\[0\].axis has no length"),
        (DRIVEN + SERVO.replace("[-20, 0]", "[0, 0, 0]\naxis = [0, 0, 1]"), r"drive\[0\].at has 3 coordinates, but"),
        (DRIVEN + SERVO.replace("[-20, 0]", "[0, 0, 0]"), r"drive\[0\]: in space a rotation needs axis"),
        (DRIVEN + SERVO.replace("-30 deg", "30 deg"), r"drive\[0\].min must not be above 0, where the robot rests"),
        (DRIVEN + SERVO.replace("77.7 deg", "400 deg"), r"drive\[0\].max is 400 deg; .* within one turn, 360 deg"),
        (DRIVEN + SERVO.replace("77.7 deg", "77.7 mm"), r"drive\[0\].max: .*mm.* an angle"),
        (DRIVEN + STAGE.replace('max = "3 mm"\n', ""), r"drive\[0\]: a slide needs its travel"),
        (PRESSED.replace(LOAD, ""), r'drive "thumb" scales no load. Add drive = "thumb" to a \[\[load\]\]'),
        (GOOD + THUMB.replace('name = "thumb"', "name = 1"), "name: 1 is not text"),
        (GOOD + THUMB.replace("max = 2", "max = true"), r"drive\[0\].max: true is not a number"),
        (GOOD + LOAD, r'load\[0\].drive: unknown drive "thumb". The robot has no drives of loads.'),
        (DRIVEN + LOAD.replace("thumb", "servo") + SERVO, r'load\[0\].drive: unknown drive "servo". The robot has no'),
        (DRIVEN.replace("servo", "thumb") + LOAD + THUMB, r'pin\[0\].drive: unknown drive "thumb". The robot has no'),
        (PRESSED.replace("max = 2", 'max = "2 N"'), r'drive\[0\].max is the text "2 N". A share of loads is a number'),
        (
            PRESSED.replace("max = 2", ""),
            r"drive\[0\].max is missing. .* e.g. max = 2. A drive of pins has at or slide",
        ),
        (PRESSED.replace("max = 2", "max = 200"), r"drive\[0\].max must be a share .* from 0 to 100, not 200"),
        (PRESSED.replace("-0.5", "0.5"), r"drive\[0\].min must be a share of the loads from -100 to 0, not 0.5"),
        (PRESSED.replace('["0 N", "-1 N"]', '["0 N", "-1 N"]\npath = [{ time = "0 s", share = 1 }]'), "drive: .* path"),
        (PRESSED.replace('force = ["0 N", "-1 N"]', 'mass = "1 g"'), r"load\[0\].drive: not available with mass"),
        (DRIVEN.replace('winch = "left"', 'winch = "left"\nfriction = 0.2') + SERVO, r"drive\[0\]: not available with"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(text: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told) as caught:
        load(tmp_path, text)
    assert "\n" not in str(caught.value)
