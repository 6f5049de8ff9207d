"""The look of charts: `new_chart` makes an empty one, `plain_axes` is for several in a figure.

`short_number` formats the numbers at an axis.
"""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from hydrostat.drawing import Color
from hydrostat.plot.sheet import WIDTH, new_figure

DASHES = ("-", "--", ":", "-.")  # lines of one color, one after the other


def new_chart(across: str, up: str, *, width: float = WIDTH, height: float = 3.0) -> tuple[Figure, Axes]:
    """A figure [inch] with one chart and words at its axes; the one across counts in whole numbers."""
    figure = new_figure(width, height)
    edges = (0.62, 0.2, 0.5, 0.16)  # left, right, lower and upper border [inch]
    left, right, lower, upper = edges
    box = (left / width, lower / height, (width - left - right) / width, (height - lower - upper) / height)
    axes = figure.add_axes(box)
    plain_axes(axes)
    axes.set_xlabel(across, color=Color.INK, fontsize=8.5)
    axes.set_ylabel(up, color=Color.INK, fontsize=8.5)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=10, integer=True, min_n_ticks=1))
    return figure, axes


def plain_axes(axes: Axes, *, size: float = 8) -> None:
    """Give axes the look of all charts: a pale grid, quiet numbers of a size [pt], no frame."""
    axes.set_facecolor("none")
    axes.grid(color=Color.GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(Color.MUTED)
    axes.tick_params(colors=Color.MUTED, labelsize=size)


def short_number(value: float, place: object = None) -> str:
    """Text of a number at an axis: whole from 1 on, else three digits."""
    del place
    return f"{value:,.0f}".replace(",", "\N{THIN SPACE}") if value >= 1 else f"{value:.3g}"
