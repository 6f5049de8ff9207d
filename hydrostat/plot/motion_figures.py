"""`draw_motion`: markers, winches and cables over time."""

from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from hydrostat.drawing.palette import INK, WINCHES, winch_colours
from hydrostat.plot.chart import DASHES, plain_axes
from hydrostat.plot.labels import shorten
from hydrostat.plot.sheet import MILLIMETRES, WIDTH
from hydrostat.robot import Robot
from hydrostat.simulation import MotionTable

MOST_NAMES = 12  # so many lines are named; of more, the others are only drawn


def draw_motion(robot: Robot, table: MotionTable, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """How far each marker is from where it began, what each winch takes in, and what each cable pulls, over time.

    A marker with the name of a winch has its colour. The title is the robot's name if left out; width in inches.
    """
    figure = Figure(figsize=(width, 0.95 * width), layout="constrained")
    FigureCanvasAgg(figure)
    upper, middle, lower = figure.subplots(3, 1, sharex=True)
    head = shorten(robot.name) if title is None else title
    if head:
        upper.set_title(head, loc="left", color=INK, fontsize=11, fontweight="bold")
    colours = winch_colours(robot.winches)
    way = MILLIMETRES * np.linalg.norm(table.markers - table.markers[0], axis=2)
    names = [marker.name for marker in robot.markers]
    others = cycle([colour for colour in WINCHES if colour not in colours.values()] or WINCHES)
    _lines(upper, table.times, way, names, [colours.get(name) or next(others) for name in names])
    upper.set_ylabel("marker moved [mm]")
    winches = [winch.name for winch in robot.winches]
    _lines(middle, table.times, MILLIMETRES * table.contractions, winches, [colours[name] for name in winches])
    middle.set_ylabel("cable taken in [mm]")
    cables = [f"{index + 1} {cable.winch}" for index, cable in enumerate(robot.cables)]
    _lines(lower, table.times, table.tensions, cables, [colours[cable.winch] for cable in robot.cables])
    lower.set_ylabel("tension [N]")
    lower.set_xlabel("time [s]", color=INK)
    lower.set_xlim(table.times[0], max(table.times[-1], table.times[0] + 1e-9))
    return figure


def _lines(axes: Axes, times: np.ndarray, values: np.ndarray, names: list[str], colours: list[str]) -> None:
    """A line for each column; those that move most are named beside their ends, as many as there is place for."""
    plain_axes(axes)
    axes.yaxis.label.set_color(INK)
    dashes = {}
    for column, (name, colour) in enumerate(zip(names, colours, strict=True)):
        count = dashes.setdefault(colour, 0)
        dashes[colour] += 1
        line = values[:, column]
        axes.plot(times, line, color=colour, linewidth=1.4, linestyle=DASHES[count % len(DASHES)], label=name)
    if names:
        most = np.argsort(-np.ptp(values, axis=0), kind="stable")[:MOST_NAMES]
        handles, _ = axes.get_legend_handles_labels()
        shown = sorted(int(index) for index in most)
        axes.legend(
            [handles[index] for index in shown],
            [shorten(names[index]) for index in shown],
            loc="center left",
            bbox_to_anchor=(1.01, 0.5),
            fontsize=8,
            frameon=False,
            labelcolor=INK,
        )
