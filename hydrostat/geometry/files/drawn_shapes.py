"""Closed shapes of a drawing: joined, closed as painted, united where paint overlaps, without ground and frames."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely import Polygon, STRtree, multipoints, unary_union
from shapely.geometry.base import BaseGeometry

from hydrostat.arrays import Int
from hydrostat.errors import OutlineError
from hydrostat.geometry.files.drawn_line import PAINTED, DrawnLine, Fill, PageFacts, painted_area
from hydrostat.geometry.files.grounds import find_grounds
from hydrostat.geometry.files.rings import checked_points, join_lines, point_text
from hydrostat.geometry.mesh import joined_groups
from hydrostat.geometry.outline import Ring
from hydrostat.units import plural


@dataclass(frozen=True, eq=False, kw_only=True)
class Shapes:
    """Closed and open lines of a drawing.

    Attributes:
        closed: closed lines, the largest area first.
        grounds: those of them that are the ground or a frame.
        doubtful: one that may be the body or a frame around it; None if there is none.
        open: lines that are not closed.
        notes: one line for each thing that was left out or repaired.
    """

    closed: tuple[DrawnLine, ...]
    grounds: tuple[DrawnLine, ...] = ()
    doubtful: DrawnLine | None = None
    open: tuple[Ring, ...] = ()
    notes: tuple[str, ...] = ()


_GAP = 1e-3  # ends of a line that are this part of its box apart, or less, meet
_ROUNDING = 1e-6
_MAX_SHAPES = 200  # a drawing may have this many closed shapes
_SPECK = 1e-8  # a closed shape of this part of the largest one's area is none


def sorted_shapes(lines: Sequence[DrawnLine], sheet: PageFacts, name: str) -> Shapes:
    """Close, join, unite and sort the lines of a drawing.

    A filled line is closed as it is painted. Open lines whose ends meet within their width are joined. Filled shapes
    that overlap are united.

    Args:
        lines: lines of the drawing, finite or not.
        sheet: facts on what surrounds the body.
        name: name of the file, for errors.

    Raises:
        OutlineError: too many points or closed lines, numbers that are not finite, no closed line, or an open one that
            is larger than all.
    """
    checked_points((line.points for line in lines), name)
    lines = [_close(line) for line in lines if len(line.points) > 1]
    rings = [line for line in lines if line.closed]
    loose = [line for line in lines if not line.closed]
    painted = _painted_outlines(loose, rings)
    rings += [replace(line, closed=True) for line in painted]
    notes = [f"closed {plural(len(painted), 'filled line')} as painted"] if painted else []
    taken = {id(line) for line in painted}
    joined, branch = _join([line for line in loose if id(line) not in taken], name)
    rings += [line for line in joined if line.closed]
    loose = [line for line in joined if not line.closed]
    largest = max((line.hull_area for line in rings), default=0.0)
    _refuse_open(rings, loose, branch, name)
    specks = [line for line in rings if line.hull_area <= _SPECK * largest]
    if specks and len(specks) < len(rings):
        notes.append(
            f"left out {plural(len(specks), 'closed line')} without area, at {point_text(specks[0].points[0])}"
        )
        rings = [line for line in rings if line not in specks]
    if len(rings) > _MAX_SHAPES:
        raise OutlineError(f"{name}: has {len(rings)} closed shapes, more than {_MAX_SHAPES}: leave out some holes")
    grounds, doubtful = find_grounds(_by_area(rings), sheet)
    shapes, united = unite_fills([line for line in rings if line not in grounds])
    if united:
        notes.append(f"united {united} filled shapes that overlap")
    return Shapes(
        closed=tuple(_by_area([*grounds, *shapes])),
        grounds=tuple(grounds),
        doubtful=doubtful if doubtful in shapes else None,
        open=tuple(line.points for line in loose),
        notes=tuple(notes),
    )


def _by_area(lines: Iterable[DrawnLine]) -> list[DrawnLine]:
    return sorted(lines, key=lambda line: line.polygon.area, reverse=True)


def _close(line: DrawnLine) -> DrawnLine:
    """The line, closed where its ends all but meet."""
    points, extent = line.points, line.extent
    gap = float(np.linalg.norm(points[0] - points[-1]))
    closed = line.closed or gap <= max(_GAP * extent, min(line.width, 0.05 * extent))  # its ends meet as painted
    if 0.0 < gap <= _ROUNDING * extent:
        points = np.concatenate([points[:-1], points[:1]])
    return replace(line, points=points, closed=closed)


def _painted_outlines(loose: list[DrawnLine], rings: list[DrawnLine]) -> list[DrawnLine]:
    """Filled open lines that lie in no closed shape; one within, such as a mouth, is no outline."""
    filled = [line for line in loose if line.fill in PAINTED and line.hull_area > 0.0]
    if not filled or not rings:
        return filled
    around = STRtree([ring.polygon for ring in rings])
    return [line for line in filled if not around.query(multipoints(line.points), predicate="covered_by").size]


def _join(lines: list[DrawnLine], name: str) -> tuple[list[DrawnLine], OutlineError | None]:
    """Open lines joined at their ends, and the complaint where they branch, so that they were not."""
    width = max((line.width for line in lines), default=0.0)
    try:
        found = join_lines([line.points for line in lines], name, within=width)
    except OutlineError as error:
        return lines, error
    fill = Fill.NONE if any(line.fill is not Fill.UNKNOWN for line in lines) else Fill.UNKNOWN
    label = " ".join(sorted({line.label for line in lines}))
    made = [DrawnLine(points=points, closed=closed, fill=fill, label=label) for points, closed in found]
    return [_close(line) for line in made], None


def _refuse_open(rings: list[DrawnLine], loose: list[DrawnLine], branch: OutlineError | None, name: str) -> None:
    """Complain where the outline must be one of the open lines: the hull of one is larger than every closed shape."""
    largest = max((line.hull_area for line in rings), default=0.0)
    line = max(loose, key=lambda line: (line.hull_area, line.extent), default=None)
    if line is not None and (line.hull_area > largest or not rings):
        if branch is not None:
            raise branch
        start, end = point_text(line.points[0]), point_text(line.points[-1])
        gap = float(np.linalg.norm(line.points[0] - line.points[-1]))
        raise OutlineError(f"{name}: the outline is open between {start} and {end}, a gap of {gap:.4g}: close the path")
    if not rings or max(line.extent for line in rings) == 0.0:
        raise OutlineError(
            f"{name}: no closed shape: draw the outline of the body as one closed path. "
            "Text must become paths (Inkscape: Path, Object to Path)"
        )


def unite_fills(rings: list[DrawnLine]) -> tuple[list[DrawnLine], int]:
    """Unite painted elements whose edges meet, as paint does; white ones without a line among themselves only.

    Args:
        rings: closed lines.

    Returns:
        The lines, with those around what was united in place of its own, and the number of elements united.
    """
    elements: dict[int, list[DrawnLine]] = {}
    for ring in rings:
        if ring.fill in PAINTED and ring.polygon.area > 0.0:
            elements.setdefault(ring.element, []).append(ring)
    members = list(elements.values())
    areas = [painted_area(each) for each in members]
    reach = _ROUNDING * max((ring.extent for ring in rings), default=0.0)
    groups = _meeting(areas, [each[0].fill is Fill.PALE and each[0].width == 0.0 for each in members], reach)
    made, parts, gone = [], 0, set()
    for group in np.flatnonzero(np.bincount(groups) > 1).tolist():
        chosen = np.flatnonzero(groups == group).tolist()
        whole = unary_union([areas[index].buffer(reach, join_style="mitre") for index in chosen])
        whole = whole.buffer(-reach, join_style="mitre")
        if isinstance(whole, Polygon):
            lines = [line for index in chosen for line in members[index]]
            made += _lines_around(whole, lines)
            gone |= {id(line) for line in lines}
            parts += len(chosen)
    return [line for line in rings if id(line) not in gone] + made, parts


def _meeting(areas: list[BaseGeometry], pale: list[bool], reach: float) -> Int[np.ndarray, " _"]:
    """Group of each area; those of one paint whose edges meet are in one, unless they are equal."""
    if len(areas) < 2:
        return np.zeros(len(areas), dtype=int)
    edges = [area.boundary.buffer(reach, quad_segs=1) for area in areas]
    pairs = STRtree(edges).query(edges, predicate="intersects")
    apart = [
        one > two and pale[one] == pale[two] and not areas[one].equals(areas[two]) for one, two in pairs.T.tolist()
    ]
    return joined_groups(pairs[:, np.array(apart, dtype=bool)], len(areas))


def _lines_around(whole: Polygon, lines: list[DrawnLine]) -> list[DrawnLine]:
    """Closed lines around an area that was united of some: its outer one, and its gaps."""
    gaps = [ring for ring in whole.interiors if Polygon(ring).area > _SPECK * whole.area]
    label = " ".join(sorted({line.label for line in lines}))
    fill = Fill.FULL if any(line.fill is Fill.FULL for line in lines) else Fill.PALE
    return [
        DrawnLine(points=np.array(ring.coords), closed=True, fill=fill, label=label, element=lines[0].element)
        for ring in (whole.exterior, *gaps)
    ]
