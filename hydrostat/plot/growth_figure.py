"""`draw_growth`: how the pose error fell while a network grew."""

from collections.abc import Collection, Sequence

import numpy as np
from matplotlib.figure import Figure

from hydrostat.design.network import Stage
from hydrostat.plot.chart import new_chart
from hydrostat.plot.palette import ERROR, INK, MUTED, SEAM
from hydrostat.plot.sheet import MILLIMETRES, WIDTH


def draw_growth(
    stages: Sequence[Stage], *, rest: float | None = None, marked: Collection[int] = (), width: float = WIDTH
) -> Figure:
    """The error of each stage, counted from 1.

    Args:
        stages: in order.
        rest: error at rest [m], dashed, if it is to be seen.
        marked: indices of stages with a filled dot, from 0.
        width: of the picture [inch].
    """
    figure, axes = new_chart("stage", "pose error [mm rms]", width=width, height=0.46 * width)
    numbers, errors = np.arange(1, len(stages) + 1), MILLIMETRES * np.array([stage.error for stage in stages])
    axes.plot(numbers, errors, color=SEAM, linewidth=1.6, zorder=3)
    chosen = np.isin(numbers - 1, list(marked))
    look = {"linestyle": "none", "marker": "o", "markeredgecolor": SEAM, "zorder": 4, "clip_on": False}
    axes.plot(numbers[~chosen], errors[~chosen], markersize=3.2, color="white", markeredgewidth=0.9, **look)
    axes.plot(numbers[chosen], errors[chosen], markersize=6.0, color=SEAM, markeredgewidth=0.0, **look)
    most = float(errors.max(initial=0.0))
    if rest is not None:
        most = max(most, MILLIMETRES * rest)
        axes.axhline(MILLIMETRES * rest, color=ERROR, linewidth=1.0, linestyle=(0, (3, 2)), zorder=2)
        axes.annotate(
            "at rest", (1.0, MILLIMETRES * rest), xycoords=("axes fraction", "data"), xytext=(-2, -3),
            textcoords="offset points", fontsize=7.5, color=ERROR, ha="right", va="top",
        )  # fmt: skip
    if len(errors):
        axes.annotate(
            f"{errors[-1]:.2f} mm", (float(numbers[-1]), float(errors[-1])), xytext=(0, 7),
            textcoords="offset points", fontsize=8.5, color=INK, weight="bold", ha="right",
        )  # fmt: skip
    axes.set_ylim(0.0, 1.06 * most if most > 0 else 1.0)
    axes.set_xlim(1.0 - 0.02 * max(len(stages) - 1, 1), len(stages) + 0.02 * max(len(stages) - 1, 1))
    axes.tick_params(axis="y", labelcolor=MUTED)
    return figure
