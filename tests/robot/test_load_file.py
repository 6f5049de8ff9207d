"""Loads in robot.toml. Oracle: what was written, and the line that tells each fault."""

from pathlib import Path

import numpy as np
import pytest
from robot_files import GOOD, load

from hydrostat.errors import InputError
from hydrostat.robot import inflated_robot, load_robot, merged_text, save_robot, scaled_robot

HUNG = '[[load]]\nname = "weight"\nmarker = "tip"\nmass = "20 g"\n'
PUSH = '[[load]]\nname = "push"\nat = [0, 0]\nforce = ["0.5 N", "-1 N"]\n'
BLOWN = '[[load]]\nname = "air"\nat = [0, 0]\npressure = "2 kPa"\n'
TURNED = '[[load]]\nname = "turn"\nmarker = "tip"\nmoment = "-5 N mm"\n'
PATH = 'path = [{ time = "0 s", share = 0 }, { time = "0.5 s", share = 1.5 }]\n'
HEAVY = 'gravity = "-y"\n'


def text(*tables: str, gravity: str = HEAVY) -> str:
    return GOOD.replace('name = "small"\n', f'name = "small"\n{gravity}') + "\n" + "\n".join(tables)


def test_what_is_written_is_read(tmp_path: Path) -> None:
    robot = load(tmp_path / "a", text(HUNG, PUSH, TURNED + PATH))
    assert robot.load_forces() == pytest.approx(np.array([[0.0, -0.02 * 9.80665], [0.5, -1.0], [0.0, 0.0]]))
    assert robot.loads[2].moment == (-5e-3,)
    assert [robot.loads[2].share_at(instant) for instant in (0.0, 0.25, 2.0)] == [0.0, 0.75, 1.5]
    save_robot(robot, tmp_path / "b")
    assert load_robot(tmp_path / "b") == robot
    assert merged_text(text(HUNG, "# mine\n" + PUSH, TURNED + PATH), robot) == text(
        HUNG, "# mine\n" + PUSH, TURNED + PATH
    )


def test_loads_go_along(tmp_path: Path) -> None:
    robot = load(tmp_path, text(HUNG, PUSH, TURNED))
    lifted = inflated_robot(robot)
    assert lifted.load_forces().shape == (3, 3)
    assert lifted.loads[2].moment == (0.0, 0.0, -5e-3)
    shift = scaled_robot(robot, 2.0).load_points()
    assert shift == pytest.approx(2 * robot.load_points())


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (HUNG.replace("tip", "top"), r'load\[0\].marker: unknown marker "top". Available: tip.'),
        (PUSH.replace("[0, 0]", "[90, 0]"), r"load\[0\].at = \[90, 0\] lies 60 mm outside the body"),
        (PUSH.replace(', "-1 N"', ', "-1 N", "2 N"'), r"load\[0\].force has 3 entries, but the body has 2 axes"),
        (PUSH.replace('"-1 N"', "-1"), r"load\[0\].force\[1\]: -1 has no unit"),
        (PUSH + 'mass = "2 g"\n', r"load\[0\]: give either force, or mass"),
        (PUSH + 'marker = "tip"\n', r"load\[0\]: give either marker, or at"),
        (HUNG.replace("20 g", "0 g"), r"load\[0\].mass must be finite and above 0"),
        (BLOWN, r"load\[0\].at: a pressure fills a hole that the body closes, and this point is in none"),
        (
            BLOWN.replace("at = [0, 0]", 'marker = "tip"'),
            r"load\[0\].*pressure needs at",
        ),
        (BLOWN.replace("2 kPa", "2 N"), r"load\[0\].pressure: .* does not measure a pressure"),
        (
            TURNED.replace('"-5 N mm"', '["1 N m", "1 N m", "1 N m"]'),
            r"load\[0\].moment has 3 entries; this body",
        ),
        (TURNED.replace('"-5 N mm"', "0.01"), r"load\[0\].moment: 0.01 has no unit"),
        (TURNED.replace("N mm", "N"), r"load\[0\].moment: .* does not measure a torque"),
        (HUNG + PATH, r"load\[0\].path: a hung mass is always there; give its weight as a force"),
        (PUSH + PATH.replace("0.5 s", "0 s"), r"load\[0\].path: its times must rise from 0 s; 0 s comes after 0 s"),
        (PUSH + PATH.replace("1.5", "1e9"), r"load\[0\].path: a share must be from -100 to 100, not 1e\+09"),
        (PUSH + PATH.replace("0.5 s", "5 N"), r"load\[0\].path\[1\].time.* does not measure a time"),
        (PUSH + PUSH, r'load\[1\].name: there are two of the name "push"'),
    ],
)
def test_what_is_wrong_is_told_in_one_line(table: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told) as caught:
        load(tmp_path, text(table))
    assert "\n" not in str(caught.value)


def test_a_mass_needs_gravity(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"load\[0\].mass weighs nothing without gravity"):
        load(tmp_path, text(HUNG, gravity=""))
