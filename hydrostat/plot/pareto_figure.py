"""`draw_front`: what more winches and more cables would gain (F2)."""

from collections.abc import Iterable

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from hydrostat.design.network import Alternative, Network, Size, best_errors, on_front
from hydrostat.drawing.palette import ERROR, INK, WINCHES
from hydrostat.plot.chart import new_chart
from hydrostat.plot.labels import HALO
from hydrostat.plot.numbers import millimetres
from hydrostat.plot.sheet import MILLIMETRES, WIDTH
from hydrostat.units import counted


def draw_front(
    alternatives: Iterable[Alternative], chosen: Network, *, tolerance: float | None = None, width: float = WIDTH
) -> Figure:
    """Error against number of cables, a line for each number of winches.

    A filled dot is a network on the Pareto front: none with as few winches and cables is better. A ring marks the
    chosen one.

    Args:
        alternatives: other networks; of equal numbers the best counts.
        chosen: the network that was returned.
        tolerance: error that was asked for [m], dashed.
        width: of the picture [inch].
    """
    errors = best_errors(alternatives, chosen)
    figure, axes = new_chart("cables", "pose error [mm rms]", width=width, height=0.5 * width)
    axes.xaxis.set_major_locator(MultipleLocator(max(1, round(max(cables for _, cables in errors) / 12))))
    for index, winches in enumerate(sorted({winches for winches, _ in errors})):
        line = [size for size in sorted(errors) if size[0] == winches]
        _draw_line(axes, line, errors, WINCHES[index % len(WINCHES)])
    if tolerance is not None:
        axes.axhline(MILLIMETRES * tolerance, color=ERROR, linewidth=1.0, linestyle=(0, (3, 2)), zorder=2)
        axes.annotate(
            "tolerance", (0.0, MILLIMETRES * tolerance), xycoords=("axes fraction", "data"), xytext=(3, 2),
            textcoords="offset points", fontsize=7.5, color=ERROR, ha="left", va="bottom",
        )  # fmt: skip
    axes.set_ylim(0.0, 1.08 * MILLIMETRES * max([*errors.values(), tolerance or 0.0, 1e-9]))
    axes.margins(x=0.06)
    _draw_chosen(axes, chosen)
    axes.legend(loc="upper right", fontsize=8, frameon=False, labelcolor=INK, handlelength=1.8)
    return figure


def _draw_line(axes: Axes, line: list[Size], errors: dict[Size, float], colour: str) -> None:
    across, up = [cables for _, cables in line], [MILLIMETRES * errors[size] for size in line]
    axes.plot(across, up, color=colour, linewidth=1.5, label=counted(line[0][0], "winch"), zorder=3)
    for size, x, y in zip(line, across, up, strict=True):
        fill = colour if on_front(size, errors) else "white"
        axes.plot(x, y, marker="o", markersize=5.5, color=fill, markeredgecolor=colour, zorder=4, clip_on=False)


def _draw_chosen(axes: Axes, chosen: Network) -> None:
    """A ring around the chosen network, named where there is room."""
    place = len(chosen.robot.cables), MILLIMETRES * chosen.rms_error
    axes.plot(*place, marker="o", markersize=12, color="none", markeredgecolor=INK, markeredgewidth=1.3, zorder=5,
        clip_on=False)  # fmt: skip
    low, high = axes.get_xlim()
    left = place[0] > (low + high) / 2
    axes.annotate(
        f"chosen: {millimetres(chosen.rms_error)} mm", place, xytext=(-4 if left else 4, 11),
        textcoords="offset points", fontsize=8.5, color=INK, weight="bold", gid=HALO, ha="right" if left else "left",
        annotation_clip=False,
    )  # fmt: skip
