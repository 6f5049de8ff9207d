"""`lay_out`: panels on one sheet, side by side, the strips below them, the bar of 100 mm at the bottom."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import shapely

from hydrostat.fabrication.patterns.lettering import Lettering
from hydrostat.fabrication.patterns.shape import LaserLine, Layer, Panel, PatternPart, Place

_RULER = 100.0  # length of the bar that shows whether the sheet was cut at its true scale [mm]


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """Panels in their places."""

    panels: tuple[Panel, ...]  # in the order in which they were given
    ruler: tuple[LaserLine, ...]  # the bar of 100 mm, and what solid and dashed lines are
    width: float  # [mm]
    height: float  # [mm]


class _PanelBox(NamedTuple):
    """A panel with the bounds of all its shapes [mm]."""

    panel: Panel
    low: np.ndarray
    size: np.ndarray


def lay_out(panels: tuple[Panel, ...], strips: tuple[Panel, ...], gap: float) -> Sheet:
    """Lay panels in a row, and strips below them in rows that are no wider, a gap [mm] between all."""
    row, others = [_bounds(panel) for panel in panels], [_bounds(strip) for strip in strips]
    width = max(
        sum(box.size[0] + gap for box in row) + gap, _RULER + 30 + 2 * gap, *(box.size[0] + 2 * gap for box in others)
    )
    ruler_height = 12.0  # room for the bar and its text below the panels [mm]
    floor = gap + ruler_height
    laid: dict[str, Panel] = {}
    for shelf in (*reversed(_shelves(others, width - gap, gap)), row):
        left = gap
        for box in shelf:
            laid[box.panel.name] = box.panel.move(left - float(box.low[0]), floor - float(box.low[1]))
            left += float(box.size[0]) + gap
        floor += float(max(box.size[1] for box in shelf)) + gap
    return Sheet(
        panels=tuple(laid[panel.name] for panel in (*panels, *strips)),
        ruler=tuple(line.move(gap, gap) for line in (*_ruler(), *_key(float(width) - 2 * gap))),
        width=float(width),
        height=floor,
    )


def _shelves(boxes: list[_PanelBox], width: float, gap: float) -> list[list[_PanelBox]]:
    """Rows of boxes: each goes to the first row that has room for it, the longest first."""
    shelves: list[list[_PanelBox]] = []
    for box in sorted(boxes, key=lambda box: -round(float(box.size[0]), 6)):
        used = [sum(float(other.size[0]) + gap for other in shelf) + gap for shelf in shelves]
        free = next((shelf for shelf, left in zip(shelves, used, strict=True) if left + box.size[0] <= width), None)
        if free is None:
            shelves.append([box])
        else:
            free.append(box)
    return shelves


def _bounds(panel: Panel) -> _PanelBox:
    bounds = shapely.total_bounds(np.array([shape.geometry for shape in panel.shapes]))
    return _PanelBox(panel, bounds[:2], bounds[2:] - bounds[:2])


def _ruler() -> tuple[LaserLine, ...]:
    """A bar of 100 mm from (0, 0) to the right, a stroke every 10 mm."""
    strokes: list[tuple[Place, ...]] = [((0.0, 0.0), (_RULER, 0.0))]
    strokes += [((x, 0.0), (x, 4.0 if x % 50 == 0 else 2.0)) for x in np.arange(0.0, _RULER + 1, 10.0).tolist()]
    bar = tuple(LaserLine(layer=Layer.MARK, part=PatternPart.RULER, points=points) for points in strokes)
    text = Lettering(f"{_RULER:g} mm", 4.0)
    return (*bar, *text.lines((_RULER + 4 + text.width / 2, 2.0)))


def _key(width: float) -> tuple[LaserLine, ...]:
    """Return the legend of the cable lines, right of the bar, as far as it fits the sheet's width [mm]."""
    dashes = tuple(((start, 0.0), (start + 2.0, 0.0)) for start in (0.0, 3.3, 6.7, 10.0))
    samples: tuple[tuple[str, PatternPart, tuple[tuple[Place, ...], ...]], ...] = (
        ("cable outside", PatternPart.CABLE, (((0.0, 0.0), (12.0, 0.0)),)),
        ("cable inside", PatternPart.CABLE, dashes),
        ("sheath inside", PatternPart.SHEATH, (((0.0, 1.5), (12.0, 1.5)), ((0.0, -1.5), (12.0, -1.5)))),
    )
    lines: list[LaserLine] = []
    left = _RULER + 40.0
    for text, part, strokes in samples:
        letters = Lettering(text, 3.0)
        if left + 15 + letters.width > width:
            break
        lines += [LaserLine(layer=Layer.MARK, part=part, points=stroke).move(left, 2.0) for stroke in strokes]
        lines += letters.lines((left + 15 + letters.width / 2, 2.0))
        left += 25 + letters.width
    return tuple(lines)
