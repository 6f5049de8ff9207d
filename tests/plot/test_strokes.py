"""Lines of a film are drawn as matplotlib's own Line2D, which is the oracle, draws them: the same pixels."""

from dataclasses import replace

import numpy as np
import pytest

from hydrostat.plot.picture_file import figure_pixels
from hydrostat.plot.sheet import PictureSheet, new_sheet
from hydrostat.plot.strokes import StrokeLayers

_RANDOM = np.random.default_rng(3)
LONG, FEW = np.cumsum(_RANDOM.normal(size=(400, 2)), axis=0), _RANDOM.uniform(-20, 20, (7, 2))
ENDS = _RANDOM.uniform(-20, 20, (5, 2, 2))


def draw(sheet: PictureSheet) -> None:
    """Lines, broken lines, dots and what only a Line2D draws, some above others."""
    sheet.curve(LONG, color="#2b2833", linewidth=2.6, zorder=7.0)
    sheet.curve(LONG[::9], color="#c33149", linewidth=4.4, alpha=0.6, zorder=6.5)
    sheet.segments(ENDS, color="#0e7c66", linewidth=1.1, solid_capstyle="butt", zorder=9)
    sheet.dots(FEW, 9.0, color="#0b5fa5", markeredgecolor="#ffffff", zorder=8.0)
    sheet.dots(FEW, 3.0, color="#ffffff", markeredgecolor="none", markeredgewidth=0.6, zorder=8.0)
    sheet.curve(FEW[:1], linestyle="none", marker="s", markersize=13.0, color="#ffffff", markeredgecolor="k", zorder=5)
    sheet.curve(FEW, color="k", linewidth=1.2, linestyle=(0, (2.4, 2.0)), dash_capstyle="butt", zorder=8.5)


@pytest.mark.parametrize("dpi", [80, 133])
def test_lines_and_dots_are_the_pixels_of_separate_artists(dpi: int) -> None:
    pictures = []
    for layered in (False, True):
        sheet = new_sheet(np.array([[-25.0, -25.0], [25.0, 25.0]]), width=3.0, ruled=False)
        layers = StrokeLayers(sheet.axes)
        sheet = replace(sheet, layers=layers) if layered else sheet
        draw(sheet)
        assert len(sheet.axes.lines) == (1 if layered else 7), "all but the dashed line are in layers"
        pictures.append(figure_pixels(sheet.figure, dpi=dpi))
        layers.clear()
        assert len(sheet.axes.artists) == 0
    np.testing.assert_array_equal(*pictures)
    assert (pictures[0][..., 3] > 0).mean() > 0.05, "there is something to see"
