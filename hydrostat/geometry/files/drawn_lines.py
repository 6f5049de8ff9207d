"""`drawing_of`: a drawing of its lines, some of which may be drawn on the body in place of holes through it."""

from collections.abc import Callable, Iterable
from enum import StrEnum

import numpy as np
from shapely import LineString, MultiLineString, Point, Polygon, get_parts, line_merge

from hydrostat.errors import OutlineError
from hydrostat.geometry.files.rings import (
    DRAWN_HINT,
    Drawing,
    Page,
    body_and_holes,
    outline_on_page,
    point_text,
    shapes_of,
)
from hydrostat.geometry.outline import Outline, Ring
from hydrostat.units import plural


class Inner(StrEnum):
    """Meaning of the shapes and open lines within the outer line of a drawing."""

    HOLES = "holes"  # closed shapes are holes through the body, open lines nothing
    DRAWN = "drawn"  # all of them are drawn on the body, such as eyes and a mouth


def drawing_of(
    lines: tuple[list[Ring], list[Ring]],
    name: str,
    inner: Inner,
    page: Callable[[Ring], Page],
    notes: tuple[str, ...] = (),
) -> Drawing:
    """Drawing that closed rings and open lines make, in its units.

    Args:
        lines: the rings and the open lines, of `closed_rings`.
        name: name of the file, for errors.
        inner: meaning of the lines within the body.
        page: function that returns the page on which the outer ring of a body lies.
        notes: notes so far.

    Raises:
        OutlineError: they make no body; see `body_and_holes`.
    """
    rings, open_lines = lines
    if inner is Inner.HOLES:
        body, holes = body_and_holes(rings, name)
        on = page(body)
        outline = outline_on_page(body, holes, on, name)
        left = []
        if open_lines:
            where = point_text(max(open_lines, key=_extent)[0])
            left = [f"left out {plural(len(open_lines), 'open line')}, the largest at {where}"]
        return Drawing(outline, on, (*notes, *left, *holes_told(outline)))
    body, inside = body_and_marks(rings, name)
    on = page(body)
    outline = outline_on_page(body, [], on, name)
    drawn = [*(np.concatenate([ring, ring[:1]]) for ring in inside), *open_lines]
    marks = marks_on(outline, [on.places(line) for line in drawn])
    told = (f"{plural(len(marks), 'line')} drawn on the body, not cut",) if marks else ()
    return Drawing(outline, on, (*notes, *told), marks)


def body_and_marks(rings: list[Ring], name: str) -> tuple[Ring, list[Ring]]:
    """Largest ring, and all others, which are drawn on the body and may cross or lie in one another.

    Raises:
        OutlineError: the largest ring crosses itself, or a ring lies outside it.
    """
    if not rings:
        raise OutlineError(f"{name}: the outline has no area: draw the body as one closed path")
    areas = [Polygon(ring).buffer(0).area if len(ring) >= 3 else 0.0 for ring in rings]
    largest = int(np.argmax(areas))
    (body,) = shapes_of([rings[largest]], name)
    others = [ring for number, ring in enumerate(rings) if number != largest]
    for ring in others:
        if body.disjoint(LineString(ring) if len(ring) > 1 else Point(ring[0])):
            raise OutlineError(
                f"{name}: a second closed shape lies outside the body at {point_text(ring[0])}: unite the shapes into "
                "one or delete it"
            )
    return np.array(body.exterior.coords), others


def drawn_picture(drawing: Drawing) -> Drawing:
    """Return the drawing with its holes as lines on the body instead."""
    outline, *_ = drawing.outline.rings
    whole = Outline(outline)
    rings = [np.concatenate([ring, ring[:1]]) for ring in drawing.outline.rings[1:]]
    return Drawing(whole, drawing.page, drawing.notes, marks_on(whole, rings))


def holes_told(outline: Outline) -> tuple[str, ...]:
    """Note on the holes of a body: where drawings have an eye, they would go through it."""
    holes = outline.rings[1:]
    if not holes:
        return ()
    largest = max(holes, key=_extent)
    x, y = 1e3 * (largest.min(axis=0) + largest.max(axis=0)) / 2
    where = f"{1e3 * _extent(largest):.3g} mm across at ({round(x, 1) + 0.0:g}, {round(y, 1) + 0.0:g}) mm"
    which = where if len(holes) == 1 else f"the largest {where}"
    noun = "closed shape is a hole" if len(holes) == 1 else "closed shapes are holes"
    return (f"{len(holes)} {noun} through the body ({which}); if drawn on it, such as an eye, say {DRAWN_HINT}",)


def _extent(line: Ring) -> float:
    return float(np.ptp(line, axis=0).max())


def marks_on(outline: Outline, lines: Iterable[Ring]) -> tuple[Ring, ...]:
    """Parts of lines [m] that lie on a body; each is cut where it leaves it."""
    kept: list[Ring] = []
    for line in lines:
        if len(line) > 1 and _extent(line) > 0.0:
            parts = get_parts(LineString(line).intersection(outline.polygon)).tolist()
            found = [part for part in parts if isinstance(part, LineString)]
            pieces = get_parts(line_merge(MultiLineString(found))).tolist() if len(found) > 1 else found
            kept += [np.array(piece.coords) for piece in pieces if piece.length > 0.0]
    return tuple(kept)
