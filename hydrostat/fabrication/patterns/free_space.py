"""`FreeSpace`: the room left on a panel, so that labels stay off holes and lines."""

from collections.abc import Iterable

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from hydrostat.fabrication.patterns.shape import Line, Place, Shape

_CLEARANCE = 1.2
"""Empty cloth kept round whatever is placed [mm]."""

_TIGHT = 1.05
"""Empty cloth kept round the small figures at holes [mm]."""

_OVER_TEXT = 10
"""A label over another is as bad as one over so many more lines."""

_THROUGH_TEXT = 3
"""So is a line to a label through another, for so many."""

_ROOMY = 6.0
"""Empty cloth beyond which more is no better [mm]."""


class FreeSpace:
    """What is still empty inside an outline. Whatever is placed takes its room."""

    def __init__(self, inside: Polygon, shapes: Iterable[Shape]) -> None:
        self._inside = inside
        lines = [shapely.get_coordinates(shape.geometry) for shape in shapes]
        pairs = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])
        self._taken: list[BaseGeometry] = [shapely.LineString(pair) for pair in pairs]
        self._texts: list[BaseGeometry] = []
        shapely.prepare(inside)

    def beside(self, at: Place, width: float, height: float, *, gap: float) -> Place:
        """Middle of a box as near to a place as there is room, else where it crosses the least [mm]."""
        reach, angle = np.meshgrid(gap + np.arange(0, 14, 1.5), np.arange(0, 2 * np.pi, np.pi / 8), indexing="ij")
        x = at[0] + np.cos(angle) * (reach + width / 2)
        y = at[1] + np.sin(angle) * (reach + height / 2)
        centres = np.column_stack([x.ravel(), y.ravel()])
        crossings = self._crossings(centres, _boxes(centres, width, height))
        leaders = np.array([shapely.LineString([at, centre]) for centre in centres])
        crossings += _THROUGH_TEXT * _hits(self._texts, leaders)
        x, y = centres[np.argmin(crossings)].tolist()
        return x, y

    def clear_beside(self, at: Place, width: float, height: float, *, gap: float) -> Place | None:
        """Middle of a box near to a place that crosses nothing [mm]; None if there is none."""
        reach, angle = np.meshgrid(gap + np.arange(0, 2.5, 0.5), np.arange(0, 2 * np.pi, np.pi / 8), indexing="ij")
        x = at[0] + np.cos(angle) * (reach + width / 2)
        y = at[1] + np.sin(angle) * (reach + height / 2)
        centres = np.column_stack([x.ravel(), y.ravel()])
        crossings = self._crossings(centres, _boxes(centres, width, height, _TIGHT))
        if crossings.min():
            return None
        x, y = centres[np.argmin(crossings)].tolist()
        return x, y

    def anywhere(self, width: float, height: float) -> Place | None:
        """Middle of a box where there is most room, rather near the middle of the panel [mm]; None if nowhere."""
        left, bottom, right, top = self._inside.bounds
        x, y = np.meshgrid(np.arange(left, right, 3.0), np.arange(bottom, top, 3.0))
        centres = np.column_stack([x.ravel(), y.ravel()])
        boxes = _boxes(centres, width, height)
        free = self._crossings(centres, boxes) == 0
        if not free.any():
            return None
        centres, boxes, middle = centres[free], boxes[free], self._inside.centroid
        far = np.hypot(centres[:, 0] - middle.x, centres[:, 1] - middle.y)
        x, y = centres[np.argmax(self._room(boxes) - 0.05 * far)].tolist()
        return x, y

    def take(self, middle: Place, width: float, height: float) -> None:
        """Keep what is placed later off a box."""
        box = _boxes(np.array([middle]), width, height)
        self._taken.extend(box)
        self._texts.extend(box)

    def take_line(self, line: Line) -> None:
        """Keep what is placed later off a line to a label."""
        self._taken.append(line.geometry)

    def _crossings(self, centres: np.ndarray, boxes: np.ndarray) -> np.ndarray:
        """How many things each box lies on, another label counting as many; very many for a box outside."""
        outside = ~shapely.contains_xy(self._inside, centres)
        return _hits(self._taken, boxes) + _OVER_TEXT * _hits(self._texts, boxes) + 1000 * outside

    def _room(self, boxes: np.ndarray) -> np.ndarray:
        """Distance from each box to what is next to it, up to `_ROOMY` [mm]."""
        room = np.full(len(boxes), _ROOMY)
        found, distances = shapely.STRtree(self._taken).query_nearest(
            boxes, max_distance=_ROOMY, return_distance=True, all_matches=False
        )
        room[found[0]] = distances
        return room


def _hits(taken: list[BaseGeometry], geometries: np.ndarray) -> np.ndarray:
    """How many of the things each geometry meets."""
    found = shapely.STRtree(taken).query(geometries, predicate="intersects")[0]
    return np.bincount(found, minlength=len(geometries))


def _boxes(centres: np.ndarray, width: float, height: float, clearance: float = _CLEARANCE) -> np.ndarray:
    half = np.array([width / 2 + clearance, height / 2 + clearance])
    low, high = centres - half, centres + half
    return shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
