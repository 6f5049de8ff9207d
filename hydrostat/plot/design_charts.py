"""Charts of a design: how the pose error fell while a network grew, what more sewing would gain (F2)."""

from collections.abc import Collection, Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from hydrostat.design import Alternative, BuildCost, DesignStage, FrontRow, Network, front
from hydrostat.drawing import Color
from hydrostat.plot.chart import new_chart
from hydrostat.plot.labels import HALO
from hydrostat.plot.report_tables import millimeters
from hydrostat.plot.sheet import WIDTH
from hydrostat.units import MILLIMETERS, plural


def draw_growth(
    stages: Sequence[DesignStage],
    *,
    rest: float | None = None,
    final: float | None = None,
    marked: Collection[int] = (),
    width: float = WIDTH,
) -> Figure:
    """The error of each stage, counted from 1; a new line where another network is begun.

    Errors at rest (dashed) and of the network that was returned (dotted) are in meters; the stages of the marked
    indices, from 0, have a filled dot; width in inches.
    """
    figure, axes = new_chart("stage", "pose error [mm rms]", width=width, height=0.46 * width)
    errors = MILLIMETERS * np.array([stage.error for stage in stages])
    for run in stage_runs(stages):
        axes.plot(np.array(run) + 1, errors[run], color=Color.SEAM, linewidth=1.6, zorder=3)
        if run[0]:
            axes.axvline(run[0] + 0.5, color=Color.GHOST, linewidth=0.9, linestyle=(0, (1, 2)), zorder=1)
    chosen = np.isin(np.arange(len(stages)), list(marked))
    look = {"linestyle": "none", "marker": "o", "markeredgecolor": Color.SEAM, "zorder": 4, "clip_on": False}
    numbers = np.arange(1, len(stages) + 1)
    axes.plot(numbers[~chosen], errors[~chosen], markersize=3.2, color="white", markeredgewidth=0.9, **look)
    axes.plot(numbers[chosen], errors[chosen], markersize=6.0, color=Color.SEAM, markeredgewidth=0.0, **look)
    levels = {"at rest": (rest, Color.ERROR, -3), "returned": (final, Color.INK, 3)}
    for words, (error, color, lift) in levels.items():
        if error is not None:
            _draw_level(axes, MILLIMETERS * error, words, color, lift)
    _scale(axes, np.concatenate([errors, [MILLIMETERS * error for error in (rest, final) if error is not None]]))
    edge = 0.02 * max(len(stages) - 1, 1)
    axes.set_xlim(1.0 - edge, len(stages) + edge)
    return figure


def stage_runs(stages: Sequence[DesignStage]) -> list[list[int]]:
    """Indices of stages, a list for each network that was begun: drawn, from trees, or with far fewer cables."""
    runs: list[list[int]] = []
    before = np.inf
    for index, stage in enumerate(stages):
        count = len(stage.robot.cables)
        if not runs or stage.is_begun or count < before - 1 or count < 2 <= before:
            runs.append([])
        runs[-1].append(index)
        before = count
    return runs


def _draw_level(axes: Axes, error: float, words: str, color: str, lift: int) -> None:
    """A line across at an error [mm], with its words: below it at the right, above it at the left.

    The curve falls from left to right, so the words are where it is not.
    """
    axes.axhline(error, color=color, linewidth=1.0, linestyle=(0, (3, 2)), zorder=2)
    right = lift < 0
    axes.annotate(
        f"{words}: {error:.3g} mm", (float(right), error), xycoords=("axes fraction", "data"),
        xytext=(-2 if right else 2, lift), textcoords="offset points", fontsize=8, color=color,
        ha="right" if right else "left", va="top" if right else "bottom", weight="normal" if right else "bold",
        gid=HALO, zorder=5,
    )  # fmt: skip


def _scale(axes: Axes, errors: np.ndarray) -> None:
    """Scale an axis from 0, unless errors [mm] differ too much for that."""
    most = float(errors.max(initial=0.0))
    wide = 30.0  # errors that differ by this factor are drawn on a logarithmic scale
    if most > 0 and 0 < errors.min() < most / wide:
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.set_ylim(0.6 * float(errors.min()), 1.6 * most)
        return
    axes.set_ylim(0.0, 1.06 * most if most > 0 else 1.0)


def draw_front(
    alternatives: Iterable[Alternative], chosen: Network, *, tolerance: float | None = None, width: float = WIDTH
) -> Figure:
    """Error as built over minutes of work on cables: a dot for each network in the color of its number of winches.

    The number above a dot counts cables. A filled dot is on the Pareto front, which a line joins: nothing that takes
    as few minutes is better. A ring marks the chosen one, a dashed line the tolerance that was asked for [m]. Width in
    inches.
    """
    networks = [chosen, *(other for other in alternatives if other.robot != chosen.robot)]
    below = f"minutes of {BuildCost.cable_work(chosen.robot)}"
    figure, axes = new_chart(below, "error once built [mm rms]", width=width, height=0.5 * width)
    points = [(BuildCost.cable_minutes(one.robot), MILLIMETERS * one.expected_error) for one in networks]
    best = front(points)
    axes.plot(*np.transpose([points[index] for index in best]), color=Color.GHOST, linewidth=1.2, zorder=2)
    _draw_dots(axes, networks, points, set(best))
    if tolerance is not None:
        axes.axhline(MILLIMETERS * tolerance, color=Color.ERROR, linewidth=1.0, linestyle=(0, (3, 2)), zorder=2)
        axes.annotate(
            "tolerance", (0.0, MILLIMETERS * tolerance), xycoords=("axes fraction", "data"), xytext=(3, 2),
            textcoords="offset points", fontsize=7.5, color=Color.ERROR, ha="left", va="bottom",
        )  # fmt: skip
    axes.set_ylim(0.0, 1.15 * max([MILLIMETERS * (tolerance or 0.0), 1e-6, *(error for _, error in points)]))
    axes.margins(x=0.06)
    _draw_counts(axes, networks, points)
    _draw_chosen(axes, points[0])
    axes.legend(loc="upper right", fontsize=8, frameon=False, labelcolor=Color.INK, handlelength=1.0)
    return figure


def draw_winch_front(rows: Sequence[FrontRow], *, width: float = WIDTH) -> Figure:
    """Error as built over the price of motors, power and cables: a dot for each number and kind of winches.

    Its words are the winches and the minutes of work. A filled dot is the best for its price and work, a diamond pulls
    both ways, a ring marks the chosen one. Width in inches.
    """
    figure, axes = new_chart("price [USD]", "error once built [mm rms]", width=width, height=0.45 * width)
    dots = [(row.cost.price, MILLIMETERS * row.expected_error) for row in rows]
    counts = sorted({row.winches for row in rows})
    for row, dot in zip(rows, dots, strict=True):
        color = Color.WINCHES[counts.index(row.winches) % len(Color.WINCHES)]
        words = f"{plural(row.winches, 'winch')}{', both ways' * row.two_way}: {row.cost.minutes:.0f} min"
        axes.plot(
            *dot, marker="D" if row.two_way else "o", markersize=5.5, color=color if row.is_best else "white",
            markeredgecolor=color, zorder=4, clip_on=False,
        )  # fmt: skip
        left = dot[0] > 0.5 * max(dots)[0]
        axes.annotate(
            words, dot, xytext=(-9 if left else 9, 0), textcoords="offset points", fontsize=8, color=Color.INK,
            ha="right" if left else "left", va="center", gid=HALO, annotation_clip=False,
        )  # fmt: skip
        if row.is_chosen:
            axes.plot(*dot, marker="o", markersize=12, color="none", markeredgecolor=Color.INK, zorder=5, clip_on=False)
    axes.set_ylim(0.0, 1.15 * max(error for _, error in dots))
    axes.set_xlim(0.0, 1.1 * max(dots)[0])
    return figure


Dot = tuple[float, float]  # minutes of sewing [min], and error as built [mm]


def _draw_dots(axes: Axes, networks: Sequence[Alternative | Network], dots: Sequence[Dot], best: set[int]) -> None:
    """All dots; a line of the legend for each number of winches."""
    counts = [len(one.robot.winches) for one in networks]
    for number, count in enumerate(sorted(set(counts))):
        color, name = Color.WINCHES[number % len(Color.WINCHES)], plural(count, "winch")
        axes.plot([], [], marker="o", markersize=5.5, linestyle="none", color=color, label=name)
        for index in (index for index, other in enumerate(counts) if other == count):
            axes.plot(
                *dots[index], marker="o", markersize=5.5, color=color if index in best else "white",
                markeredgecolor=color, zorder=4, clip_on=False,
            )  # fmt: skip


def _draw_counts(axes: Axes, networks: Sequence[Alternative | Network], dots: Sequence[Dot]) -> None:
    """The number of cables of each network above its dot; where two would meet the later is left out."""
    written: list[np.ndarray] = []
    apart = 0.03, 0.06  # numbers nearer than these shares of a chart, across and upwards, would be one blot
    for number, (one, dot) in enumerate(zip(networks, dots, strict=True)):
        place = axes.transAxes.inverted().transform(axes.transData.transform(dot))
        if all((np.abs(place - other) > apart).any() for other in written):
            written.append(place)
            axes.annotate(
                str(len(one.robot.cables)), dot, xytext=(0, 4 if number else -8), textcoords="offset points",
                fontsize=7.5, color=Color.INK, ha="center", va="bottom" if number else "top", gid=HALO,
                annotation_clip=False,
            )  # fmt: skip


def _draw_chosen(axes: Axes, place: Dot) -> None:
    """A ring around the dot of the chosen network, named where there is room."""
    axes.plot(*place, marker="o", markersize=12, color="none", markeredgecolor=Color.INK, markeredgewidth=1.3, zorder=5,
        clip_on=False)  # fmt: skip
    low, high = axes.get_xlim()
    left = place[0] > (low + high) / 2
    axes.annotate(
        f"chosen: {millimeters(place[1] / MILLIMETERS)} mm", place, xytext=(-4 if left else 4, 11),
        textcoords="offset points", fontsize=8.5, color=Color.INK, weight="bold", gid=HALO,
        ha="right" if left else "left", annotation_clip=False,
    )  # fmt: skip
