"""Rods in robot.toml. Oracle: what was written, and the line that tells each fault."""

from dataclasses import replace
from pathlib import Path

import pytest
from robot_files import GOOD, RECTANGLE, load

from hydrostat.errors import InputError
from hydrostat.robot import find_risks, load_robot, save_robot, scaled_robot

WIRE = '[[rod]]\nname = "spine"\npoints = [[-20, 0], [20, 0]]\ndiameter = "0.8 mm"\nyoung = "200 GPa"\n'
GIVEN = (
    '[[rod]]\nname = "strip"\npoints = [[-20, 5], [20, 5]]\naxial_stiffness = "500 N"\n'
    'bending_stiffness = "2500 N mm^2"\n'
)

SPINE = Path(__file__).parents[2] / "examples" / "spine"


def test_what_is_written_is_read(tmp_path: Path) -> None:
    robot = load(tmp_path / "a", f"{GOOD}\n{WIRE}{GIVEN}")
    assert robot.rods[1].stiffnesses == (500.0, 2.5e-3)
    save_robot(robot, tmp_path / "b")
    assert load_robot(tmp_path / "b") == robot
    assert scaled_robot(robot, 2.0).rods[0].diameter == pytest.approx(1.6e-3)


def test_a_rod_in_space_may_resist_twist(tmp_path: Path) -> None:
    robot = load_robot(SPINE)
    robot = replace(robot, rods=(replace(robot.rods[0], torsional_stiffness=2.3e-3),))
    save_robot(robot, tmp_path)
    assert load_robot(tmp_path).rods == robot.rods
    assert scaled_robot(robot, 2.0).rods[0].torsional_stiffness == pytest.approx(16 * 2.3e-3)  # as EI, by diameter^4


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (WIRE.replace("[20, 0]", "[90, 0]"), r"rod\[0\].points\[1\] = \[90, 0\] lies 60 mm outside the body"),
        (WIRE.replace(", [20, 0]", ""), r"rod\[0\].points: a rod needs at least two"),
        (WIRE.replace("[20, 0]", "[-20, 0]"), r"rod\[0\].points\[1\] is the one before it"),
        (WIRE.replace("[20, 0]]", "[20, 0], [0, 1]]"), r"rod\[0\].points\[1\]: the rod turns by 177 degrees there"),
        (WIRE.replace("[20, 0]", "[20, 0, 0]"), r"rod\[0\].points\[1\] has 3 coordinates, points\[0\] has 2"),
        (WIRE.replace("0.8 mm", "0 mm"), r"rod\[0\].diameter must be finite and above 0"),
        (WIRE.replace('young = "200 GPa"', ""), r"rod\[0\]: give diameter and young, or axial_stiffness"),
        (
            GIVEN.replace("N mm^2", "N"),
            r"rod\[0\].bending_stiffness: .* does not measure a bending or torsional stiffness",
        ),
        (WIRE + 'torsional_stiffness = "9 N mm^2"\n', r"rod\[0\].torsional_stiffness: a rod in a flat body does not"),
        (WIRE + WIRE, r'rod\[1\].name: there are two of the name "spine"'),
    ],
)
def test_what_is_wrong_is_told_in_one_line(table: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told) as caught:
        load(tmp_path, f"{GOOD}\n{table}")
    assert "\n" not in str(caught.value)


def test_a_rod_that_leaves_or_sticks_out_is_told(tmp_path: Path) -> None:
    """In a drawing with a notch 20 mm deep, and thicker than the body of 20 mm or 1 mm too near its edge."""
    notched = RECTANGLE.replace('<rect width="60" height="40"/>', '<path d="M0 0H60V40H40V20H20V40H0Z"/>')
    over = WIRE.replace("[[-20, 0], [20, 0]]", "[[-20, -10], [20, -10]]")
    with pytest.raises(InputError, match=r"rod\[0\].points: the rod leaves the body by 10 mm at \[0, -10\]; lead it"):
        load(tmp_path / "a", f"{GOOD.replace('[20, -10]', '[-11, -6]')}\n{over}", svg=notched)
    thick = load(tmp_path / "b", f"{GOOD}\n{WIRE.replace('0.8', '22')}")
    near = load(tmp_path / "c", f"{GOOD}\n{WIRE.replace(', 0]', ', 18]').replace('0.8', '6')}")
    found = [line for robot in (thick, near) for line in find_risks(robot) if line.startswith("rod")]
    assert [line.partition(" at ")[0] for line in found] == [
        "rod[0] spine: 22 mm thick, it sticks 1 mm out of the body",
        "rod[0] spine: 6 mm thick, it sticks 1 mm out of the body",
    ]
