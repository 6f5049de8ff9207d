"""`draw_identified`: measured markers and those of the assumed and the fitted robot."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hydrostat.drawing import Color
from hydrostat.identification import IdentifiedRobot, Measurements, rms
from hydrostat.plot.chart import plain_axes
from hydrostat.units import MILLIMETERS

FITTED, ASSUMED = Color.WINCHES[0], "#b9b4c0"


def draw_identified(measurements: Measurements, found: IdentifiedRobot) -> Figure:
    """Measured and predicted places of all markers along two axes, with a line from each to its measurement [mm]."""
    seen = measurements.places
    before, after = (fitted.predict(measurements) for fitted in (found.assumed, found.fitted))
    dim = seen.shape[2]
    views = [(0, 1)] if dim == 2 else [(0, 2), (0, 1)]
    figure = Figure(figsize=(4.6 * len(views), 4.6), dpi=130, layout="constrained")
    for index, view in enumerate(views):
        axes = figure.add_subplot(1, len(views), index + 1)
        _draw_view(axes, [MILLIMETERS * places[..., view].reshape(-1, 2) for places in (seen, before, after)])
        axes.set(xlabel=f"{'xyz'[view[0]]} [mm]", ylabel=f"{'xyz'[view[1]]} [mm]")
        axes.margins(0.08)
        axes.set_aspect("equal", adjustable="datalim")
    figure.axes[0].legend(frameon=False, fontsize=8, loc="best")
    assumed, fitted = MILLIMETERS * rms(found.before), MILLIMETERS * rms(found.after)
    figure.suptitle(f"rms error {assumed:.2f} mm as assumed, {fitted:.2f} mm fitted", fontsize=10)
    return figure


def _draw_view(axes: Axes, places: list[np.ndarray]) -> None:
    seen, before, after = places
    plain_axes(axes, size=8)
    for predicted, color in ((before, ASSUMED), (after, FITTED)):
        for start, end in zip(seen, predicted, strict=True):
            axes.plot(*np.array([start, end]).T, color=color, linewidth=0.8, zorder=1)
    # Sizes differ, so that each dot shows where all three are at one place.
    axes.scatter(*before.T, s=26, color=ASSUMED, label="as assumed", zorder=2)
    axes.scatter(*after.T, s=7, color=FITTED, label="fitted", zorder=3)
    axes.scatter(*seen.T, s=48, facecolors="none", edgecolors=Color.INK, linewidths=0.7, label="measured", zorder=4)
