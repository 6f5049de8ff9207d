"""The picture of branches; oracle: the lines and words that matplotlib holds against the branches."""

from pathlib import Path

import numpy as np
import pytest
from arches import arch
from builders import box_robot, strip_robot
from matplotlib.figure import Figure

from hydrostat.errors import InputError
from hydrostat.plot import draw_branches, save_png
from hydrostat.simulation import Simulation, continue_branch, find_equilibria

pytestmark = pytest.mark.usefixtures("unchecked")


def words(figure: Figure) -> list[str]:
    texts = [text.get_text() for axes in figure.axes for text in axes.texts]
    return texts + [text.get_text() for text in figure.texts]


def test_lines_are_the_branches(tmp_path: Path) -> None:
    """A stable part, a dashed one, the fold between them, and a numbered dot for each pose."""
    simulation = Simulation(arch())
    found = find_equilibria(simulation, {"down": 0.145}, count=6)
    assert len(found.poses) == 2
    there = continue_branch(simulation, simulation.solve({}), found.contractions)
    down = next(one.pose for one in found.poses if one.pose.markers["top"][1] < 0)
    back = continue_branch(simulation, down, {}, around_folds=True)
    figure = draw_branches(simulation.robot, found, [there, back])
    chart = figure.axes[-1]
    lines = [line for line in chart.lines if len(line.get_xdata()) > 1]
    assert [line.get_linestyle() for line in lines] == ["-", "-", "--"]
    moved = 1e3 * np.array([np.linalg.norm(point.pose.markers["top"] - [0, 0.02]) for point in there.points])
    assert lines[0].get_ydata() == pytest.approx(moved)
    assert lines[0].get_xdata() == pytest.approx([100 * point.share for point in there.points])
    fold = next(line for line in chart.lines if len(line.get_xdata()) == 1)
    assert fold.get_xdata() == pytest.approx([100 * (1 - back.folds[0])])
    for index, one in enumerate(found.poses, 1):
        assert f"{index}: {one.pose.energy:.4g} J" in words(figure)
        assert str(index) in words(figure)
    assert any("2 poses at the same contractions" in text for text in words(figure))
    assert save_png(figure, tmp_path / "branches.png").read_bytes().startswith(b"\x89PNG")


def test_charts_begin_a_little_before_branches_part() -> None:
    """Half as far before the first fold as that is before the end; and the whole way where nothing folds."""
    simulation = Simulation(arch())
    found = find_equilibria(simulation, {"down": 0.145}, count=3)
    down = next(one.pose for one in found.poses if one.pose.markers["top"][1] < 0)
    back = continue_branch(simulation, down, {})
    chart = draw_branches(simulation.robot, found, [back]).axes[-1]
    fold = 100 * (1 - back.folds[0])
    assert chart.get_xlim()[0] == pytest.approx(min(fold - 0.5 * (100 - fold), 90.0))
    heights = [line.get_ydata()[np.asarray(line.get_xdata()) >= chart.get_xlim()[0]] for line in chart.lines]
    assert chart.get_ylim()[0] < min(map(np.min, heights))
    assert chart.get_ylim()[1] > max(map(np.max, heights))
    there = continue_branch(simulation, simulation.solve({}), found.contractions)
    assert draw_branches(simulation.robot, found, [there]).axes[-1].get_xlim()[0] <= 0


@pytest.mark.parametrize("make", [strip_robot, box_robot])
def test_one_pose_has_no_numbers(make) -> None:
    simulation = Simulation(make())
    found = find_equilibria(simulation, np.array([0.01, 0.0]), count=2)
    branch = continue_branch(simulation, simulation.solve({}), found.contractions)
    figure = draw_branches(simulation.robot, found, [branch])
    assert "one pose from 2 starts" in words(figure)
    assert figure.axes[-1].get_legend() is None
    assert "1" not in words(figure)


def test_without_branches_the_poses_are_drawn() -> None:
    """As for cables with friction: there is nothing that a chart could show."""
    simulation = Simulation(strip_robot())
    found = find_equilibria(simulation, np.array([0.01, 0.0]), count=1)
    figure = draw_branches(simulation.robot, found, [])
    assert all(axes.get_title(loc="left") == "" for axes in figure.axes)
    branch = continue_branch(simulation, simulation.solve({}), found.contractions)
    charted = draw_branches(simulation.robot, found, [branch])
    assert charted.axes[-1].get_title(loc="left") == "tip moved [mm]"
    assert len(figure.axes) == len(charted.axes) - 1
    assert figure.get_figheight() < charted.get_figheight()


def test_no_contraction_is_refused() -> None:
    simulation = Simulation(strip_robot())
    found = find_equilibria(simulation, {}, count=1)
    with pytest.raises(InputError, match="contract a winch"):
        draw_branches(simulation.robot, found, [])
