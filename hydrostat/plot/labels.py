"""`Labels`: words beside points, where they cover least."""

import numpy as np
import shapely

from hydrostat.plot.palette import INK
from hydrostat.plot.places import Place, Places
from hydrostat.plot.sheet import Sheet

LONGEST = 26
"""Most letters of a name that a picture shows."""

HALO = "halo"
"""Group name of words that need a border of paper around their letters."""


class Labels:
    """Finds a free place for one label after another: outside the body, off other labels and off things to be seen."""

    def __init__(self, sheet: Sheet, *, rings: list[Places], avoid: Places) -> None:
        """Labels on a sheet.

        Args:
            sheet: to write on.
            rings: the drawn body [mm].
            avoid: points that should not be covered [mm].
        """
        self._sheet = sheet
        self._body = shapely.unary_union([shapely.Polygon(ring).buffer(0) for ring in rings[:1]]).simplify(0.5)
        self._avoid = avoid
        self._taken: list[np.ndarray] = []

    def place(self, at: Place, words: str, *, size: float = 8, weight: str = "normal", outside: float = 0.8) -> None:
        """Write words beside a point [mm]; `outside` is how much it matters that they lie off the body."""
        extent = np.array([0.6 * len(words) + 0.3, 1.25]) * size * self._sheet.scale
        centres = at + self._offsets(extent)
        boxes = np.concatenate([centres - extent / 2, centres + extent / 2], axis=1)
        best = int(np.argmin(self._costs(boxes, outside)))
        self._taken.append(boxes[best])
        x, y = centres[best]
        side = np.sign(np.round((centres[best] - at)[0] / extent[0], 2))
        align = {1.0: "left", -1.0: "right"}.get(float(side), "center")
        self._sheet.text(
            (x - side * extent[0] / 2, y), words, fontsize=size, color=INK, weight=weight, ha=align,
            va="center_baseline", gid=HALO, zorder=30,
        )  # fmt: skip

    def reserve(self, at: Place, size: float) -> None:
        """Keep a square [pt] around a point [mm] free of labels."""
        reach = size / 2 * self._sheet.scale
        self._taken.append(np.concatenate([at - reach, at + reach]))

    def _offsets(self, extent: np.ndarray) -> np.ndarray:
        """Centres of boxes around a point, nearest ring first, starting to the right."""
        angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
        rays = np.column_stack([np.cos(angles), np.sin(angles)])
        gaps = np.array([7.0, 10.0, 16.0, 25.0]) * self._sheet.scale
        sides = np.where(np.abs(rays) > 0.2, np.sign(rays), 0.0)
        return np.concatenate([rays * gap + sides * extent / 2 for gap in gaps])

    def _costs(self, boxes: np.ndarray, outside: float) -> np.ndarray:
        rectangles = shapely.box(*boxes.T)
        areas = shapely.area(rectangles)
        costs = np.repeat([0.0, 0.15, 0.5, 1.1], 16)
        costs = costs + outside * shapely.area(shapely.intersection(rectangles, self._body)) / areas
        if self._taken:
            others = shapely.box(*np.array(self._taken).T)
            costs = costs + 12 * sum(shapely.area(shapely.intersection(rectangles, other)) / areas for other in others)
        covered = ((self._avoid >= boxes[:, None, :2]) & (self._avoid <= boxes[:, None, 2:])).all(axis=2)
        frame = shapely.box(*self._sheet.low, *self._sheet.high)
        beyond = 1 - shapely.area(shapely.intersection(rectangles, frame)) / areas
        return costs + 0.25 * np.minimum(covered.sum(axis=1), 6) + 8 * beyond


def shorten(words: str) -> str:
    """Words fit for a picture: no control letters, and not too long."""
    plain = "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in words)
    return plain if len(plain) <= LONGEST else plain[: LONGEST - 1] + "\N{HORIZONTAL ELLIPSIS}"


def counted(number: int, one: str, many: str) -> str:
    """A number with its noun: "1 winch", "2 winches"."""
    return f"{number} {one if number == 1 else many}"
