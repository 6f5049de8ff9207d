"""`growth_chart`: how the error of the best network falls while a design runs."""

from hydrostat.studio.designing.chart import Chart, polyline
from hydrostat.studio.designing.run import Run

WIDTH, HEIGHT = 316.0, 132.0


def growth_chart(run: Run, seconds: float) -> str:
    """The error against time, as SVG.

    Args:
        run: so far.
        seconds: since it began.
    """
    errors = [1e3 * run.rest, *(1e3 * mark.error for mark in run.trail)]
    times = [0.0, *(mark.seconds for mark in run.trail)]
    end = max(seconds, times[-1], 1.0)
    chart = Chart(
        width=WIDTH, height=HEIGHT, across=end, up=1.05 * max(*errors, 1e-3), name="error, mm", below="seconds"
    )
    steps = [(0.0, errors[0])]
    for time, before, after in zip(times[1:], errors, errors[1:], strict=False):
        steps += [(time, before), (time, after)]
    steps.append((end, errors[-1]))

    def place(x: float, y: float) -> tuple[float, float]:
        return chart.x(x), chart.y(y)

    line = polyline(steps, place)
    floor = chart.y(0.0)
    area = f"{chart.x(0.0):.1f},{floor:.1f} {line} {chart.x(end):.1f},{floor:.1f}"
    x, y = place(end, errors[-1])
    inside = (
        f'<polygon points="{area}" class="chart-area"/><polyline points="{line}" class="chart-line"/>'
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" class="chart-now"/>'
    )
    return chart.drawn(inside, label=f"error of the best network, now {errors[-1]:.1f} mm")
