"""Grounds and frames of drawings: rectangles behind or around a body that are no part of it."""

import re
from collections.abc import Sequence

import numpy as np

from hydrostat.geometry.files.drawn_line import PAINTED, DrawnLine, Fill, PageFacts

_NAMES = re.compile(
    r"(?<![a-z])(back ?ground|backdrop|page|sheet|paper|frame|border|title ?block|title|canvas|artboard)(?![a-z])",
    re.IGNORECASE,
)
_PAPERS = (
    *((round(1189 / 2 ** (n / 2)), round(841 / 2 ** (n / 2))) for n in range(7)),  # ISO 216, A0 to A6
    (279.4, 215.9), (431.8, 279.4), (558.8, 431.8), (863.6, 558.8), (1117.6, 863.6), (355.6, 215.9),  # ANSI, legal
)  # fmt: skip
_MARGINS = (0.0, 10.0, 20.0, 30.0, 40.0)
"""Widths that a frame lacks of its sheet, in all [mm]: 5, 10 or 20 at each side, or 20 where it is bound."""


def find_grounds(rings: Sequence[DrawnLine], sheet: PageFacts) -> list[DrawnLine]:
    """Find rectangles that are the ground of a drawing, its page or a frame, and what touches them, as a title block.

    Paint decides first: a white rectangle behind what is not white, one of another color as large as the page, or an
    unfilled one around what is filled. Without paint: names of layers, sheets of standard sizes (ISO 216, ANSI) with
    usual margins, texts between the rectangle and what is in it, or a frame within a frame.

    Args:
        rings: closed lines, the largest area first.
        sheet: facts on the page of the drawing.

    Returns:
        The lines that are no body; empty if the largest one is.
    """
    found: list[DrawnLine] = []
    rest = [ring for ring in rings if ring.polygon.area > 0.0]
    while len(rest) > 1 and _is_rectangle(rest[0]):
        first, others = rest[0], rest[1:]
        inside = [ring for ring in others if first.polygon.buffer(1e-6 * first.extent).covers(ring.polygon)]
        inside = [ring for ring in inside if not ring.polygon.equals(first.polygon)]
        if not inside or not (_is_ground(first, inside, sheet) or (found and _is_rectangle(first))):
            break
        edge = first.polygon.boundary.buffer(1e-3 * first.extent)
        block = [ring for ring in inside if first.fill not in PAINTED and ring.polygon.intersects(edge)]
        if len(block) == len(inside):
            break
        found += [first, *block]
        rest = [ring for ring in others if ring not in block]
    return found


def _is_rectangle(ring: DrawnLine) -> bool:
    """True if it fills its box, but for rounded corners."""
    return ring.polygon.area > 0.97 * float(np.prod(np.ptp(ring.points, axis=0)))


def _is_ground(first: DrawnLine, inside: list[DrawnLine], sheet: PageFacts) -> bool:
    """True if paint, names, size or texts say that a rectangle is no body."""
    largest = max(inside, key=lambda ring: ring.polygon.area)
    if _NAMES.search(first.label.replace("_", " ").replace("-", " ")):
        return True
    if first.fill is Fill.PALE:
        return any(ring.fill is not Fill.PALE for ring in inside)
    if first.fill is Fill.FULL:
        other = largest.fill is Fill.FULL and largest.color != first.color
        return other and _fills_page(first, sheet)
    painted = max((ring.polygon.area for ring in inside if ring.fill is Fill.FULL), default=0.0)
    if painted > 0.05 * first.polygon.area:  # less may be the eye of a body that is drawn as a line
        return True
    titles = sum(
        first.polygon.contains(point) and not any(ring.polygon.intersects(point) for ring in inside)
        for point in sheet.points
    )
    drawn = 0.02 * first.polygon.area < largest.polygon.area and not _is_rectangle(largest)
    return _is_paper(first, sheet) or (titles > 1 and drawn and len(inside) < 4)


def _fills_page(ring: DrawnLine, sheet: PageFacts) -> bool:
    """True if its box covers the page, or all but a hundredth of it."""
    if sheet.box is None:
        return False
    left, low, right, high = sheet.box
    slack = 0.01 * max(right - left, high - low)
    (x0, y0), (x1, y1) = ring.points.min(axis=0), ring.points.max(axis=0)
    return x0 < left + slack and y0 < low + slack and x1 > right - slack and y1 > high - slack


def _is_paper(ring: DrawnLine, sheet: PageFacts) -> bool:
    """True if its sides are those of a standard sheet of paper at a standard scale, less usual margins."""
    sides = np.sort(np.ptp(ring.points, axis=0))[::-1]
    near = 0.6  # mm of paper
    for unit in (sheet.unit,) if sheet.unit else (1.0, 25.4):
        for scale in (1.0, 2.0, 5.0, 10.0, 0.5, 0.2, 0.1):
            short_of = np.array(_PAPERS) - sides * unit / scale
            margins = np.array(_MARGINS) if scale == 1.0 else np.array([0.0, 20.0])
            fits = np.abs(short_of[:, :, None] - margins).min(axis=2) < near
            if scale != 1.0:
                fits &= np.abs(short_of[:, :1] - short_of[:, 1:]) < near
            if fits.all(axis=1).any():
                return True
    return False
