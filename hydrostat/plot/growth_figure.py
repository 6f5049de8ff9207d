"""`draw_growth`: how the pose error fell while a network grew."""

from collections.abc import Collection, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from hydrostat.design.network import Stage
from hydrostat.drawing.palette import ERROR, GHOST, INK, SEAM
from hydrostat.plot.chart import new_chart
from hydrostat.plot.sheet import MILLIMETRES, WIDTH

_WIDE = 30.0
"""Errors that differ by this factor are drawn on a logarithmic scale."""


def draw_growth(
    stages: Sequence[Stage],
    *,
    rest: float | None = None,
    final: float | None = None,
    marked: Collection[int] = (),
    width: float = WIDTH,
) -> Figure:
    """The error of each stage, counted from 1; a new line where another network is begun.

    Args:
        stages: in order.
        rest: error at rest [m], dashed, if it is to be seen.
        final: error of the network that was returned [m], dotted, if it is to be seen.
        marked: indices of stages with a filled dot, from 0.
        width: of the picture [inch].
    """
    figure, axes = new_chart("stage", "pose error [mm rms]", width=width, height=0.46 * width)
    errors = MILLIMETRES * np.array([stage.error for stage in stages])
    for run in stage_runs(stages):
        axes.plot(np.array(run) + 1, errors[run], color=SEAM, linewidth=1.6, zorder=3)
        if run[0]:
            axes.axvline(run[0] + 0.5, color=GHOST, linewidth=0.9, linestyle=(0, (1, 2)), zorder=1)
    chosen = np.isin(np.arange(len(stages)), list(marked))
    look = {"linestyle": "none", "marker": "o", "markeredgecolor": SEAM, "zorder": 4, "clip_on": False}
    numbers = np.arange(1, len(stages) + 1)
    axes.plot(numbers[~chosen], errors[~chosen], markersize=3.2, color="white", markeredgewidth=0.9, **look)
    axes.plot(numbers[chosen], errors[chosen], markersize=6.0, color=SEAM, markeredgewidth=0.0, **look)
    levels = {"at rest": (rest, ERROR, -3), "returned": (final, INK, 3)}
    for words, (error, colour, lift) in levels.items():
        if error is not None:
            _draw_level(axes, MILLIMETRES * error, words, colour, lift)
    _scale(axes, np.concatenate([errors, [MILLIMETRES * error for error in (rest, final) if error is not None]]))
    edge = 0.02 * max(len(stages) - 1, 1)
    axes.set_xlim(1.0 - edge, len(stages) + edge)
    return figure


def stage_runs(stages: Sequence[Stage]) -> list[list[int]]:
    """Indices of stages, a list for each network that was begun: with far fewer cables than the one before."""
    runs: list[list[int]] = []
    before = np.inf
    for index, stage in enumerate(stages):
        count = len(stage.robot.cables)
        if not runs or count < before - 1 or count < 2 <= before:
            runs.append([])
        runs[-1].append(index)
        before = count
    return runs


def _draw_level(axes: Axes, error: float, words: str, colour: str, lift: int) -> None:
    """A line across at an error [mm], with its words below or above it."""
    axes.axhline(error, color=colour, linewidth=1.0, linestyle=(0, (3, 2)), zorder=2)
    axes.annotate(
        f"{words}: {error:.3g} mm", (1.0, error), xycoords=("axes fraction", "data"), xytext=(-2, lift),
        textcoords="offset points", fontsize=8, color=colour, ha="right", va="top" if lift < 0 else "bottom",
        weight="bold" if lift > 0 else "normal",
    )  # fmt: skip


def _scale(axes: Axes, errors: np.ndarray) -> None:
    """From 0, unless errors [mm] differ too much for that."""
    most = float(errors.max(initial=0.0))
    if most > 0 and 0 < errors.min() < most / _WIDE:
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.set_ylim(0.6 * float(errors.min()), 1.6 * most)
        return
    axes.set_ylim(0.0, 1.06 * most if most > 0 else 1.0)
