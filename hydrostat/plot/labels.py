"""`Labels`: words beside points, where they cover least."""

from collections.abc import Iterable, Sequence

import numpy as np
import shapely

from hydrostat.drawing import Color
from hydrostat.plot.sheet import PictureSheet, Place, Places

HALO = "halo"  # group name of words that need a border of paper around their letters
RAYS = 16  # directions in which a label is tried


class Labels:
    """Finds a free place for one label after another: off the body, off other labels and off what is to be seen."""

    def __init__(self, sheet: PictureSheet, *, rings: list[Places], avoid: Places) -> None:
        """Labels on a sheet, beside the rings of the drawn body; points to avoid should not be covered."""
        self._sheet = sheet
        self._body = shapely.unary_union([shapely.Polygon(ring).buffer(0) for ring in rings[:1]]).simplify(0.5)
        self._avoid = avoid
        self._taken: list[np.ndarray] = [np.array(box) for box in sheet.kept]

    def avoid(self, lines: Iterable[Places]) -> None:
        """Keep labels off points of lines, such as arrows."""
        self._avoid = np.concatenate([self._avoid, *lines])

    def place(
        self,
        at: Place,
        words: str,
        *,
        size: float = 8,
        weight: str = "normal",
        outside: float = 0.8,
        color: str = Color.INK,
    ) -> None:
        """Write words beside a point; `outside` is how much it matters that they lie off the body."""
        extent = np.array([0.6 * len(words) + 0.3, 1.25]) * size * self._sheet.scale
        center = self._find(at, extent, (7.0, 10.0, 16.0, 25.0), outside)
        side = float(np.sign(np.round((center - at)[0] / extent[0], 2)))
        align = {1.0: "left", -1.0: "right"}.get(side, "center")
        self._sheet.text(
            (center[0] - side * extent[0] / 2, center[1]), words, fontsize=size, color=color, weight=weight,
            ha=align, va="center_baseline", gid=HALO, zorder=30,
        )  # fmt: skip

    def flags(self, places: Places, words: Sequence[str], colors: Sequence[str]) -> None:
        """Write words on colored flags, each tied to a point by a line that crosses other lines and boxes least."""
        extents = np.array([[0.74 * len(text) + 1.2, 1.9] for text in words]) * 7 * self._sheet.scale
        first, max_sweeps = len(self._taken), 6  # each flag is placed again, next to all others, until none moves
        centers: dict[int, Place] = {}
        for _ in range(max_sweeps):
            before = dict(centers)
            for number in range(len(extents)):
                if number in centers:
                    del centers[number], self._taken[first]
                leaders = [np.array([places[other], center]) for other, center in centers.items()]
                centers[number] = self._find(
                    places[number], extents[number], (12.0, 18.0, 27.0, 40.0, 60.0, 85.0, 115.0), 0.0, leaders=leaders
                )
            if before and all(np.array_equal(center, before[number]) for number, center in centers.items()):
                break
        for number, text in enumerate(words):
            at, center = places[number], centers[number]
            self.avoid([np.linspace(at, center, 12)])
            self._sheet.curve(np.array([at, center]), color=colors[number], linewidth=0.9, zorder=10)
            self._sheet.text(
                (center[0], center[1]), text, fontsize=7, color=Color.LIGHT, weight="bold", ha="center",
                va="center_baseline", zorder=25, bbox={"boxstyle": "round,pad=0.32,rounding_size=0.6",
                "facecolor": colors[number], "edgecolor": Color.LIGHT, "linewidth": 0.7},
            )  # fmt: skip

    def reserve(self, at: Place, size: float) -> None:
        """Keep a square [pt] around a point free of labels."""
        reach = size / 2 * self._sheet.scale
        self._taken.append(np.concatenate([at - reach, at + reach]))

    def _find(
        self,
        at: Place,
        extent: np.ndarray,
        gaps: tuple[float, ...],
        outside: float,
        *,
        leaders: Sequence[Places] | None = None,
    ) -> np.ndarray:
        """Center of the best box of an extent next to a point, now taken; gaps [pt] from most to least preferred.

        With `leaders`, which may be none, the line to the box should cross neither these nor other boxes.
        """
        angles = np.linspace(0, 2 * np.pi, RAYS, endpoint=False)
        rays = np.column_stack([np.cos(angles), np.sin(angles)])
        sides = np.where(np.abs(rays) > 0.2, np.sign(rays), 0.0) * extent / 2
        centers = np.concatenate([at + rays * gap * self._sheet.scale + sides for gap in gaps])
        boxes = np.concatenate([centers - extent / 2, centers + extent / 2], axis=1)
        far = np.repeat((np.array(gaps) - gaps[0]) / 16, RAYS)
        crossed = 0.0 if leaders is None else self._count_crossed(at, centers, leaders)
        best = int(np.argmin(far + 5 * crossed + self._costs(boxes, outside)))
        self._taken.append(boxes[best])
        return centers[best]

    def _count_crossed(self, at: Place, centers: np.ndarray, leaders: Sequence[Places]) -> np.ndarray:
        """Number of leaders and boxes that the line from a point to each center crosses, without boxes round it."""
        lines = np.asarray(shapely.linestrings(np.stack([np.broadcast_to(at, centers.shape), centers], axis=1)))
        boxes = [box for box in self._taken if not ((at >= box[:2]) & (at <= box[2:])).all()]
        others = [*map(shapely.LineString, leaders), *(shapely.box(*box) for box in boxes)]
        return sum((shapely.intersects(lines, other) for other in others), np.zeros(len(lines)))

    def _costs(self, boxes: np.ndarray, outside: float) -> np.ndarray:
        areas = _shared_areas(boxes, boxes)
        costs = np.zeros(len(boxes))
        if outside:
            rectangles = shapely.box(*boxes.T)
            costs = outside * shapely.area(shapely.intersection(rectangles, self._body)) / areas
        for other in self._taken:
            size = float(np.prod(other[2:] - other[:2]))  # a small part of a long label hides a spool
            costs = costs + 30 * _shared_areas(boxes, other) / np.minimum(areas, max(size, 1e-9))
        covered = ((self._avoid >= boxes[:, None, :2]) & (self._avoid <= boxes[:, None, 2:])).all(axis=2)
        beyond = 1 - _shared_areas(boxes, np.concatenate([self._sheet.low, self._sheet.high])) / areas
        return costs + 0.2 * np.minimum(covered.sum(axis=1), 8) + 100 * beyond


def _shared_areas(boxes: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Area that each box (left, lower, right, upper) shares with one other, or with its own of as many."""
    sides = np.minimum(boxes[:, 2:], other[..., 2:]) - np.maximum(boxes[:, :2], other[..., :2])
    return np.maximum(sides, 0.0).prod(axis=1)


def shorten(words: str) -> str:
    """Words fit for a picture: no control letters, and not too long."""
    plain = "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in words)
    longest = 26  # most letters of a name that a picture shows
    return plain if len(plain) <= longest else plain[: longest - 1] + "\N{HORIZONTAL ELLIPSIS}"
