"""Pictures of what was learned. Oracle: where matplotlib puts lines and words."""

from hydrostat_lab.learning_figures import draw_costs


def test_names_of_ways_are_within_the_picture_beside_the_chart() -> None:
    drawn = draw_costs({"residual on the clone": [(500, 20.0), (6000, 7.0)], "ridge": [(500, 9.0)]})
    drawn.canvas.draw()
    axes, whole = drawn.axes[0], drawn.bbox
    legend, chart = axes.get_legend().get_window_extent(), axes.get_window_extent()
    assert legend.x1 < whole.x1
    assert legend.x0 >= chart.x1 - 1
