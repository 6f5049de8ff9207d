"""Outlines from SVG drawings."""

import io
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from hydrostat.errors import OutlineError
from hydrostat.geometry.files.drawing import Drawing
from hydrostat.geometry.files.page import Page, page_about
from hydrostat.geometry.files.rings import CHORD_ERROR, MOST_POINTS, body_and_holes, check_size, closed_rings, placed
from hydrostat.geometry.files.svg_document import SvgDocument, open_svg
from hydrostat.geometry.outline import Outline, Ring

if TYPE_CHECKING:
    from svgelements import Path

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
    return svg_drawing(content, name=name, size=size).outline


def svg_drawing(content: bytes, *, name: str, size: float | None = None, page: Page | None = None) -> Drawing:
    """Read the outline of a body, and in words what was left out; on the page of another, or as in `read_svg`."""
    check_size(size, name)
    document = open_svg(content, name=name)
    across, down = document.unit or (1.0, 1.0)
    kind = _kind(document)
    if page is not None:
        page.check(kind, name)
    elif size is None and document.unit is None:
        raise OutlineError(f"{name}: the drawing has no physical size (width in mm, cm or in): give its size")
    rings, notes = closed_rings(_lines(document, name), name)
    body, holes = body_and_holes(rings, name)
    page = page or page_about(body, kind, (across, -down), size)
    return Drawing(placed(body, holes, page, name), page, notes)


def _kind(document: SvgDocument) -> str:
    """What two drawings must have in common, in words: some programs count from a corner of the page."""
    kind = "an SVG drawing without a physical size"
    if document.unit is not None:
        across, down = document.unit
        kind = f"an SVG drawing in units of {1e3 * across:.4g} x {1e3 * down:.4g} mm"
    if document.sheet is None:
        return f"{kind} or page"
    left, top, width, height = document.sheet
    return f"{kind} on a page of {width:.6g} x {height:.6g} units from ({left:.6g}, {top:.6g})"


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
    tolerance = CHORD_ERROR * max(box[2] - box[0], box[3] - box[1]) or 1.0
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
