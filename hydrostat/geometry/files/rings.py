"""Lines of any kind of drawing, joined to rings and sorted into the body, its holes and its page."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from shapely import Polygon

from hydrostat.arrays import Float, Int
from hydrostat.errors import OutlineError
from hydrostat.geometry.mesh import joined_groups
from hydrostat.geometry.outline import Outline, Ring, fault


@dataclass(frozen=True)
class Page:
    """Map from drawing to body: a point d lies at (d - origin) x scale [m] (docs/decisions/0001-coordinates.md)."""

    kind: str  # property that two drawings on one page must share
    origin: tuple[float, float]  # point of the drawing at the body's origin, in the drawing's units
    scale: tuple[float, float]  # length of one unit along x and y [m], y negative where the drawing counts it downwards

    def places(self, ring: Ring) -> Ring:
        """Places [m] of the points of a drawing."""
        return (ring - np.array(self.origin)) * np.array(self.scale)

    def check(self, kind: str, name: str) -> None:
        """Refuse a drawing that cannot lie on this page.

        An SVG drawing says its unit and its page, a DXF drawing its unit only, a picture its pixels only. So a DXF
        drawing that was moved as a whole, by a program that counts from a corner of the page, is not noticed; nor is a
        picture that was cut to the same number of pixels elsewhere. Raises OutlineError: it is of another kind, so the
        same numbers mean other places.
        """
        if kind != self.kind:
            raise OutlineError(
                f"{name}: is {kind}, the drawing that it should lie on is {self.kind}: begin with a copy of that one, "
                "and save it with the same page"
            )


def page_about(body: Ring, kind: str, unit: tuple[float, float], size: float | None) -> Page:
    """Page whose origin is the center of the box of an outer ring in the drawing's units.

    One of its units is so long along x and y [m], y negative where the drawing counts it downwards, unless the longest
    side of the box is to be `size` [m].
    """
    low, high = body.min(axis=0), body.max(axis=0)
    scale = np.array(unit)
    if size is not None:
        scale = scale * size / float(((high - low) * np.abs(scale)).max())
    x, y = 0.5 * (low + high)
    return Page(kind, (float(x), float(y)), (float(scale[0]), float(scale[1])))


@dataclass(frozen=True, eq=False)
class Drawing:
    """Outline of a drawing or picture, with notes on how it was obtained."""

    outline: Outline  # outline of the body [m]
    page: Page  # meaning of the drawing's own coordinates
    # one line for each thing that was ignored, filled or mended; empty if there was nothing
    notes: tuple[str, ...] = ()
    marks: tuple[Ring, ...] = ()  # lines that are drawn on the body [m]; closed ones end where they begin
    part: int = 1  # number of the closed shape that is the body, the largest area is 1


PART_HINT = "--part N, or drawing_part = N in [body]"
"""Hint for errors about several closed shapes in a drawing."""

DRAWN_HINT = '--inner drawn, or inner = "drawn" in [body]'
"""Hint for errors about closed shapes that are no holes."""

MAX_POINTS = 100_000  # a drawing with more points, counting what it repeats, is refused
CHORD_ERROR = 2e-5  # curves become chords that stray at most this part of their box


def checked_points(lines: Iterable[Ring], name: str) -> None:
    """Refuse too many points, or one that is not finite (OutlineError)."""
    count = 0
    for line in lines:
        count += len(line)
        if count > MAX_POINTS:
            raise OutlineError(f"{name}: more than {MAX_POINTS} points: simplify the drawing")
        if not (np.abs(line) < 1e100).all():
            raise OutlineError(f"{name}: a coordinate is not a finite number: save the drawing again")


def body_and_holes(rings: list[Ring], name: str) -> tuple[Ring, list[Ring]]:
    """Largest ring, and the others, which lie inside it.

    Raises:
        OutlineError: a ring crosses itself or another.
    """
    shapes = shapes_of(rings, name)
    body, holes = shapes[0], []
    for shape in shapes[1:]:
        if any(shape.equals(other) for other in (body, *holes)):
            continue
        crossing = next((other for other in (body, *holes) if other.exterior.intersects(shape.exterior)), None)
        if crossing is not None:
            point = crossing.exterior.intersection(shape.exterior).representative_point()
            where = point_text((point.x, point.y))
            raise OutlineError(f"{name}: two closed shapes cross at {where}: unite them, or move a hole inside")
        holes.append(shape)
    return np.array(body.exterior.coords), [np.array(hole.exterior.coords) for hole in holes]


def shapes_of(rings: list[Ring], name: str) -> list[Polygon]:
    """Rings that have an area as polygons, the largest first."""
    shapes = []
    for ring in rings:
        polygon = Polygon(ring) if len(ring) >= 3 else None
        if polygon is not None and not polygon.exterior.is_simple:
            what, point = fault(polygon) or ("crosses itself", ring[0])
            raise OutlineError(f"{name}: the outline {what} at {point_text(point)}: redraw it there")
        if polygon is not None and polygon.area > 0.0:
            shapes.append(polygon)
    if not shapes:
        raise OutlineError(f"{name}: the outline has no area: draw the body as one closed path")
    return sorted(shapes, key=lambda shape: shape.area, reverse=True)


def outline_on_page(body: Ring, holes: list[Ring], page: Page, name: str) -> Outline:
    """Outline in meters of rings in the drawing's units; OutlineError, with the file's name, if they are none."""
    try:
        return Outline(page.places(body), tuple(page.places(hole) for hole in holes))
    except OutlineError as error:
        raise OutlineError(f"{name}: {error}") from error


def without_repeats(points: Ring) -> Ring:
    """Give the points of a line, none repeated in a row."""
    return points[np.r_[True, np.any(np.diff(points, axis=0) != 0.0, axis=1)]] if len(points) else points


def one_line(error: object) -> str:
    """Give the text of another program's error as a part of a line, in plain letters.

    What Python says of its own lists and types would tell a person nothing.
    """
    if isinstance(error, LookupError | TypeError | AttributeError | AssertionError):
        return "a part of it is missing or malformed"
    return re.sub(r"[^ -~]+", " ", str(error))[:120]


def point_text(point: Float[np.ndarray, " 2"] | tuple[float, ...]) -> str:
    """Point of the drawing in words."""
    return f"({point[0]:.4g}, {point[1]:.4g})"


_POINT_TOLERANCE = 1e-6
_JOINED = 1e-3

_Ends = Int[np.ndarray, "lines 2"]


def join_lines(lines: list[Ring], name: str, *, within: float = 0.0) -> list[tuple[Ring, bool]]:
    """Join open lines of finite points at their ends, in either direction; return each with True if it is closed.

    Ends that are a millionth of the drawing apart are one; a free end and the free end nearest to it are one when they
    are a thousandth apart or less, or nearer than `within`. A line drawn twice counts once. Lines with a free end that
    lead nowhere stay open.
    Raises OutlineError if lines branch, so that it is not clear which of them are the outline.
    """
    if not lines:
        return []
    extent = float(np.ptp(np.concatenate(lines), axis=0).max()) or 1.0
    ends = _numbers_of_ends(np.array([[line[0], line[-1]] for line in lines]), extent, within)
    kept = _unique_lines(lines, ends, extent)
    lines, ends = [lines[index] for index in kept], ends[kept]
    dead = _dead_ends(ends)
    walks = _walks(ends, np.flatnonzero(~dead)) + _walks(ends, np.flatnonzero(dead))
    joined = []
    for walk in walks:
        line, start, end = _points_along(lines, ends, walk)
        if start != end and not dead[walk[0][0]]:
            first, last = point_text(line[0]), point_text(line[-1])
            raise OutlineError(f"{name}: lines branch at {first} and {last}: leave only the outline and its holes")
        joined.append((line, start == end))
    return joined


def _numbers_of_ends(points: Float[np.ndarray, "lines 2 2"], extent: float, within: float) -> _Ends:
    """Number for each end of each line, the same for those that meet."""
    from scipy.spatial import KDTree  # Imported here: not every command needs it.

    flat = points.reshape(-1, 2)
    cells = np.concatenate(
        [
            np.floor(flat / (2.0 * _POINT_TOLERANCE * extent) + shift)
            for shift in ((0, 0), (0, 0.5), (0.5, 0), (0.5, 0.5))
        ]
    )
    grid = np.repeat(np.arange(4), len(flat))
    _, cell = np.unique(np.column_stack([grid, cells]), axis=0, return_inverse=True)
    count = len(flat) + int(cell.max()) + 1
    numbers = joined_groups(np.stack([np.tile(np.arange(len(flat)), 4), cell.ravel() + len(flat)]), count)[: len(flat)]
    free = np.flatnonzero(np.bincount(numbers)[numbers] == 1)
    if len(free) > 1:
        found = KDTree(flat[free]).query(flat[free], k=2)
        distance, near = np.asarray(found[0]), np.asarray(found[1])
        other = near[:, 1]
        mutual = (other[other] == np.arange(len(free))) & (distance[:, 1] <= max(_JOINED * extent, within))
        mutual &= free // 2 != free[other] // 2
        numbers = joined_groups(numbers[np.stack([free[mutual], free[other[mutual]]])], count)[numbers]
    return numbers.reshape(-1, 2)


def _unique_lines(lines: list[Ring], ends: _Ends, extent: float) -> Int[np.ndarray, " kept"]:
    """Lines that are no repetition of another and have a length."""
    seen, kept = set(), []
    for index, (line, (start, end)) in enumerate(zip(lines, ends.tolist(), strict=True)):
        middle = _middle(line)
        key = (min(start, end), max(start, end), *np.round(middle / (100 * _POINT_TOLERANCE * extent)).tolist())
        if key not in seen and (start != end or np.ptp(line, axis=0).max() > 2 * _JOINED * extent or len(line) > 3):
            kept.append(index)
        seen.add(key)
    return np.array(kept, dtype=int)


def _middle(line: Ring) -> Float[np.ndarray, " 2"]:
    """Point half way along a line."""
    lengths = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]
    return np.array([np.interp(0.5 * lengths[-1], lengths, line[:, axis]) for axis in range(2)])


def _dead_ends(ends: _Ends) -> np.ndarray:
    """Mask of the lines that are on no closed path, (lines,)."""
    at = _lines_at(ends, np.arange(len(ends)))
    degree = {here: len(lines) for here, lines in at.items()}
    dead = np.zeros(len(ends), dtype=bool)
    todo = [here for here, count in degree.items() if count == 1]
    while todo:
        here = todo.pop()
        for line in at[here]:
            if not dead[line] and degree[here] == 1:
                dead[line] = True
                there = int(ends[line].sum()) - here
                degree[here] -= 1
                degree[there] -= 1
                if degree[there] == 1:
                    todo.append(there)
    return dead


def _lines_at(ends: _Ends, chosen: Int[np.ndarray, " _"]) -> dict[int, list[int]]:
    """Chosen lines at each place, one that returns to it twice."""
    at: dict[int, list[int]] = {}
    for line in chosen.tolist():
        for here in ends[line].tolist():
            at.setdefault(here, []).append(line)
    return at


def _walks(ends: _Ends, chosen: Int[np.ndarray, " _"]) -> list[list[tuple[int, bool]]]:
    """Paths through points where two of the chosen lines meet, each as lines with True if walked forward."""
    at = _lines_at(ends, chosen)
    used: set[int] = set()
    walks = []
    for start in sorted(at, key=lambda here: len(at[here]) == 2):  # branches and free ends first
        for first in at[start]:
            walk: list[tuple[int, bool]] = []
            here, line = start, first
            while line not in used:
                used.add(line)
                forward = int(ends[line, 0]) == here
                walk.append((line, forward))
                here = int(ends[line, 1 if forward else 0])
                line = next((other for other in at[here] if other not in used), line) if len(at[here]) == 2 else line
            if walk:
                walks.append(walk)
    return walks


def _points_along(lines: list[Ring], ends: _Ends, walk: list[tuple[int, bool]]) -> tuple[Ring, int, int]:
    """Points along a walk and the numbers of its two ends."""
    pieces = [lines[line] if forward else lines[line][::-1] for line, forward in walk]
    (first, ahead), (last, onward) = walk[0], walk[-1]
    points = np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])
    return points, int(ends[first, 0 if ahead else 1]), int(ends[last, 1 if onward else 0])
