"""The picture of a motion; oracle: the lines that matplotlib holds against the table."""

import numpy as np
import pytest
from builders import strip_robot
from matplotlib.colors import to_hex

from hydrostat.drawing import Color
from hydrostat.plot import draw_motion
from hydrostat.simulation import MotionTable


def test_lines_are_the_table() -> None:
    robot = strip_robot(columns=4, rows=2)
    random = np.random.default_rng(0)
    table = MotionTable(
        times=np.linspace(0, 1, 5),
        contractions=random.random((5, 2)),
        markers=random.random((5, 1, 2)),
        tensions=random.random((5, 2)),
        energies=random.random((5, 2)),
    )
    figure = draw_motion(robot, table)
    markers, winches, cables = figure.axes
    moved = 1e3 * np.linalg.norm(table.markers[:, 0] - table.markers[0, 0], axis=1)
    assert markers.lines[0].get_ydata() == pytest.approx(moved)
    for column in range(2):
        assert winches.lines[column].get_ydata() == pytest.approx(1e3 * table.contractions[:, column])
        assert cables.lines[column].get_ydata() == pytest.approx(table.tensions[:, column])
        color = Color.of_winches(robot.winches)[robot.cables[column].winch]
        assert to_hex(winches.lines[column].get_color()) == to_hex(cables.lines[column].get_color()) == color
        assert cables.lines[column].get_xdata() == pytest.approx(table.times)
