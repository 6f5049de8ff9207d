"""Pictures of learning. Oracle: where matplotlib puts lines and words."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg

from hydrostat.plot import draw_curves


def test_long_names_stay_within_the_picture_of_curves() -> None:
    """Five names of twenty letters need two rows, which lie below the words of the axes."""
    curve = (np.arange(1.0, 5.0), np.ones((4, 2)))
    figure = draw_curves({"share": {f"shaped, with no cut {number}": curve for number in range(5)}})
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    legend = figure.legends[0].get_window_extent()
    words = figure.axes[0].xaxis.label.get_window_extent()
    assert 0 <= legend.x0 < legend.x1 <= figure.bbox.x1
    assert 0 <= legend.y0 < legend.y1 <= words.y0
