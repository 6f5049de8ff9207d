"""`draw_curves`: curves of learning over the actions taken."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator
from scipy.stats import trim_mean

from hydrostat.drawing import Color
from hydrostat.plot.chart import plain_axes, short_number
from hydrostat.plot.sheet import WIDTH, new_figure


def draw_curves(panes: Mapping[str, Mapping[str, tuple[np.ndarray, np.ndarray]]], *, width: float = WIDTH) -> Figure:
    """Curves of learning over the actions taken, a pane for each kind of number, by the words at its axis.

    Each is (actions, numbers), the numbers (epochs, seeds): the line is the mean over the middle half of the seeds, the
    field what lies between the least and the largest; width in inches.
    """
    handles, names = [], list(dict.fromkeys(name for curves in panes.values() for name in curves))
    letters = 60  # So many letters of names stand beside one another below a picture of curves
    columns = 5 if sum(map(len, names)) < letters else 3
    height = 3.2 + 0.2 * -(-len(names) // columns)
    figure = new_figure(width, height)
    lower, tall = (height - 2.6) / height, 2.45 / height
    for number, (words, curves) in enumerate(panes.items()):
        axes = figure.add_axes((0.09 + 0.5 * number, lower, 0.39, tall))
        plain_axes(axes)
        for place, (name, (actions, numbers)) in enumerate(curves.items()):
            color = Color.WINCHES[place % len(Color.WINCHES)]
            middle = trim_mean(numbers, 0.25, axis=1)
            axes.plot(actions, middle, color=color, linewidth=1.4, label=name)
            axes.fill_between(actions, numbers.min(1), numbers.max(1), color=color, alpha=0.15, linewidth=0)
        most = max(float(numbers.max()) for _, numbers in curves.values())
        axes.set_ylim(0.0, 1.05 * (most or 1.0))
        axes.set_xlabel("actions", color=Color.INK, fontsize=8.5)
        axes.set_ylabel(words, color=Color.INK, fontsize=8.5)
        axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
        axes.xaxis.set_major_formatter(FuncFormatter(short_number))
        handles, names = axes.get_legend_handles_labels()
    figure.legend(handles, names, loc="lower center", ncol=columns, frameon=False, fontsize=8, labelcolor=Color.INK)
    return figure
