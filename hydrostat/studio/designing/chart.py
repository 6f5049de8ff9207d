"""`Chart`: the frame of a small chart as SVG, with scales from 0."""

import math
from collections.abc import Callable
from dataclasses import dataclass

LEFT, RIGHT, TOP, BOTTOM = 34.0, 10.0, 20.0, 32.0
"""Room for the numbers and words around a chart."""


@dataclass(frozen=True, kw_only=True)
class Chart:
    """A chart whose both scales begin at 0.

    Attributes:
        width: of the picture.
        height: of the picture.
        across: the largest value across.
        up: the largest value upwards.
        name: of what runs upwards, written at the top.
        below: of what runs across, written at the bottom.
        whole: whether values across are whole numbers.
    """

    width: float
    height: float
    across: float
    up: float
    name: str
    below: str
    whole: bool = False

    def x(self, value: float) -> float:
        """Where a value across is."""
        return LEFT + (self.width - LEFT - RIGHT) * value / self.across

    def y(self, value: float) -> float:
        """Where a value upwards is."""
        return self.height - BOTTOM - (self.height - TOP - BOTTOM) * value / self.up

    def drawn(self, inside: str, *, label: str) -> str:
        """The chart with what is drawn inside.

        Args:
            inside: SVG.
            label: for who cannot see it.
        """
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
    """Round values from 0 up to the largest.

    Args:
        largest: none is above.
        most: so many steps at most.
        least: no step is smaller.
    """
    raw = max(largest / most, least, 1e-9)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw * (1 - 1e-9))
    if least:
        step = max(round(step), 1)
    return [float(f"{index * step:.6g}") for index in range(int(largest / step * (1 + 1e-9)) + 1)]


def polyline(points: list[tuple[float, float]], place: Callable[[float, float], tuple[float, float]]) -> str:
    """A line through points, for the attribute `points`."""
    return " ".join("{:.1f},{:.1f}".format(*place(x, y)) for x, y in points)
