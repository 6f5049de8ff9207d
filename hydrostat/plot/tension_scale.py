"""`TensionScale`: how much a fibre or cable pulls, as color and width."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, to_hex

from hydrostat.arrays import Vector
from hydrostat.drawing import Color
from hydrostat.plot.sheet import PictureSheet

LEVELS = 16  # lines are drawn in so many steps of tension; the eye tells no more


@dataclass(frozen=True)
class TensionScale:
    """Colors from no tension to the most."""

    most: float  # tension at the dark end [N]

    @classmethod
    def of(cls, tensions: Vector) -> Self:
        """The scale that just holds all tensions [N]."""
        most = float(np.max(tensions, initial=0.0))
        return cls(most if most > 0 else 1.0)

    def color(self, tension: float) -> str:
        """Color of a tension [N], as #rrggbb."""
        return to_hex(_colors()(min(max(tension / self.most, 0.0), 1.0)))

    def draw_lines(self, sheet: PictureSheet, ends: np.ndarray, tensions: Vector, *, widest: float = 4.2) -> None:
        """Lines [mm], (lines, 2, 2), the stronger the wider, darker and further in front; slack ones as hair lines."""
        levels = np.clip(np.ceil(tensions / self.most * LEVELS), 0, LEVELS).astype(int)
        sheet.segments(ends[levels == 0], color=self.color(0), linewidth=0.3, alpha=0.5, zorder=6)
        for level in range(1, LEVELS + 1):
            share = (level - 0.5) / LEVELS
            sheet.segments(
                ends[levels == level],
                color=self.color(share * self.most),
                linewidth=0.5 + (widest - 0.5) * share,
                zorder=6 + share,
            )

    def draw_bar(self, sheet: PictureSheet, *, of: str = "tension") -> None:
        """A small bar in the upper right corner that tells what the colors mean."""
        figure = sheet.figure
        width, height = figure.get_size_inches()
        bar = figure.add_axes(((width - 1.75) / width, 1 - 0.40 / height, 1.4 / width, 0.07 / height))
        bar.imshow(np.linspace(0, 1, 128)[None], aspect="auto", cmap=_colors(), extent=(0, 1, 0, 1))
        bar.set(yticks=[])
        bar.set_xticks([0, 0.5, 1], ["0", _two_digits(self.most / 2), f"{_two_digits(self.most)} N"])
        bar.tick_params(length=0, pad=3, labelsize=7, labelcolor=Color.MUTED)
        bar.set_title(of, fontsize=7, color=Color.INK, loc="left", pad=3)
        for spine in bar.spines.values():
            spine.set(color=Color.MUTED, linewidth=0.4)


def _two_digits(value: float) -> str:
    """Number to two digits, without an exponent where it is large."""
    return f"{value:.2g}" if value < 99.5 else f"{float(f'{value:.2g}'):.0f}"


def _colors() -> LinearSegmentedColormap:
    return LinearSegmentedColormap.from_list("tension", Color.TENSION)
