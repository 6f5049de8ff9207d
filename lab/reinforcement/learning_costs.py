"""Draw what ways to reach and to twist leave, over what they use of the simulator.

    python lab/reinforcement/learning_costs.py

The numbers are in learning_costs.csv, as the commands of decisions 0039 and 0043 printed them: means in mm, and
percent of cycles that turn by 90 degrees or more.
"""

import csv
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, MultipleLocator, NullFormatter

from hydrostat.drawing import Color
from hydrostat.plot import WIDTH, new_figure, plain_axes, save_png

HERE = Path(__file__).parent

PANES = {
    "reach": ("Reach: equilibria of the simulator", "mean error [mm]"),
    "twist": ("Twist: time steps of the simulator", "cycles of 90 degrees or more [%]"),
}
"""What axes are called, for each task."""


def main() -> None:
    """Draw the picture."""
    with (HERE / "learning_costs.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    height = 5.2
    figure = new_figure(WIDTH, height)
    for number, (task, words) in enumerate(PANES.items()):
        axes = figure.add_axes((0.1 + 0.5 * number, 2.2 / height, 0.38, (height - 2.4) / height))
        _pane(axes, [row for row in rows if row["task"] == task], *words)
    save_png(figure, HERE.parents[1] / "docs" / "pictures" / "learning_costs.png", dpi=140)


def _pane(axes: Axes, rows: list[dict[str, str]], across: str, up: str) -> None:
    """Points of each way, joined where there are several."""
    plain_axes(axes)
    ways: dict[str, list[tuple[float, float]]] = {}
    for row in rows:
        ways.setdefault(row["way"], []).append((float(row["used"]), float(row["value"])))
    for number, (way, points) in enumerate(ways.items()):
        used, value = zip(*sorted(points), strict=True)
        marker = "os^Dv"[number // len(Color.WINCHES) % 5]
        color = Color.WINCHES[number % len(Color.WINCHES)]
        axes.plot(used, value, color=color, linewidth=1.2, marker=marker, markersize=6, label=way, clip_on=False)
    axes.set_xlabel(across, color=Color.INK, fontsize=8.5)
    axes.set_ylabel(up, color=Color.INK, fontsize=8.5)
    if rows[0]["task"] == "reach":
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.xaxis.set_major_locator(LogLocator())
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda error, _: f"{error:g}"))
    else:
        axes.set_ylim(0, 100)
        axes.xaxis.set_major_locator(MultipleLocator(5000))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda used, _: f"{used:,.0f}".replace(",", "\N{THIN SPACE}")))
    axes.legend(
        frameon=False,
        fontsize=8,
        labelcolor=Color.INK,
        loc="upper left",
        bbox_to_anchor=(-0.05, -0.17),
        handlelength=1.6,
    )


if __name__ == "__main__":
    main()
