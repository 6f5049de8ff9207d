"""Sheets in robot.toml. Oracle: what was written, and the line that tells each fault."""

from pathlib import Path

import pytest
from robot_files import GOOD, load

from hydrostat.errors import InputError
from hydrostat.robot import load_robot, save_robot, scaled_robot

FELT = '[[sheet]]\nname = "felt"\nmaterial = { young = "2 MPa", poisson = 0.3, density = "300 kg/m^3" }\n'
FELT += 'thickness = "1 mm"\n'
PATCH = FELT.replace("felt", "patch") + 'on = "faces"\nwrinkles = true\nshape = "box"\nat = [-9, -9]\nto = [9, 9]\n'


def test_what_is_written_is_read(tmp_path: Path) -> None:
    """A body of 60 x 40 x 20 mm."""
    robot = load(tmp_path / "a", f"{GOOD}\n{FELT}{PATCH}")
    whole, patch = robot.sheets
    assert whole.find_area(robot.body.mesh, robot.body.thickness) == pytest.approx(2 * 24e-4 + 0.2 * 0.02)
    assert patch.wrinkles
    assert patch.find_area(robot.body.mesh, robot.body.thickness) < 24e-4
    save_robot(robot, tmp_path / "b")
    assert load_robot(tmp_path / "b") == robot
    scaled = scaled_robot(robot, 2.0).sheets[1]
    assert scaled.to == pytest.approx((0.018, 0.018))
    assert scaled.thickness == 1e-3


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (PATCH.replace("true", "1"), r"sheet\[0\].wrinkles: 1 is neither true nor false; write one of them"),
        (FELT.replace("1 mm", "0 mm"), r"sheet\[0\].thickness must be finite and above 0"),
        (FELT.replace("1 mm", "9 mm"), r"sheet\[0\].thickness of 9 mm is above 6 mm, a tenth of the body"),
        (
            FELT.replace('thickness = "1 mm"', ""),
            r'sheet\[0\].thickness: the key "thickness" is missing; write thickness = "0.8 mm"',
        ),
        (
            FELT.replace(" }", ', viscosity = "2 Pa s" }'),
            r"sheet\[0\].material: a sheet has young, poisson and density",
        ),
        (FELT + "at = [0, 0]", r"sheet\[0\]: a region needs its shape, such as box"),
        (PATCH.replace("9", "900").replace("-900", "800"), r'sheet\[0\]: "patch" covers no facet of the skin; move'),
        (PATCH.replace("-9]", "-9, 0]").replace("9]", "9, 3]"), r"sheet\[0\]: has 3 coordinates, but the body has 2"),
        (PATCH.replace("faces", "front"), r'sheet\[0\].on: "front" is not known; allowed are: skin, faces or outline'),
        (FELT + FELT, r'sheet\[1\].name: there are two of the name "felt"'),
    ],
)
def test_what_is_wrong_is_told_in_one_line(table: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told) as caught:
        load(tmp_path, f"{GOOD}\n{table}")
    assert "\n" not in str(caught.value)
