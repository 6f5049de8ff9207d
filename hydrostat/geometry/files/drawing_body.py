"""`drawing_of`: the body among the closed shapes of a drawing, and the meaning of what lies in it: holes or marks."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from enum import StrEnum

import numpy as np
from shapely import LineString, MultiLineString, STRtree, disjoint, get_parts, line_merge

from hydrostat.errors import OutlineError, SeveralPartsError
from hydrostat.geometry.files.drawn_line import PAINTED, DrawnLine
from hydrostat.geometry.files.drawn_shapes import Shapes
from hydrostat.geometry.files.rings import (
    DRAWN_HINT,
    PART_HINT,
    Drawing,
    Page,
    body_and_holes,
    outline_on_page,
    point_text,
)
from hydrostat.geometry.outline import Outline, Ring
from hydrostat.units import plural


class Inner(StrEnum):
    """Meaning of the shapes and open lines within the outer line of a drawing."""

    HOLES = "holes"  # closed shapes are holes through the body, open lines nothing
    DRAWN = "drawn"  # all of them are drawn on the body, such as eyes and a mouth


def drawing_of(
    shapes: Shapes,
    name: str,
    inner: Inner,
    page: Callable[[Ring], Page],
    *,
    part: int | None = None,
    notes: tuple[str, ...] = (),
) -> Drawing:
    """Drawing that closed and open lines make, in its units.

    Args:
        shapes: the lines, of `sorted_shapes`.
        name: name of the file, for errors.
        inner: meaning of the lines within the body.
        page: function that returns the page on which the outer ring of a body lies.
        part: number of the closed shape that is the body, the largest area is 1; chosen if left out.
        notes: notes so far.

    Raises:
        OutlineError: they make no body; see `choose_body` and `body_and_holes`.
    """
    try:
        body_line, inside_lines, chosen = choose_body(shapes, part, name)
    except SeveralPartsError as error:
        on = page(shapes.closed[0].points)
        places = {number: on.places(shapes.closed[number - 1].points) for number in error.parts}
        raise SeveralPartsError(str(error), places) from None
    notes = (*notes, *shapes.notes, *chosen)
    details = _details(body_line, inside_lines) if inner is Inner.HOLES else inside_lines
    if any(line.fill in PAINTED for line in details):
        details = inside_lines  # what is painted beside an eye is drawn as well
    holes = [line for line in inside_lines if line not in details]
    body, cut = body_and_holes([body_line.points, *(line.points for line in holes)], name)
    on = page(body)
    outline = outline_on_page(body, cut, on, name)
    number = shapes.closed.index(body_line) + 1
    open_lines = list(shapes.open)
    told: list[str] = []
    drawn = [np.concatenate([line.points, line.points[:1]]) for line in details]
    if inner is Inner.DRAWN or details:
        drawn, open_lines = [*drawn, *open_lines], []
    marks = marks_on(outline, [on.places(line) for line in drawn])
    if inner is Inner.HOLES and details:
        where = point_text(details[0].points[0])
        told.append(
            f"a shape at {where} of the drawing lies in or across another, as in an eye: both are drawn, not cut"
        )
    if marks:
        told.append(f"{plural(len(marks), 'line')} drawn on the body, not cut")
    if open_lines:
        where = point_text(max(open_lines, key=_extent)[0])
        told.append(f"left out {plural(len(open_lines), 'open line')}, the largest at {where}")
    told += [*describe_holes(outline), *_describe_frame(shapes, body_line, holes)]
    return Drawing(outline, on, (*notes, *told), marks, number)


def _details(body: DrawnLine, inside: list[DrawnLine]) -> list[DrawnLine]:
    """Shapes within a body that cannot be holes, as one lies in another or crosses it: an eye and its pupil."""
    within = [line for line in inside if body.polygon.covers(line.polygon)]
    if len(within) < 2:
        return []
    areas = [line.polygon for line in within]
    pairs = STRtree(areas).query(areas, predicate="intersects").T.tolist()
    met = {one for one, two in pairs if one != two and not areas[one].equals(areas[two])}
    return [line for number, line in enumerate(within) if number in met]


_PART = 0.1  # a second shape beside the largest is a part of its own where it has this share of the area
_FRAME = 0.1  # a hole that may be the body, and what is around it a frame, has this share


def choose_body(shapes: Shapes, part: int | None, name: str) -> tuple[DrawnLine, list[DrawnLine], list[str]]:
    """Choose the closed shape that is the body, and find what lies in it.

    Args:
        shapes: lines of a drawing.
        part: number of the shape, the largest area is 1; if left out, the largest that is no ground.
        name: name of the file, for errors.

    Returns:
        The shape, the smaller ones that are not beside it, and notes on what was left out.

    Raises:
        SeveralPartsError: there are several and none was chosen.
        OutlineError: there is no such part.
    """
    closed = shapes.closed
    if part is not None and not 1 <= part <= len(closed):
        raise OutlineError(f"{name}: part {part} is not there. Allowed: 1 to {len(closed)}, the largest area first")
    candidates = [line for line in closed if line not in shapes.grounds]
    if part is None and shapes.doubtful is not None:
        inside = [line for line in closed[closed.index(shapes.doubtful) + 1 :] if line not in shapes.grounds]
        edge = shapes.doubtful.polygon.boundary  # what touches it is a title block
        raise _several([shapes.doubtful, min(inside, key=lambda line: line.polygon.intersects(edge))], closed, name)
    body = _the_largest(candidates, closed, name) if part is None else closed[part - 1]
    after = closed[closed.index(body) + 1 :]
    smaller = [line for line in after if line not in shapes.grounds]
    blocks = [line for line in after if line in shapes.grounds and body.polygon.covers(line.polygon)]
    beside = disjoint(body.polygon, [line.polygon for line in smaller])
    left = [line for line, apart in zip(smaller, beside, strict=True) if apart]
    notes = []
    if part is None and shapes.grounds:
        ground = shapes.grounds[0]
        across, up = np.ptp(ground.points, axis=0)
        notes.append(
            f"left out a ground or frame of {across:.4g} x {up:.4g}; if it is the body, say "
            f"{PART_HINT.replace('N', str(closed.index(ground) + 1))}"
        )
    if part is not None and blocks:
        where = point_text(blocks[0].points[0])
        notes.append(f"left out {plural(len(blocks), 'closed shape')} on the edge, the largest at {where}")
    if left:
        where = point_text(left[0].points[0])
        notes.append(f"left out {plural(len(left), 'closed shape')} beside the body, the largest at {where}")
    return body, [line for line, apart in zip(smaller, beside, strict=True) if not apart], notes


def _the_largest(candidates: list[DrawnLine], closed: Sequence[DrawnLine], name: str) -> DrawnLine:
    """The largest shape (SeveralPartsError: another beside it is a part as well)."""
    body, parts = candidates[0], candidates[:1]
    for line in candidates[1:]:
        if line.polygon.area < _PART * body.polygon.area:
            break
        if all(line.polygon.disjoint(other.polygon) for other in parts):
            parts.append(line)
    if len(parts) > 1:
        raise _several(parts, closed, name)
    return body


def _several(parts: list[DrawnLine], closed: Sequence[DrawnLine], name: str) -> SeveralPartsError:
    """Complaint that one of several parts must be chosen."""
    most_named = 6
    listed = []
    for line in parts[:most_named]:
        (x, y), (across, up) = line.points.min(axis=0), np.ptp(line.points, axis=0)
        listed.append(f"{closed.index(line) + 1}: {across:.4g} x {up:.4g} at {point_text((x, y))}")
    more = f", and {len(parts) - most_named} more" if len(parts) > most_named else ""
    told = f"{name}: has {len(parts)} parts ({'; '.join(listed)}{more}): choose one by {PART_HINT}"
    return SeveralPartsError(told, {closed.index(line) + 1: None for line in parts})


def _describe_frame(shapes: Shapes, body: DrawnLine, inside: list[DrawnLine]) -> tuple[str, ...]:
    """Note on a large hole that may be the body, and what is around it a frame."""
    if not inside or inside[0].polygon.area < _FRAME * body.polygon.area or len(inside) > 1:
        return ()
    number = shapes.closed.index(inside[0]) + 1
    return (f"if that shape is the body, and what is around it a frame, say {PART_HINT.replace('N', str(number))}",)


def drawn_picture(drawing: Drawing) -> Drawing:
    """Return the drawing with its holes as lines on the body instead."""
    outline, *_ = drawing.outline.rings
    whole = Outline(outline)
    rings = [np.concatenate([ring, ring[:1]]) for ring in drawing.outline.rings[1:]]
    return replace(drawing, outline=whole, marks=marks_on(whole, rings))


def describe_holes(outline: Outline) -> tuple[str, ...]:
    """Note on the holes of a body: where drawings have an eye, they would go through it."""
    holes = outline.rings[1:]
    if not holes:
        return ()
    largest = max(holes, key=_extent)
    x, y = 1e3 * (largest.min(axis=0) + largest.max(axis=0)) / 2
    where = f"{1e3 * _extent(largest):.3g} mm across at ({round(x, 1) + 0.0:g}, {round(y, 1) + 0.0:g}) mm"
    which = where if len(holes) == 1 else f"the largest {where}"
    noun = "closed shape is a hole" if len(holes) == 1 else "closed shapes are holes"
    return (f"{len(holes)} {noun} through the body ({which}); for shapes drawn on it, such as eyes, add {DRAWN_HINT}",)


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
