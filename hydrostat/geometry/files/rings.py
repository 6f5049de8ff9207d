"""Which of the lines of a drawing are the body and which its holes: the same for every kind of drawing."""

from collections.abc import Iterable, Iterator

import numpy as np
from jaxtyping import Float
from shapely import Polygon

from hydrostat.errors import InputError, OutlineError
from hydrostat.geometry.files.page import Page
from hydrostat.geometry.outline import Outline, Ring, fault

MOST_POINTS = 200_000
"""A drawing with more points, counting what it repeats, is refused."""

MOST_SHAPES = 200
"""A drawing may have this many closed shapes: the body and its holes."""

CHORD_ERROR = 2e-5
"""Curves become chords that stray at most this part of their box."""

_GAP = 1e-3
_ROUNDING = 1e-6


def check_size(size: float | None, name: str) -> None:
    """Refuse a size that is no length.

    Raises:
        InputError: `size` [m] is not positive.
    """
    if size is not None and not 0.0 < size < np.inf:
        raise InputError(f"{name}: the size must be positive, not {size} m")


def closed_rings(lines: Iterable[tuple[Ring, bool]], name: str) -> tuple[list[Ring], tuple[str, ...]]:
    """The lines of a drawing that are closed.

    Args:
        lines: points in the drawing's units, and whether the line closes itself; ends that all but meet are closed.
        name: what errors call the file.

    Returns:
        The rings in the drawing's units, and a note on the open lines that were left out.

    Raises:
        OutlineError: too many points, numbers that are not finite, no closed line, or an open one larger than all.
    """
    rings, open_lines = [], []
    for line, closed in checked(lines, name):
        extent = float(np.ptp(line, axis=0).max())
        gap = float(np.linalg.norm(line[0] - line[-1]))
        closed = closed or gap <= _GAP * extent
        if 0.0 < gap <= _ROUNDING * extent:
            line = np.concatenate([line[:-1], line[:1]])
        (rings if closed else open_lines).append((extent, line))
    largest = max((extent for extent, _ in rings), default=0.0)
    extent, line = max(open_lines, key=lambda pair: pair[0], default=(0.0, np.zeros((2, 2))))
    if extent > largest:
        start, end = place(line[0]), place(line[-1])
        gap = float(np.linalg.norm(line[0] - line[-1]))
        raise OutlineError(f"{name}: the outline is open between {start} and {end}, a gap of {gap:.4g}: close the path")
    if largest == 0.0:
        raise OutlineError(f"{name}: no closed shape: draw the outline of the body as one closed path")
    left_out = (f"left out {counted(len(open_lines), 'open line')}, the largest at {place(line[0])}",)
    return [line for extent, line in rings if extent > 0.0], left_out if open_lines else ()


def checked(lines: Iterable[tuple[Ring, bool]], name: str) -> Iterator[tuple[Ring, bool]]:
    """The lines as they come, until there are too many points or one is not finite, which is an OutlineError."""
    count = 0
    for line, closed in lines:
        count += len(line)
        if count > MOST_POINTS:
            raise OutlineError(f"{name}: more than {MOST_POINTS} points: simplify the drawing")
        if not (np.abs(line) < 1e100).all():
            raise OutlineError(f"{name}: a coordinate is not a finite number: save the drawing again")
        yield line, closed


def body_and_holes(rings: list[Ring], name: str) -> tuple[Ring, list[Ring]]:
    """The largest ring, and the rings inside it.

    Raises:
        OutlineError: a ring crosses itself or another, lies outside the body or inside a hole, or there are too many.
    """
    shapes = _shapes(rings, name)
    body, holes = shapes[0], []
    for shape in shapes[1:]:
        if body.disjoint(shape):
            raise OutlineError(
                f"{name}: a second closed shape lies outside the body at {place(shape.exterior.coords[0])}: "
                "unite the shapes into one or delete it"
            )
        if any(shape.equals(other) for other in (body, *holes)):
            continue
        inside = next((hole for hole in holes if hole.contains(shape)), None)
        if inside is not None:
            raise OutlineError(
                f"{name}: a closed shape at {place(shape.exterior.coords[0])} lies inside a hole and so hangs on "
                "nothing: delete it, or the hole"
            )
        crossing = next((other for other in (body, *holes) if other.exterior.intersects(shape.exterior)), None)
        if crossing is not None:
            point = crossing.exterior.intersection(shape.exterior).representative_point()
            where = place((point.x, point.y))
            raise OutlineError(f"{name}: two closed shapes cross at {where}: unite them, or move a hole inside")
        holes.append(shape)
    return np.array(body.exterior.coords), [np.array(hole.exterior.coords) for hole in holes]


def _shapes(rings: list[Ring], name: str) -> list[Polygon]:
    """The rings that have an area as polygons, the largest first."""
    shapes = []
    for ring in rings:
        polygon = Polygon(ring) if len(ring) >= 3 else None
        if polygon is not None and not polygon.exterior.is_simple:
            what, point = fault(polygon) or ("crosses itself", ring[0])
            raise OutlineError(f"{name}: the outline {what} at {place(point)}: redraw it there")
        if polygon is not None and polygon.area > 0.0:
            shapes.append(polygon)
    if not shapes:
        raise OutlineError(f"{name}: the outline has no area: draw the body as one closed path")
    if len(shapes) > MOST_SHAPES:
        raise OutlineError(f"{name}: has {len(shapes)} closed shapes, more than {MOST_SHAPES}: leave out some holes")
    return sorted(shapes, key=lambda shape: shape.area, reverse=True)


def placed(body: Ring, holes: list[Ring], page: Page, name: str) -> Outline:
    """The outline in metres.

    Args:
        body: the outer ring in the drawing's units.
        holes: the same of each hole.
        page: what these mean.
        name: what errors call the file.

    Raises:
        OutlineError: the rings are no outline.
    """
    try:
        return Outline(page.places(body), tuple(page.places(hole) for hole in holes))
    except OutlineError as error:
        raise OutlineError(f"{name}: {error}") from error


def place(point: Float[np.ndarray, " 2"] | tuple[float, ...]) -> str:
    """A point of the drawing in words."""
    return f"({point[0]:.4g}, {point[1]:.4g})"


def counted(count: int, thing: str) -> str:
    """How many of a thing, in words."""
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"
