"""`LabelPlaces`: where words fit in a crowded picture."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from hydrostat.drawing import Box, Spot

_WAYS = [(np.cos(turn), np.sin(turn)) for turn in np.radians(np.arange(0, 360, 30))]
"""Directions that are tried, to the right first."""

_RINGS = (0.0, 1.5, 3.5, 6.0)  # how much further off than asked for a label may be, each tried in turn [mm]
_STEP = 0.5  # between points that stand for a line [mm]


@dataclass
class LabelPlaces:
    """What is taken on a picture, and places that are free."""

    room: Box  # nothing is put beyond it
    _points: list[np.ndarray] = field(default_factory=list)
    _boxes: list[Box] = field(default_factory=list)

    def take_line(self, way: Sequence[Spot], *, weight: int = 1) -> None:
        """A line is there: labels avoid it where they can, the more the heavier it is."""
        spots = np.array(way, dtype=float)
        for start, end in pairwise(spots):
            count = max(int(np.hypot(*(end - start)) / _STEP), 1) + 1
            self._points += weight * [start + np.linspace(0, 1, count)[:, None] * (end - start)]

    def take_box(self, box: Box) -> None:
        """Something is there that no label may cover."""
        self._boxes.append(box)

    def beside(
        self, at: Spot, size: tuple[float, float], *, gap: float, most: int = 1000, rings: int = 4
    ) -> Spot | None:
        """The middle of the best free place for a box near a spot, which is then taken; None if none is free.

        The box has this size and is a gap away [mm]; it may cover `most` points of lines; so many rings of places are
        tried.
        """
        best, least = None, float("inf")
        points = self._points_about(at, gap + _RINGS[-1] + max(size))
        for ring, further in enumerate(_RINGS[:rings]):
            for turn, (x, y) in enumerate(_WAYS):
                reach = gap + further
                middle = (at[0] + x * (reach + size[0] / 2), at[1] + y * (reach + size[1] / 2))
                box = _round(middle, size, 0.15)
                if not self._free(box):
                    continue
                covered = int(_within(points, box).sum())
                price = covered + 2.5 * ring + 0.01 * turn
                if covered <= most and price < least:
                    best, least = middle, price
        if best is not None:
            self.take_box(_round(best, size, 0.15))
        return best

    def _points_about(self, at: Spot, reach: float) -> np.ndarray:
        """The points of lines that a label near a spot could cover."""
        if len(self._points) > 1:
            self._points = [np.concatenate(self._points)]
        points = self._points[0] if self._points else np.zeros((0, 2))
        return points[_within(points, (at[0] - reach, at[1] - reach, at[0] + reach, at[1] + reach))]

    def _free(self, box: Box) -> bool:
        left, top, right, bottom = self.room
        if box[0] < left or box[1] < top or box[2] > right or box[3] > bottom:
            return False
        return not any(
            box[0] < other[2] and other[0] < box[2] and box[1] < other[3] and other[1] < box[3] for other in self._boxes
        )


def box_round(middle: Spot, radius: float) -> Box:
    """The square round a circle [mm]."""
    return _round(middle, (2 * radius, 2 * radius), 0.0)


def _round(middle: Spot, size: tuple[float, float], more: float) -> Box:
    wide, high = size[0] / 2 + more, size[1] / 2 + more
    return middle[0] - wide, middle[1] - high, middle[0] + wide, middle[1] + high


def _within(points: np.ndarray, box: Box) -> np.ndarray:
    x, y = points.T
    return (x > box[0]) & (x < box[2]) & (y > box[1]) & (y < box[3])
