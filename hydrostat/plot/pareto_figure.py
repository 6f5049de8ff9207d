"""`draw_front`: what more winches and more cables would gain (F2)."""

from collections.abc import Iterable

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from hydrostat.design.network import Alternative, Network
from hydrostat.plot.chart import new_chart
from hydrostat.plot.palette import ERROR, INK, WINCHES
from hydrostat.plot.sheet import MILLIMETRES, WIDTH
from hydrostat.units import counted

Size = tuple[int, int]
"""Numbers of winches and of cables."""


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
    _draw_chosen(axes, chosen)
    if tolerance is not None:
        axes.axhline(MILLIMETRES * tolerance, color=ERROR, linewidth=1.0, linestyle=(0, (3, 2)), zorder=2)
        axes.annotate(
            "tolerance", (0.0, MILLIMETRES * tolerance), xycoords=("axes fraction", "data"), xytext=(3, 2),
            textcoords="offset points", fontsize=7.5, color=ERROR, ha="left", va="bottom",
        )  # fmt: skip
    axes.set_ylim(0.0, 1.08 * MILLIMETRES * max([*errors.values(), tolerance or 0.0, 1e-9]))
    axes.margins(x=0.06)
    axes.legend(loc="upper right", fontsize=8, frameon=False, labelcolor=INK, handlelength=1.8)
    return figure


def best_errors(alternatives: Iterable[Alternative], chosen: Network) -> dict[Size, float]:
    """The least error of each number of winches and cables [m], in their order; the chosen network's where it is."""
    found: dict[Size, float] = {}
    for network in alternatives:
        found[_size(network)] = min(network.rms_error, found.get(_size(network), float("inf")))
    found[_size(chosen)] = chosen.rms_error
    return dict(sorted(found.items()))


def on_front(size: Size, errors: dict[Size, float]) -> bool:
    """Whether no other network with as few winches and as few cables has an error as small."""
    others = (error for other, error in errors.items() if other != size and all(map(int.__le__, other, size)))
    return all(error > errors[size] for error in others)


def _size(network: Alternative | Network) -> Size:
    return len(network.robot.winches), len(network.robot.cables)


def _draw_line(axes: Axes, line: list[Size], errors: dict[Size, float], colour: str) -> None:
    across, up = [cables for _, cables in line], [MILLIMETRES * errors[size] for size in line]
    axes.plot(across, up, color=colour, linewidth=1.5, label=counted(line[0][0], "winch"), zorder=3)
    for size, x, y in zip(line, across, up, strict=True):
        fill = colour if on_front(size, errors) else "white"
        axes.plot(x, y, marker="o", markersize=5.5, color=fill, markeredgecolor=colour, zorder=4, clip_on=False)


def _draw_chosen(axes: Axes, chosen: Network) -> None:
    place = len(chosen.robot.cables), MILLIMETRES * chosen.rms_error
    axes.plot(*place, marker="o", markersize=12, color="none", markeredgecolor=INK, markeredgewidth=1.3, zorder=5)
    axes.annotate(
        f"chosen: {place[1]:.2f} mm", place, xytext=(9, 8), textcoords="offset points", fontsize=8.5, color=INK,
        weight="bold",
    )  # fmt: skip
