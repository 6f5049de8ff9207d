"""Pictures of what was learned: errors over samples, time and equilibria, losses, poses side by side, calibration."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from hydrostat.arrays import Float, Nodes
from hydrostat.drawing import Color
from hydrostat.plot import (
    WIDTH,
    Attachments,
    draw_portrait,
    new_chart,
    new_figure,
    outer_points,
    plain_axes,
    short_number,
)
from hydrostat.robot import Robot
from hydrostat.units import MILLIMETERS
from hydrostat_lab.compare import STEP, way_of
from hydrostat_lab.study import StudyRow


def draw_errors(rows: Sequence[StudyRow], *, width: float = WIDTH) -> Figure:
    """Mean errors of ways to learn, over the number of samples and over the CPU time of sampling and learning.

    The line is the mean over seeds, the field what lies between the best and the worst; width in inches.
    """
    height = 4.2
    figure = new_figure(width, height)
    lower, tall, wide = 1.25 / height, (height - 1.45) / height, 0.41
    panes = [figure.add_axes((left, lower, wide, tall)) for left in (0.1, 0.565)]
    methods = list(dict.fromkeys(row.method for row in rows))
    ways = list(dict.fromkeys(way_of(name) for name in methods))
    colors = dict(zip(ways, (Color.MUTED, *Color.WINCHES), strict=False))
    for name in methods:
        way = way_of(name)
        color, label = colors.get(way, Color.INK), way if name == way else None
        dashes = "-" if name == way else "--" if name.endswith(STEP) else ":"
        mine = [row for row in rows if row.method == name]
        counts = sorted({row.samples for row in mine})
        groups = [[row for row in mine if row.samples == count] for count in counts]
        errors = [[MILLIMETERS * row.errors["mean"] for row in group] for group in groups]
        seconds = [float(np.mean([row.sampling + row.learning for row in group])) for group in groups]
        for axes, across in zip(panes, (counts, seconds), strict=True):
            means = [float(np.mean(each)) for each in errors]
            axes.plot(across, means, dashes, color=color, linewidth=1.4, marker="o", markersize=3, label=label)
            low, high = [min(each) for each in errors], [max(each) for each in errors]
            axes.fill_between(across, low, high, color=color, alpha=0.15, linewidth=0)
    _logarithmic(panes[0], "samples", "mean error [mm]")
    _logarithmic(panes[1], "CPU time of sampling and learning [s]", "")
    panes[0].plot([], [], "--", color=Color.INK, linewidth=1.4, label="and one exact step")
    panes[0].plot([], [], ":", color=Color.INK, linewidth=1.4, label="and up to three")
    handles, names = panes[0].get_legend_handles_labels()
    figure.legend(
        handles, names, loc="lower center", ncol=5, frameon=False, fontsize=7, handlelength=3, labelcolor=Color.INK
    )
    return figure


def draw_losses(rows: Sequence[StudyRow], *, width: float = WIDTH) -> Figure:
    """Learning curves of the thesis's network, for each number of samples that it learned from."""
    figure, axes = new_chart("epoch", "mean square of the action's error", width=width)
    for number, row in enumerate(rows):
        color, curve = Color.WINCHES[number % len(Color.WINCHES)], np.array(row.curve)
        axes.plot(1 + np.arange(len(curve)), curve[:, 0], "--", color=color, linewidth=1.0)
        axes.plot(1 + np.arange(len(curve)), curve[:, 1], color=color, linewidth=1.4, label=f"{row.samples} samples")
    axes.plot([], [], "--", color=Color.MUTED, linewidth=1.0, label="dashed: what it learned from")
    axes.plot([], [], color=Color.MUTED, linewidth=1.4, label="solid: what was held out")
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(FuncFormatter(short_number))
    axes.yaxis.set_minor_formatter(FuncFormatter(_half))
    axes.tick_params(axis="y", which="minor", labelsize=8, colors=Color.MUTED)
    axes.legend(frameon=False, fontsize=8, labelcolor=Color.INK)
    return figure


def draw_costs(
    curves: Mapping[str, Sequence[tuple[float, float]]],
    used: str = "equilibria of the simulator",
    missed: str = "mean error in the simulator [mm]",
    *,
    width: float = WIDTH,
) -> Figure:
    """Mean errors [mm] of ways to a policy over what each has used, as (used, error); inches.

    Ways whose names begin with the same words before a comma have one color, and lines of other kinds.
    """
    figure, axes = new_chart("", "", width=width, height=4.0)
    heads = list(dict.fromkeys(name.partition(",")[0] for name in curves))
    seen = dict.fromkeys(heads, 0)
    for name, points in curves.items():
        across, up = zip(*sorted(points), strict=True)
        head = name.partition(",")[0]
        color, dashes = Color.WINCHES[heads.index(head) % len(Color.WINCHES)], ("-", "--", ":")[seen[head] % 3]
        seen[head] += 1
        axes.plot(across, up, color=color, linestyle=dashes, linewidth=1.4, marker="o", markersize=5, label=name)
    _logarithmic(axes, used, missed)
    left, lower, _, tall = axes.get_position().bounds
    axes.set_position((left, lower, 0.64 - left, tall))
    axes.legend(frameon=False, fontsize=8, labelcolor=Color.INK, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


def draw_side_by_side(robot: Robot, columns: Mapping[str, Sequence[Nodes]], *, width: float = 2.7) -> Figure:
    """Poses as pictures in columns with a head each, a row for each pose [m]; width of one in inches."""
    every = [nodes for poses in columns.values() for nodes in poses]
    carried = Attachments(robot)
    hardware = [points for nodes in every for points in (*carried.cables(nodes), carried.winches(nodes))]
    frame = np.concatenate([*outer_points(robot.body, every), *hardware])
    pictures = {name: [_picture(robot, nodes, frame, width) for nodes in poses] for name, poses in columns.items()}
    some = next(iter(pictures.values()))
    tall, head = width * some[0].shape[0] / some[0].shape[1], 0.3
    whole = head + tall * len(some)
    figure = new_figure(width * len(columns), whole)
    for column, (name, poses) in enumerate(pictures.items()):
        middle = (column + 0.5) / len(columns)
        figure.text(middle, 1 - 0.6 * head / whole, name, ha="center", va="center", color=Color.INK, fontsize=10)
        for row, picture in enumerate(poses):
            lower = 1 - (head + tall * (row + 1)) / whole
            axes = figure.add_axes((column / len(columns), lower, 1 / len(columns), tall / whole))
            axes.imshow(picture)
            axes.set_axis_off()
    return figure


def draw_calibration(
    curves: Mapping[str, tuple[Float[np.ndarray, " some"], Float[np.ndarray, " some"]]], *, width: float = WIDTH
) -> Figure:
    """Errors over what the networks said of them, both [m]: means of tenths of all markers, from sure to unsure."""
    figure, axes = new_chart("", "", width=width, height=4.0)
    ends = [np.inf, 0.0]
    for number, (name, (said, found)) in enumerate(curves.items()):
        tenths = np.array_split(np.argsort(said, kind="stable"), min(10, len(said)))
        across, up = ([MILLIMETERS * float(values[tenth].mean()) for tenth in tenths] for values in (said, found))
        ends = [min(ends[0], *across, *up), max(ends[1], *across, *up)]
        color = Color.WINCHES[number % len(Color.WINCHES)]
        axes.plot(across, up, color=color, linewidth=1.4, marker="o", markersize=4, label=name)
    axes.plot(ends, ends, "--", color=Color.MUTED, linewidth=1.0, label="as said")
    _logarithmic(axes, "expected error and doubt together [mm]", "error in the simulator [mm]")
    axes.legend(frameon=False, fontsize=8, labelcolor=Color.INK)
    return figure


def _picture(robot: Robot, nodes: Nodes, frame: np.ndarray, width: float) -> np.ndarray:
    """Pixels of the robot alone."""
    figure = draw_portrait(robot, nodes, frame=frame, width=width)
    figure.set_dpi(200)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())


def _logarithmic(axes: Axes, across: str, up: str) -> None:
    """Both axes by powers of ten, in plain numbers."""
    plain_axes(axes)
    axes.set_xlabel(across, color=Color.INK, fontsize=8.5)
    axes.set_ylabel(up, color=Color.INK, fontsize=8.5)
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
        axis.set_major_formatter(FuncFormatter(short_number))
        axis.set_minor_formatter(NullFormatter())


def _half(value: float, place: object = None) -> str:
    """Numbers between powers of ten: 2 and 5 alone."""
    return short_number(value, place) if f"{value:e}"[0] in "25" else ""
