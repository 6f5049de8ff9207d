"""`front_chart`, `growth_chart`: what more sewing gains, and how the error falls while a design runs, as SVG."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from hydrostat.design import front
from hydrostat.drawing import Color
from hydrostat.studio.designing.design_work import Candidate
from hydrostat.studio.designing.run import DesignRun, ProgressPoint
from hydrostat.units import plural

LEFT, RIGHT, TOP, BOTTOM = 34.0, 10.0, 20.0, 32.0  # room for the numbers and words around a chart


@dataclass(frozen=True, kw_only=True)
class Chart:
    """A chart whose both scales begin at 0."""

    width: float  # of the picture
    height: float  # of the picture
    across: float  # the largest value across
    up: float  # the largest value upwards
    name: str  # of what runs upwards, written at the top
    below: str  # of what runs across, written at the bottom
    whole: bool = False  # whether values across are whole numbers

    def x(self, value: float) -> float:
        """Horizontal position of a value on the chart [px]."""
        return LEFT + (self.width - LEFT - RIGHT) * value / self.across

    def y(self, value: float) -> float:
        """Vertical position of a value on the chart [px]."""
        return self.height - BOTTOM - (self.height - TOP - BOTTOM) * value / self.up

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Position of a pair of values on the chart [px]."""
        return self.x(x), self.y(y)

    def line(self, points: Iterable[tuple[float, float]]) -> str:
        """A line through pairs of values, for the attribute `points`."""
        return " ".join("{:.1f},{:.1f}".format(*self.place(x, y)) for x, y in points)

    def render(self, inside: str, *, label: str) -> str:
        """Render the chart around some SVG, with a label for screen readers."""
        parts = [
            f'<svg viewBox="0 0 {self.width:g} {self.height:g}" class="chart" role="img" aria-label="{label}">',
            f'<text x="0" y="12" class="chart-word">{self.name}</text>',
            f'<text x="{self.width - RIGHT:g}" y="{self.height - 1:g}" class="chart-word" text-anchor="end">'
            f"{self.below}</text>",
        ]
        right = self.width - RIGHT
        for value in ticks(self.up, most=3):
            y = self.y(value)
            parts.append(f'<line x1="{LEFT:g}" x2="{right:g}" y1="{y:.1f}" y2="{y:.1f}" class="chart-grid"/>')
            parts.append(_tick(LEFT - 6, y + 4, value, "end"))
        below = ticks(self.across, most=6, least=1.0 if self.whole else 0.0)
        parts += [_tick(self.x(value), self.height - BOTTOM + 14, value, "middle") for value in below]
        return "".join(parts) + inside + "</svg>"


def _tick(x: float, y: float, value: float, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" class="chart-tick" text-anchor="{anchor}">{value:g}</text>'


def ticks(largest: float, *, most: int, least: float = 0.0) -> list[float]:
    """Round values from 0 up to the largest: at most so many steps, none of them smaller than the least."""
    raw = max(largest / most, least, 1e-9)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw * (1 - 1e-9))
    if least:
        step = max(round(step), 1)
    return [float(f"{index * step:.6g}") for index in range(int(largest / step * (1 + 1e-9)) + 1)]


FRONT_WIDTH, FRONT_HEIGHT = 300.0, 196.0

Place = tuple[float, float]  # in a picture


def front_chart(candidates: Sequence[Candidate], trail: Sequence[ProgressPoint], chosen: int | None) -> str:
    """A dot for each candidate's error as built over its minutes of sewing, in the color of its winches, as SVG.

    The number beside a dot counts cables. Small dots are the networks on the way of the last design, from its trail.
    The line goes through what is better than all that are sewn as fast: what more sewing gains. The candidate of the
    chosen number has a ring.
    """
    errors = [(one.craft.minutes, 1e3 * one.expected_error) for one in candidates]
    way = [(mark.minutes, 1e3 * mark.error) for mark in trail]
    chart = Chart(
        width=FRONT_WIDTH,
        height=FRONT_HEIGHT,
        across=1.06 * max([1.0, *(minutes for minutes, _ in (*errors, *way))]),
        up=1.18 * max([1e-3, *(error for _, error in (*errors, *way))]),
        name="error, mm",
        below=f"{candidates[0].craft.work if candidates else 'sewing'} time, min",
        whole=True,
    )
    points = [*errors, *way]
    line = chart.line(points[index] for index in front(points))
    parts = [f'<polyline points="{line}" class="chart-front"/>']
    parts += ['<circle cx="{:.1f}" cy="{:.1f}" r="2.5" class="chart-way"/>'.format(*chart.place(*mark)) for mark in way]
    places = [chart.place(*error) for error in errors]
    for one, (x, y) in zip(candidates, places, strict=True):
        ring = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="9" class="chart-ring"/>' if one.number == chosen else ""
        color = winch_count_color(len(one.robot.winches))
        parts.append(f'{ring}<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="{color}" class="chart-dot"/>')
    parts += _counts(candidates, places, chosen)
    counts = sorted({len(one.robot.winches) for one in candidates})
    keys = [(winch_count_color(count), plural(count, "winch")) for count in counts]
    return chart.render("".join([*parts, _legend(keys)]), label="expected as-built error against sewing time")


def _counts(candidates: Sequence[Candidate], places: Sequence[Place], chosen: int | None) -> Iterator[str]:
    """The number of cables above each dot, that of the chosen one first; where two would meet the later is left out."""
    written: list[Place] = []
    order = sorted(range(len(candidates)), key=lambda index: candidates[index].number != chosen)
    apart = (16.0, 11.0)  # numbers nearer to each other than this, across and upwards, would be one blot
    for index in order:
        x, y = places[index][0], places[index][1] - (13 if candidates[index].number == chosen else 9)
        if all(abs(x - left) > apart[0] or abs(y - low) > apart[1] for left, low in written):
            written.append((x, y))
            yield (
                f'<text x="{x:.1f}" y="{y:.1f}" class="chart-count" text-anchor="middle">'
                f"{len(candidates[index].robot.cables)}</text>"
            )


def winch_count_color(winches: int) -> str:
    """The color of all networks with so many winches."""
    return Color.WINCHES[(winches - 1) % len(Color.WINCHES)]


def _legend(keys: list[tuple[str, str]]) -> str:
    """Colors with their words, at the top from the right."""
    parts, x = [], FRONT_WIDTH - 8
    for color, words in reversed(keys[:3]):
        parts.append(f'<text x="{x:g}" y="12" class="chart-word" text-anchor="end">{words}</text>')
        x -= 7.4 * len(words) + 10
        parts.append(f'<circle cx="{x + 4:g}" cy="8" r="4" fill="{color}"/>')
        x -= 8
    return "".join(parts)


def growth_chart(run: DesignRun, seconds: float) -> str:
    """The error against time, up to so many seconds since the run began, as SVG."""
    errors = [1e3 * run.rest, *(1e3 * mark.error for mark in run.trail)]
    times = [0.0, *(mark.seconds for mark in run.trail)]
    end = max(seconds, times[-1], 1.0)
    growth_width, growth_height = 316.0, 132.0
    chart = Chart(
        width=growth_width,
        height=growth_height,
        across=end,
        up=1.05 * max(*errors, 1e-3),
        name="error, mm",
        below="seconds",
    )
    steps = [(0.0, errors[0])]
    for time, before, after in zip(times[1:], errors, errors[1:], strict=False):
        steps += [(time, before), (time, after)]
    steps.append((end, errors[-1]))
    line = chart.line(steps)
    floor = chart.y(0.0)
    area = f"{chart.x(0.0):.1f},{floor:.1f} {line} {chart.x(end):.1f},{floor:.1f}"
    x, y = chart.place(end, errors[-1])
    inside = (
        f'<polygon points="{area}" class="chart-area"/><polyline points="{line}" class="chart-line"/>'
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" class="chart-now"/>'
    )
    return chart.render(inside, label=f"error of the best network, now {errors[-1]:.1f} mm")
