"""Pictures of trajectories and of poses without markers. Oracle: the lines that matplotlib holds, the trajectory."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import strip_robot
from matplotlib.colors import to_hex

from hydrostat.drawing import Color
from hydrostat.geometry import Outline
from hydrostat.ik import CenterOfMassTarget, ShapeTarget, Trajectory, TrajectoryOptions, solve_ik, solve_ik_trajectory
from hydrostat.plot import draw_reached, draw_trajectory, inline_svg, trajectory_frames
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation

pytestmark = pytest.mark.usefixtures("unchecked")

RECTANGLE = np.array([[0.0, -0.025], [0.2, -0.05], [0.2, 0.0], [0.0, 0.025]])


@cache
def made() -> tuple[Robot, Trajectory]:
    robot = strip_robot(columns=10, rows=2)
    simulation = Simulation(robot)
    goals = [{"tip": (0.19, 0.05)}, {"tip": (0.195, -0.03)}]
    options = TrajectoryOptions(rate=20)
    return robot, solve_ik_trajectory(simulation, goals, hold=0.3, loop=True, options=options)


@pytest.mark.slow
def test_lines_are_the_trajectory() -> None:
    robot, trajectory = made()
    figure = draw_trajectory(robot, trajectory)
    charts = [axes for axes in figure.axes if not axes.images]
    values = (trajectory.contractions, trajectory.speeds, trajectory.accelerations)
    for axes, wanted in zip(charts, values, strict=True):
        colors = Color.of_winches(robot.winches)
        lines = {line.get_label(): line for line in axes.lines if line.get_label() in colors}
        for column, name in enumerate(trajectory.winches):
            assert lines[name].get_ydata() == pytest.approx(1e3 * wanted[:, column])
            assert to_hex(lines[name].get_color()) == colors[name]
    dashed = [
        float(np.ravel(line.get_ydata())[0]) for line in charts[1].lines if to_hex(line.get_color()) == Color.ERROR
    ]
    assert dashed == pytest.approx([-50.0, 50.0])


def test_each_keyframe_has_a_portrait_with_its_name() -> None:
    robot, trajectory = made()
    titles = [axes.get_title() for axes in draw_trajectory(robot, trajectory).axes if axes.images]
    assert [title.split("\n")[0] for title in titles] == ["start", "target", "target", "rest"]


def test_a_robot_without_cables_and_markers_stays_at_rest() -> None:
    robot = replace(strip_robot(columns=6, rows=2), winches=(), cables=(), markers=())
    simulation = Simulation(robot)
    trajectory = solve_ik_trajectory(simulation, [simulation.rest], path="straight")
    assert trajectory.lines() == ["0.02 s keyframe 1: as given", "0.02 s in total, 2 samples; path straight"]
    assert len(draw_trajectory(robot, trajectory).axes) == 4


def test_frames_are_samples_at_equal_times() -> None:
    _, trajectory = made()
    frames, step = trajectory_frames(trajectory)
    assert frames[0].nodes is trajectory.poses[0].nodes
    assert (frames[-1].nodes == trajectory.keyframes[-1].pose.nodes).all()
    number = len(frames) // 2
    time = number * step
    nearest = trajectory.poses[int(np.argmin(np.abs(trajectory.times - time)))]
    tips = np.linalg.norm(frames[number].nodes - nearest.nodes, axis=1).max()
    assert tips < 0.003
    assert {frame.words.split(":")[0] for frame in frames} == {"to target", "target", "to rest", "rest"}


def test_a_pose_without_markers_shows_the_shape_that_is_wanted() -> None:
    robot = strip_robot(columns=10, rows=2)
    outline = Outline(exterior=RECTANGLE)
    reached = solve_ik(Simulation(robot), objectives=[ShapeTarget(outline=outline)])
    assert reached.target is None
    figure = draw_reached(robot, reached, outline=outline)
    dashed = [line for line in figure.axes[0].lines if line.is_dashed() and to_hex(line.get_color()) == Color.ERROR]
    assert len(dashed) == 1
    ring = np.column_stack(dashed[0].get_data())
    assert ring[0] == pytest.approx(ring[-1])
    assert ring[:-1] == pytest.approx(1e3 * outline.exterior)
    words = [text.get_text() for text in figure.texts]
    assert f"outline error {1e3 * reached.errors['outline']:.2f} mm" in words


def test_a_pose_of_any_goal_can_be_drawn() -> None:
    robot = strip_robot(columns=10, rows=2)
    reached = solve_ik(Simulation(robot), objectives=[CenterOfMassTarget(target=(0.1, 0.01))])
    assert "center of mass error" in inline_svg(draw_reached(robot, reached), name="it", label="")
