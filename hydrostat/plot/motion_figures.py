"""Figures over time: `draw_motion` of markers, winches and cables, `draw_trajectory` of keyframes and winches."""

from itertools import cycle, pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from hydrostat.arrays import Vector
from hydrostat.drawing import Color
from hydrostat.ik import KeyPose, Trajectory
from hydrostat.plot.chart import DASHES, plain_axes
from hydrostat.plot.frame import Attachments
from hydrostat.plot.labels import shorten
from hydrostat.plot.picture_file import figure_pixels
from hydrostat.plot.robot_figures import draw_portrait
from hydrostat.plot.sheet import WIDTH, new_figure
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, MotionTable
from hydrostat.units import MILLIMETERS


def draw_motion(robot: Robot, table: MotionTable, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """Draw marker displacements, winch contractions and cable tensions over time.

    Displacements are from the first instant. A marker with the name of a winch has its color.
    The title is the robot's name if left out; width in inches.
    """
    figure = Figure(figsize=(width, 0.95 * width), layout="constrained")
    FigureCanvasAgg(figure)
    upper, middle, lower = figure.subplots(3, 1, sharex=True)
    head = shorten(robot.name) if title is None else title
    if head:
        upper.set_title(head, loc="left", color=Color.INK, fontsize=11, fontweight="bold")
    colors = Color.of_winches(robot.winches)
    way = MILLIMETERS * np.linalg.norm(table.markers - table.markers[0], axis=2)
    names = [marker.name for marker in robot.markers]
    others = cycle([color for color in Color.WINCHES if color not in colors.values()] or Color.WINCHES)
    _lines(upper, table.times, way, names, [colors.get(name) or next(others) for name in names])
    upper.set_ylabel("marker moved [mm]")
    winches = [winch.name for winch in robot.winches]
    _lines(middle, table.times, MILLIMETERS * table.contractions, winches, [colors[name] for name in winches])
    middle.set_ylabel("cable taken in [mm]")
    cables = [f"{index + 1} {cable.winch}" for index, cable in enumerate(robot.cables)]
    _lines(lower, table.times, table.tensions, cables, [colors[cable.winch] for cable in robot.cables])
    lower.set_ylabel("tension [N]")
    lower.set_xlabel("time [s]", color=Color.INK)
    lower.set_xlim(table.times[0], max(table.times[-1], table.times[0] + 1e-9))
    return figure


def _lines(axes: Axes, times: np.ndarray, values: np.ndarray, names: list[str], colors: list[str]) -> None:
    """A line for each column; those that move most are named beside their ends, as many as there is place for."""
    plain_axes(axes)
    axes.yaxis.label.set_color(Color.INK)
    dashes = {}
    for column, (name, color) in enumerate(zip(names, colors, strict=True)):
        count = dashes.setdefault(color, 0)
        dashes[color] += 1
        line = values[:, column]
        axes.plot(times, line, color=color, linewidth=1.4, linestyle=DASHES[count % len(DASHES)], label=name)
    most_names = 12  # so many lines are named; of more, the others are only drawn
    if names:
        most = np.argsort(-np.ptp(values, axis=0), kind="stable")[:most_names]
        handles, _ = axes.get_legend_handles_labels()
        shown = sorted(int(index) for index in most)
        axes.legend(
            [handles[index] for index in shown],
            [shorten(names[index]) for index in shown],
            loc="center left",
            bbox_to_anchor=(1.01, 0.5),
            fontsize=8,
            frameon=False,
            labelcolor=Color.INK,
        )


CHART = 1.45  # height of a chart [inch]


def draw_trajectory(robot: Robot, trajectory: Trajectory, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """The poses at the keyframes, then contraction, speed and acceleration of each winch over time.

    Keyframes are upright lines, limits dashed, snaps red. The title is the robot's name if left out; width in inches.
    """
    shown = [("start", 0.0, trajectory.poses[0]), *((key.name, key.time, key.pose) for key in trajectory.keyframes)]
    told = [shown[0], *(one for last, one in pairwise(shown) if last[2].nodes is not one[2].nodes)]
    most_poses = 5  # so many keyframes are drawn: the first ones
    shown = told[: most_poses + 1]  # without poses that are still those before
    images = _portraits(robot, [pose for _, _, pose in shown])
    side = (width - 0.2) / max(len(shown), 3)
    tallest = 1.7  # greatest height of a portrait in the figure [inch]
    tall = min(max(image.shape[0] / image.shape[1] for image in images) * 0.94 * side, tallest)
    top = 0.55 if title != "" else 0.3
    height = top + tall + 0.2 + 3 * CHART + 0.5
    figure = new_figure(width, height)
    _head(figure, shorten(robot.name) if title is None else title, trajectory)
    for index, ((name, time, _), image) in enumerate(zip(shown, images, strict=True)):
        left = 0.1 + (index + (max(3 - len(shown), 0)) / 2) * side
        axes = figure.add_axes((left / width, (height - top - tall) / height, 0.94 * side / width, tall / height))
        axes.imshow(image, interpolation="antialiased")
        axes.set_axis_off()
        axes.set_title(f"{shorten(name)}\n{time:.2f} s", fontsize=7.5, color=Color.INK, pad=2, parse_math=False)
    _charts(figure, robot, trajectory, height - top - tall - 0.2)
    return figure


def _portraits(robot: Robot, poses: list[Equilibrium]) -> list[np.ndarray]:
    """Pictures of poses, all in one frame, without the border that is empty in all."""
    carried, shapes = Attachments(robot), [pose.nodes for pose in poses]
    beside = [part for nodes in shapes for part in (*carried.cables(nodes), carried.winches(nodes))]
    frame = np.concatenate([*shapes, *beside])
    portrait = 2.4  # width at which a portrait is drawn [inch]; then it is made smaller, its lines too
    figures = [draw_portrait(robot, nodes, frame=frame, width=portrait) for nodes in shapes]
    images = [figure_pixels(figure, dpi=220) for figure in figures]
    drawn = np.any([image[..., 3] > 0 for image in images], axis=0)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    return [image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] for image in images]


def _head(figure: Figure, title: str, trajectory: Trajectory) -> None:
    if not title:
        return
    width, height = figure.get_size_inches()
    used = f"{trajectory.path} path, {trajectory.seconds:.2f} s"
    if trajectory.branch_jumps:
        used += f", snaps at {', '.join(f'{snap.time:.2f} s' for snap in trajectory.branch_jumps[:4])}"
    figure.text(
        0.12 / width, 1 - 0.1 / height, title, fontsize=11, color=Color.INK, weight="bold", va="top", parse_math=False
    )
    figure.text(1 - 0.12 / width, 1 - 0.13 / height, used, fontsize=8, color=Color.MUTED, va="top", ha="right")


def _charts(figure: Figure, robot: Robot, trajectory: Trajectory, top: float) -> None:
    """Three charts below each other, the first one at `top` [inch]."""
    width, height = figure.get_size_inches()
    drives = trajectory.poses[0].robot.drives
    rows = (
        ("taken in [mm]" + ", drives" * bool(drives), trajectory.contractions, None),
        ("speed [mm/s]", trajectory.speeds, trajectory.limits.speed),
        ("acceleration [mm/s\N{SUPERSCRIPT TWO}]", trajectory.accelerations, trajectory.limits.acceleration),
    )
    colors = Color.of_winches(robot.winches)
    right = 0.5 + 0.068 * max(
        (len(shorten(name)) for name in (*trajectory.winches, *(drive.column[0] for drive in drives))), default=0
    )
    first = None
    for row, (label, values, limits) in enumerate(rows):
        low = top - (row + 1) * CHART + 0.12
        axes = figure.add_axes(
            (0.62 / width, low / height, (width - 0.62 - right) / width, (CHART - 0.22) / height), sharex=first
        )
        first = first or axes
        _chart(axes, label, last=row == 2)
        _events(axes, trajectory)
        count = len(trajectory.winches)
        for column, name in enumerate(trajectory.winches):
            axes.plot(
                trajectory.times, MILLIMETERS * values[:, column], color=colors[name], linewidth=1.4,
                linestyle=DASHES[column // len(Color.WINCHES) % len(DASHES)], label=shorten(name),
            )  # fmt: skip
        for index, drive in enumerate(drives if row == 0 else (), 1):
            name, factor = drive.column
            axes.plot(
                trajectory.times, factor * values[:, count + index - 1], color=Color.MUTED, linewidth=1.2,
                linestyle=DASHES[index % len(DASHES)], label=name,
            )  # fmt: skip
        if limits is not None:
            _limits(axes, limits[:count])
        if row == 0:
            _name_keys(axes, trajectory.keyframes, trajectory.seconds)
        if row == 0 and len(trajectory.contractions[0]):
            axes.legend(
                loc="upper left", bbox_to_anchor=(1.01, 1.0), fontsize=7.5, frameon=False, labelcolor=Color.INK,
                handlelength=1.6, borderaxespad=0.0, labelspacing=0.35,
            )  # fmt: skip
    assert first is not None
    first.set_xlim(0.0, trajectory.seconds)


def _chart(axes: Axes, label: str, *, last: bool) -> None:
    plain_axes(axes, size=7.5)
    axes.tick_params(labelbottom=last)
    axes.set_ylabel(label, color=Color.INK, fontsize=8)
    # Numbers far from 1 would be so wide that the label leaves the picture.
    axes.ticklabel_format(axis="y", scilimits=(-1, 4), useOffset=False)
    axes.yaxis.get_offset_text().set(fontsize=6.5, color=Color.MUTED)
    if last:
        axes.set_xlabel("time [s]", color=Color.INK, fontsize=8)


def _events(axes: Axes, trajectory: Trajectory) -> None:
    """Keyframes and snaps."""
    for key in trajectory.keyframes:
        axes.axvline(key.time, color=Color.GHOST, linewidth=0.9, zorder=1)
    for snap in trajectory.branch_jumps:
        axes.axvline(snap.time, color=Color.ERROR, linewidth=0.9, linestyle=(0, (1, 1.5)), zorder=1.5)


def _name_keys(axes: Axes, keys: tuple[KeyPose, ...], seconds: float) -> None:
    """The names of the keyframes above the first chart, as far as there is room."""
    last = -np.inf
    for key in keys:
        if key.time - last > 0.09 * seconds:
            axes.annotate(
                shorten(key.name), (key.time, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 2),
                textcoords="offset points", fontsize=6.5, color=Color.MUTED, ha="center", va="bottom",
                parse_math=False, annotation_clip=False,
            )  # fmt: skip
            last = key.time


def _limits(axes: Axes, limits: Vector) -> None:
    """Both limits, where all winches have the same one."""
    if len(limits) and np.isfinite(limits).all() and np.ptp(limits) == 0:
        for sign in (-1.0, 1.0):
            axes.axhline(
                sign * MILLIMETERS * limits[0], color=Color.ERROR, linewidth=0.9, linestyle=(0, (3, 2)), zorder=2
            )
        axes.annotate(
            "limit", (1.0, MILLIMETERS * limits[0]), xycoords=("axes fraction", "data"), xytext=(-2, 2),
            textcoords="offset points", fontsize=6.5, color=Color.ERROR, ha="right", va="bottom",
        )  # fmt: skip
