"""`front_chart`: what more winches and cables gain: error against number of cables."""

from collections.abc import Sequence

from hydrostat.plot.palette import WINCHES
from hydrostat.studio.designing.candidate import Candidate
from hydrostat.studio.designing.chart import Chart, polyline
from hydrostat.studio.designing.run import Mark
from hydrostat.units import counted

WIDTH, HEIGHT = 300.0, 176.0


def front_chart(candidates: Sequence[Candidate], trail: Sequence[Mark], chosen: int | None) -> str:
    """A dot for each candidate, in the colour of its number of winches, small ones for networks on the way, as SVG.

    The line goes through what is better than all with fewer cables: what more of them gain.

    Args:
        candidates: to compare.
        trail: networks on the way of the last design.
        chosen: number of the candidate with a ring.
    """
    errors = [(len(one.robot.cables), 1e3 * one.error) for one in candidates]
    way = [(mark.cables, 1e3 * mark.error) for mark in trail]
    chart = Chart(
        width=WIDTH,
        height=HEIGHT,
        across=max([cables for cables, _ in (*errors, *way)], default=1) + 0.6,
        up=1.1 * max([1e-3, *(error for _, error in (*errors, *way))]),
        name="error, mm",
        below="cables",
        whole=True,
    )

    def place(x: float, y: float) -> tuple[float, float]:
        return chart.x(x), chart.y(y)

    line = polyline([(float(x), y) for x, y in front([*errors, *way])], place)
    parts = [f'<polyline points="{line}" class="chart-front"/>']
    for cables, error in way:
        x, y = place(cables, error)
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" class="chart-way"/>')
    for one, (cables, error) in zip(candidates, errors, strict=True):
        x, y = place(cables, error)
        ring = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="9" class="chart-ring"/>' if one.number == chosen else ""
        colour = winch_count_colour(len(one.robot.winches))
        parts.append(f'{ring}<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="{colour}" class="chart-dot"/>')
    counts = sorted({len(one.robot.winches) for one in candidates})
    keys = [(winch_count_colour(count), counted(count, "winch")) for count in counts]
    return chart.drawn("".join([*parts, _legend(keys)]), label="error against number of cables")


def front(points: Sequence[tuple[int, float]]) -> list[tuple[int, float]]:
    """Of cables and errors, those with a smaller error than all with as few cables."""
    kept: list[tuple[int, float]] = []
    for cables, error in sorted(points):
        if not kept or error < kept[-1][1]:
            kept.append((cables, error))
    return kept


def winch_count_colour(winches: int) -> str:
    """The colour of all networks with so many winches."""
    return WINCHES[(winches - 1) % len(WINCHES)]


def _legend(keys: list[tuple[str, str]]) -> str:
    """Colours with their words, at the top from the right."""
    parts, x = [], WIDTH - 8
    for colour, words in reversed(keys[:3]):
        parts.append(f'<text x="{x:g}" y="12" class="chart-word" text-anchor="end">{words}</text>')
        x -= 7.4 * len(words) + 10
        parts.append(f'<circle cx="{x + 4:g}" cy="8" r="4" fill="{colour}"/>')
        x -= 8
    return "".join(parts)
