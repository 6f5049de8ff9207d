"""`front_chart`: what more winches and cables gain: error against number of cables."""

from collections.abc import Sequence

from hydrostat.plot.palette import WINCHES
from hydrostat.studio.designing.candidate import Candidate
from hydrostat.studio.designing.chart import Chart, polyline

WIDTH, HEIGHT = 300.0, 176.0


def front_chart(candidates: Sequence[Candidate], chosen: int | None) -> str:
    """A dot for each candidate, in the colour of its number of winches; the best of each number are joined, as SVG.

    Args:
        candidates: to compare.
        chosen: number of the one with a ring.
    """
    most = max((len(one.robot.cables) for one in candidates), default=1)
    highest = max((1e3 * one.error for one in candidates), default=1.0)
    chart = Chart(
        width=WIDTH, height=HEIGHT, across=most + 0.6, up=1.1 * max(highest, 1e-3), name="error, mm", below="cables",
        whole=True,
    )  # fmt: skip

    def place(x: float, y: float) -> tuple[float, float]:
        return chart.x(x), chart.y(y)

    parts, keys = [], []
    for winches in sorted({len(one.robot.winches) for one in candidates}):
        colour = winch_count_colour(winches)
        best: dict[int, float] = {}
        for one in candidates:
            if len(one.robot.winches) == winches:
                cables = len(one.robot.cables)
                best[cables] = min(1e3 * one.error, best.get(cables, float("inf")))
        points = sorted(best.items())
        line = polyline([(float(x), y) for x, y in points], place)
        parts.append(f'<polyline points="{line}" class="chart-front" stroke="{colour}"/>')
        keys.append((colour, f"{winches} winch" + ("es" if winches > 1 else "")))
    for one in candidates:
        x, y = place(len(one.robot.cables), 1e3 * one.error)
        ring = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="9" class="chart-ring"/>' if one.number == chosen else ""
        colour = winch_count_colour(len(one.robot.winches))
        parts.append(f'{ring}<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="{colour}" class="chart-dot"/>')
    return chart.drawn("".join([*parts, _legend(keys)]), label="error against number of cables")


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
