"""Outlines from SVG drawings."""

import io
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float
from shapely import Polygon

from hydrostat.errors import InputError, OutlineError
from hydrostat.geometry.outline import Outline, Ring, fault
from hydrostat.geometry.svg_document import MOST_POINTS, SvgDocument, open_svg

if TYPE_CHECKING:
    from svgelements import Path

_CHORD_ERROR = 2e-5
_GAP = 1e-3
_BROKEN = (ValueError, TypeError, AttributeError, LookupError, ArithmeticError, RecursionError)


def read_svg(content: bytes, *, name: str, size: float | None = None) -> Outline:
    """Read the outline of a body from a drawing.

    The largest closed shape is the body, the shapes inside it are holes; whether they are filled plays no part. Text,
    pictures, what is hidden and open lines smaller than the body are ignored. Curves become chords.

    Args:
        content: the bytes of the file.
        name: what errors call the file.
        size: longest side of the body's bounding box [m]; if not given, the file must have a size in mm, cm, in, ...

    Returns:
        The outline [m], x to the right, y up, origin at the centre of its bounding box.

    Raises:
        OutlineError: the file is no SVG, or no body can be made of it; the message says where, in the drawing's units.
        InputError: `size` is not positive.
    """
    if size is not None and not 0.0 < size < np.inf:
        raise InputError(f"{name}: the size must be positive, not {size} m")
    document = open_svg(content, name=name)
    if size is None and document.unit is None:
        raise OutlineError(f"{name}: the drawing has no physical size (width in mm, cm or in): give its size")
    body, holes = _body_and_holes(_closed_rings(document, name), name)
    return _placed(body, holes, document.unit, size)


def _closed_rings(document: SvgDocument, name: str) -> list[Ring]:
    """The closed rings of a drawing in its own units, largest box first."""
    rings, open_lines = [], []
    count = 0
    for line, closed in _lines(document, name):
        count += len(line)
        if count > MOST_POINTS:
            raise OutlineError(f"{name}: more than {MOST_POINTS} points: simplify the drawing")
        if not np.isfinite(line).all():
            raise OutlineError(f"{name}: a coordinate is not a finite number: save the drawing again")
        extent = float(np.ptp(line, axis=0).max())
        closed = closed or float(np.linalg.norm(line[0] - line[-1])) <= _GAP * extent
        (rings if closed else open_lines).append((extent, line))
    largest = max((extent for extent, _ in rings), default=0.0)
    extent, line = max(open_lines, key=lambda pair: pair[0], default=(0.0, np.zeros((2, 2))))
    if extent > largest:
        start, end = _place(line[0]), _place(line[-1])
        gap = float(np.linalg.norm(line[0] - line[-1]))
        raise OutlineError(f"{name}: the outline is open between {start} and {end}, a gap of {gap:.4g}: close the path")
    if largest == 0.0:
        raise OutlineError(f"{name}: no closed shape: draw the outline of the body as one closed path")
    return [line for extent, line in rings if extent > 0.0]


def _lines(document: SvgDocument, name: str) -> Iterator[tuple[Ring, bool]]:
    """Every visible subpath of a drawing as points in its own units, and whether it closes itself."""
    from svgelements import SVG, Path, Shape

    try:
        for element in SVG.parse(io.BytesIO(document.content), reify=True, ppi=96).elements():
            if isinstance(element, Shape) and (element.values or {}).get("visibility") not in ("hidden", "collapse"):
                for subpath in Path(element).as_subpaths():
                    path = Path(subpath)
                    points = _flatten(path)
                    if len(points) > 1:
                        yield points, any(type(segment).__name__ == "Close" for segment in path)
    except _BROKEN as error:
        reason = re.sub(r"\s+", " ", str(error))[:120]
        raise OutlineError(f"{name}: cannot be read as SVG ({reason}): save it again as plain SVG") from error


def _flatten(path: "Path") -> Ring:
    """Points along a path, close enough that its chords stray less than a fixed part of its box."""
    box = path.bbox()
    if box is None:
        return np.zeros((0, 2))
    if not np.isfinite(box).all():
        return np.full((2, 2), np.nan)
    tolerance = _CHORD_ERROR * max(box[2] - box[0], box[3] - box[1]) or 1.0
    pieces = [np.zeros((0, 2))]
    for segment in path:
        if type(segment).__name__ == "Move":
            continue
        if len(pieces) == 1:
            pieces.append(np.array([[segment.start.x, segment.start.y]]))
        if type(segment).__name__ in ("Line", "Close"):
            pieces.append(np.array([[segment.end.x, segment.end.y]]))
        else:
            pieces.append(np.asarray(segment.npoint(np.linspace(0.0, 1.0, _chords(segment, tolerance) + 1)[1:])))
    points = np.concatenate(pieces).astype(float)
    return points[np.r_[True, np.any(np.diff(points, axis=0) != 0.0, axis=1)]] if len(points) else points


def _chords(segment: Any, tolerance: float) -> int:
    """How many chords keep within `tolerance` of a bend: n^2 = max|second derivative| / (8 tolerance)."""
    if type(segment).__name__ == "Arc":
        bend = max(segment.rx, segment.ry) * segment.sweep**2
    elif type(segment).__name__ == "QuadraticBezier":
        bend = 2.0 * abs(complex(segment.start) - 2 * complex(segment.control) + complex(segment.end))
    else:
        knots = [complex(point) for point in (segment.start, segment.control1, segment.control2, segment.end)]
        bend = 6.0 * max(abs(a - 2 * b + c) for a, b, c in zip(knots, knots[1:], knots[2:], strict=False))
    return int(min(max(np.ceil(np.sqrt(bend / (8.0 * tolerance))), 1), MOST_POINTS))


MOST_SHAPES = 200
"""A drawing may have this many closed shapes: the body and its holes."""


def _body_and_holes(rings: list[Ring], name: str) -> tuple[Ring, list[Ring]]:
    """The largest ring, and the rings inside it."""
    shapes = []
    for ring in rings:
        polygon = Polygon(ring) if len(ring) >= 3 else None
        if polygon is not None and not polygon.exterior.is_simple:
            what, point = fault(polygon) or ("crosses itself", ring[0])
            raise OutlineError(f"{name}: the outline {what} at {_place(point)}: redraw it there")
        if polygon is not None and polygon.area > 0.0:
            shapes.append(polygon)
    if not shapes:
        raise OutlineError(f"{name}: the outline has no area: draw the body as one closed path")
    if len(shapes) > MOST_SHAPES:
        raise OutlineError(f"{name}: has {len(shapes)} closed shapes, more than {MOST_SHAPES}: leave out some holes")
    shapes.sort(key=lambda shape: shape.area, reverse=True)
    body, holes = shapes[0], []
    for shape in shapes[1:]:
        if body.disjoint(shape):
            raise OutlineError(
                f"{name}: a second closed shape lies outside the body at {_place(shape.exterior.coords[0])}: "
                "unite the shapes into one or delete it"
            )
        if any(shape.equals(other) for other in (body, *holes)):
            continue
        inside = next((hole for hole in holes if hole.contains(shape)), None)
        if inside is not None:
            raise OutlineError(
                f"{name}: a closed shape at {_place(shape.exterior.coords[0])} lies inside a hole and so hangs on "
                "nothing: delete it, or the hole"
            )
        crossing = next((other for other in (body, *holes) if other.exterior.intersects(shape.exterior)), None)
        if crossing is not None:
            point = crossing.exterior.intersection(shape.exterior).representative_point()
            raise OutlineError(f"{name}: a hole crosses the outline at {_place((point.x, point.y))}: move it inside")
        holes.append(shape)
    return np.array(body.exterior.coords), [np.array(hole.exterior.coords) for hole in holes]


def _placed(body: Ring, holes: list[Ring], unit: tuple[float, float] | None, size: float | None) -> Outline:
    """The outline in metres, y up, its box centred at the origin."""
    low, high = body.min(axis=0), body.max(axis=0)
    scale = np.array(unit or (1.0, 1.0))
    if size is not None:
        scale = scale * size / float(((high - low) * scale).max())
    scale = scale * [1.0, -1.0]
    middle = 0.5 * (low + high)
    return Outline((body - middle) * scale, tuple((hole - middle) * scale for hole in holes))


def _place(point: Float[np.ndarray, " 2"] | tuple[float, ...]) -> str:
    """A point of the drawing in words."""
    return f"({point[0]:.4g}, {point[1]:.4g})"
