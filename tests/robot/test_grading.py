"""Graded stiffness in robot.toml and Python. Oracle: the function, and the line that tells each fault."""

from pathlib import Path

import numpy as np
import pytest
from robot_files import GOOD, edit, load

from hydrostat.errors import InputError
from hydrostat.robot import inflated_robot, load_robot, save_robot
from hydrostat.robot.scaled import scaled_robot

GRADED = edit(GOOD, 'material = "p', 'grading = "grading.csv"\nmaterial = "p')


def stiffness(points: np.ndarray) -> np.ndarray:
    return 2.0 + points[:, 0] / 0.03


def test_what_is_written_is_read(tmp_path: Path) -> None:
    """A body from -30 to 30 mm, also twice as large, in a finer mesh and inflated."""
    robot = load(tmp_path / "a", GOOD).with_grading(stiffness)
    middles = robot.body.mesh.nodes[robot.body.mesh.elements].mean(axis=1)
    assert robot.body.stiffness_factors == pytest.approx(stiffness(middles), rel=1e-12)
    save_robot(robot, tmp_path / "b")
    again = load_robot(tmp_path / "b")
    assert again == robot
    assert (again.body.stiffness_factors == robot.body.stiffness_factors).all()
    assert scaled_robot(robot, 2.0).body.stiffness_factors.max() == pytest.approx(stiffness(middles).max())
    quadratic = robot.body.with_elements("quadratic")
    assert (quadratic.stiffness_factors == robot.body.stiffness_factors.repeat(4)).all()
    deep = inflated_robot(robot).body
    far = deep.mesh.nodes[deep.mesh.elements].mean(axis=1)
    assert np.abs(deep.stiffness_factors - stiffness(far)).max() < 12 / 30  # an element of 12 mm
    assert robot.with_grading(None) == load(tmp_path / "a", GOOD)
    assert (robot.with_grading(lambda _: 3.0).body.stiffness_factors == 3.0).all()  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (
            "x_mm,factor\n1,2\n",
            "body.grading: grading.csv: needs the columns x_mm, y_mm, in space z_mm, and factor",
        ),
        ("x_mm,y_mm,factor\n", "needs the columns"),
        ("x_mm,y_mm,factor\n1,2,3\n1,2\n", "grading.csv, line 3: must be 3 numbers, not 1,2"),
        ("x_mm,y_mm,factor\n1,2,a\n", "grading.csv, line 2: must be 3 numbers, not 1,2,a"),
        ("x_mm,y_mm,factor\n1,inf,1\n", "has a number that is not finite"),
        ("x_mm,y_mm,factor\n1,2,0\n", "each factor must be above 0; at 1, 2 mm it is 0"),
        ("x_mm,y_mm,factor\n1,2,1\n1,3,1e6\n", r"the largest factor is 1e\+06 times the least"),
        ("x_mm,y_mm,z_mm,factor\n1,2,3,4\n", "body.grading: grading has coordinates in space, but the body is flat"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(table: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "grading.csv").write_text(table)
    with pytest.raises(InputError, match=told) as caught:
        load(tmp_path, GRADED)
    assert "\n" not in str(caught.value)


def test_a_table_of_a_spreadsheet_is_read(tmp_path: Path) -> None:
    """With the mark of UTF-8, spaces and the ends of lines of Windows."""
    (tmp_path / "grading.csv").write_bytes(b"\xef\xbb\xbfx_mm, y_mm, factor\r\n0, 0, 3\r\n")
    assert (load(tmp_path, GRADED).body.stiffness_factors == 3.0).all()


def test_a_function_gives_one_number_for_each_point(tmp_path: Path) -> None:
    robot = load(tmp_path, GOOD)
    for wrong in (lambda points: points, lambda points: points[:-1, 0] + 1, lambda _: "stiff", lambda _: -1.0):
        with pytest.raises(InputError):
            robot.with_grading(wrong)  # type: ignore[arg-type]
