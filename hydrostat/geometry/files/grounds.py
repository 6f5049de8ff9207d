"""Grounds and frames of drawings: rectangles behind or around a body that are no part of it."""

import re
from collections.abc import Sequence
from enum import Enum

import numpy as np

from hydrostat.geometry.files.drawn_line import PAINTED, DrawnLine, Fill, PageFacts

_SURE = re.compile(
    r"(?<![a-z])(back ?ground|backdrop|canvas|artboard|title ?block|defpoints|hintergrund|schriftfeld|fondo?)(?![a-z])",
    re.IGNORECASE,
)
_LIKELY = re.compile(
    r"(?<![a-z])(page|sheet|paper|frame|border|rahmen|blatt|cadre|marco|hoja|cornice)(?![a-z])",
    re.IGNORECASE,
)
_PAPERS = (
    (1189, 841), (841, 594), (594, 420), (420, 297), (297, 210), (210, 148), (148, 105),  # ISO 216, A0 to A6
    (279.4, 215.9), (431.8, 279.4), (558.8, 431.8), (863.6, 558.8), (1117.6, 863.6), (355.6, 215.9),  # ANSI, legal
)  # fmt: skip
_MARGINS = (0.0, 10.0, 20.0, 30.0, 40.0)
"""Widths that a frame lacks of its sheet, in all [mm]: 5, 10 or 20 at each side, or 20 where it is bound."""


class Doubt(Enum):
    """Answers to the question whether a rectangle is a ground."""

    BODY = "body"
    ASK = "ask"
    GROUND = "ground"


def find_grounds(rings: Sequence[DrawnLine], page: PageFacts) -> tuple[list[DrawnLine], DrawnLine | None]:
    """Find rectangles that are the ground of a drawing, its page or a frame, and what touches them, as a title block.

    Paint decides first: a white rectangle behind what is not white, one of another color as large as the page, or an
    unfilled one around what is filled. Without paint: names of layers, sheets of standard sizes (ISO 216, ANSI) with
    usual margins, texts between the rectangle and what is in it, or a frame within a frame. What is in it must be able
    to be a body: circles and rectangles are rather holes of a plate.

    Args:
        rings: closed lines, the largest area first.
        page: facts on the page of the drawing.

    Returns:
        The lines that are no body, empty if the largest one is; and a rectangle that may be a body or a frame, or None.
    """
    found: list[DrawnLine] = []
    rest = [ring for ring in rings if ring.polygon.area > 0.0]
    while len(rest) > 1 and (_is_rectangle(rest[0]) or _is_pale_disk(rest[0], page)):
        first, others = rest[0], rest[1:]
        inside = [ring for ring in others if first.polygon.buffer(1e-6 * first.extent).covers(ring.polygon)]
        inside = [ring for ring in inside if not ring.polygon.equals(first.polygon)]
        if not inside:
            break
        edge = first.polygon.boundary.buffer(1e-3 * first.extent)
        block = [ring for ring in inside if first.fill not in PAINTED and ring.polygon.intersects(edge)]
        doubt = _doubt(first, [ring for ring in inside if ring not in block] or inside, page, bool(block))
        if found and doubt is not Doubt.GROUND and not _is_hole(inside[0], first):
            doubt = Doubt.GROUND  # a frame within a frame
        if doubt is not Doubt.GROUND:
            return found, first if doubt is Doubt.ASK else None
        if len(block) == len(inside):
            break
        found += [first, *block]
        rest = [ring for ring in others if all(ring is not one for one in block)]
    return found, None


def _is_rectangle(ring: DrawnLine) -> bool:
    """True if it fills its box, but for rounded corners."""
    return ring.polygon.area > 0.97 * float(np.prod(np.ptp(ring.points, axis=0)))


def _is_pale_disk(ring: DrawnLine, page: PageFacts) -> bool:
    """True for a pale circle or ellipse without an edge that fills the page: the ground of a badge."""
    across, up = np.ptp(ring.points, axis=0)
    is_round = ring.polygon.area > 0.99 * np.pi / 4.0 * float(across * up)
    return ring.fill is Fill.PALE and ring.width == 0.0 and is_round and _fills_page(ring, page)


def _is_hole(ring: DrawnLine, plate: DrawnLine) -> bool:
    """True for what a plate has rather than a frame around it: circles, rectangles, and what is small."""
    hull = float(ring.polygon.convex_hull.area)
    round_share = 4.0 * np.pi * hull / max(ring.polygon.convex_hull.length**2, 1e-300)
    return round_share > 0.98 or _is_rectangle(ring) or ring.polygon.area < 0.005 * plate.polygon.area


def _doubt(first: DrawnLine, inside: list[DrawnLine], page: PageFacts, has_block: bool) -> Doubt:
    """Answer of paint, names, size, texts and blocks on its edge to the question whether a rectangle is a ground."""
    label = first.label.replace("_", " ").replace("-", " ")
    largest = max((ring for ring in inside), key=lambda ring: (not _is_hole(ring, first), ring.polygon.area))
    share = largest.polygon.area / first.polygon.area
    if _SURE.search(label):
        return Doubt.GROUND
    sharp = first.polygon.area > 0.999 * float(np.prod(np.ptp(first.points, axis=0)))
    bare = sharp and first.width == 0.0 and _fills_page(first, page)  # a page that is painted, without an edge
    if first.fill is Fill.PALE and bare and any(ring.fill is not Fill.PALE or ring.width > 0.0 for ring in inside):
        return Doubt.GROUND
    if _is_hole(largest, first) or not sharp:
        return _doubt_of_plate(first, largest, page, has_block)
    if first.fill is Fill.PALE:
        likely = any(ring.fill is not Fill.PALE for ring in inside)
    elif first.fill is Fill.FULL:
        if largest.fill is Fill.PALE and bare:
            return Doubt.ASK  # a white body on a dark page, or a window in a dark plate
        likely = largest.fill is Fill.FULL and largest.color != first.color and _fills_page(first, page)
    else:
        titles = sum(
            first.polygon.contains(point) and not any(ring.polygon.intersects(point) for ring in inside)
            for point in page.points
        )
        if _is_paper(first, page):
            return Doubt.GROUND
        likely = largest.fill is Fill.FULL or titles > 1
    if not likely and not _LIKELY.search(label):
        return Doubt.BODY
    return Doubt.GROUND if share > 0.1 else Doubt.ASK if share > 0.02 else Doubt.BODY


def _doubt_of_plate(first: DrawnLine, largest: DrawnLine, page: PageFacts, has_block: bool) -> Doubt:
    """Answer where what is inside may be a hole, or the shape is not a sharp rectangle."""
    if _is_hole(largest, first):
        is_named = has_block or _LIKELY.search(first.label.replace("_", " "))
        if first.fill not in PAINTED and is_named and _is_paper(first, page):
            return Doubt.GROUND
        return Doubt.ASK if has_block else Doubt.BODY
    is_badge = first.fill is Fill.PALE and first.width == 0.0 and _fills_page(first, page)
    is_behind = largest.fill is Fill.FULL and largest.polygon.area > 0.1 * first.polygon.area
    return Doubt.GROUND if is_badge and is_behind else Doubt.BODY


def _fills_page(ring: DrawnLine, page: PageFacts) -> bool:
    """True if its box covers the page, or all but a hundredth of it."""
    if page.box is None:
        return False
    left, low, right, high = page.box
    slack = 0.01 * max(right - left, high - low)
    (x0, y0), (x1, y1) = ring.points.min(axis=0), ring.points.max(axis=0)
    return x0 < left + slack and y0 < low + slack and x1 > right - slack and y1 > high - slack


def _is_paper(ring: DrawnLine, page: PageFacts) -> bool:
    """True if its sides are those of a standard sheet of paper at a standard scale, less usual margins."""
    sides = np.sort(np.ptp(ring.points, axis=0))[::-1]
    near = 0.6  # mm of paper
    for unit in (page.unit,) if page.unit else (1.0, 25.4):
        for scale in (1.0, 2.0, 5.0, 10.0, 0.5, 0.2, 0.1):
            short_of = np.array(_PAPERS) - sides * unit / scale
            margins = np.array(_MARGINS) if scale == 1.0 else np.array([0.0, 20.0])
            fits = np.abs(short_of[:, :, None] - margins).min(axis=2) < near
            if scale != 1.0:
                fits &= np.abs(short_of[:, :1] - short_of[:, 1:]) < near
            if fits.all(axis=1).any():
                return True
    return False
