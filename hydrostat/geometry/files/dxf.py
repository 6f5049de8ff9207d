"""Outlines from DXF drawings."""

import io
import logging
import re
import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from hydrostat.errors import GIVE_SIZE, OutlineError
from hydrostat.geometry.files.drawing_body import Inner, drawing_of
from hydrostat.geometry.files.drawn_line import DrawnLine, PageFacts
from hydrostat.geometry.files.drawn_shapes import sorted_shapes
from hydrostat.geometry.files.rings import (
    CHORD_ERROR,
    MAX_POINTS,
    Drawing,
    Page,
    one_line,
    page_about,
    without_repeats,
)
from hydrostat.geometry.outline import Ring
from hydrostat.units import plural

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document

MAX_ENTITIES = 20_000  # a drawing with more entities, counting what its blocks repeat, is refused

_MAX_COORDINATE = 1e100
_FRAME_VERTEX = 16  # flag of a vertex that controls a fitted curve and lies beside it
_METERS = {
    1: 0.0254, 2: 0.3048, 3: 1609.344, 4: 1e-3, 5: 1e-2, 6: 1.0, 7: 1e3, 8: 25.4e-9, 9: 25.4e-6, 10: 0.9144,
    13: 1e-6, 14: 0.1,
}  # fmt: skip
_LINES = {"LWPOLYLINE", "POLYLINE", "CIRCLE", "ELLIPSE", "SPLINE", "LINE", "ARC"}
_AREAS = {"HATCH", "SOLID", "TRACE", "3DFACE"}
"""Kinds of entities that are read where there are no lines."""

_BROKEN = (ValueError, TypeError, AttributeError, LookupError, ArithmeticError, RecursionError, AssertionError)


def read_dxf(
    content: bytes, name: str, size: float | None, page: Page | None, inner: Inner, part: int | None = None
) -> Drawing:
    """Read the outline of a body from a DXF drawing in text form, with notes on omissions.

    The largest closed line that is no frame, or that of number `part`, is the body, those inside it are holes.
    Polylines, circles, ellipses, splines, lines and arcs are read, also in blocks, of the model space, or of a layout
    where that is empty; lines and arcs whose ends meet are joined. All else (text, dimensions, hatches), the hidden,
    and open lines smaller than the body are ignored. Heights (z) play no part. Curves become chords. Without `size` or
    `page` the file must name its unit ($INSUNITS); see `read_outline`. Raises OutlineError: the file is no DXF, or no
    body can be made of it; the message says where, in the drawing's units.
    """
    document, mended = _open(content, name)
    unit = _unit(document)
    kind = f"a DXF drawing in units of {1e3 * unit:.4g} mm" if unit else "a DXF drawing without a unit"
    if page is not None:
        page.check(kind, name)
    elif size is None and unit is None:
        raise OutlineError(f"{name}: the drawing has no unit ($INSUNITS): {GIVE_SIZE}")
    space = _Space(document, name)
    with _listening(), np.errstate(all="ignore"), warnings.catch_warnings(action="ignore"):
        lines = space.lines()
    side = unit or 1.0
    sheet = PageFacts(unit=1e3 * unit if unit else None, texts=tuple(space.texts))
    shapes = sorted_shapes(lines, sheet, name)
    notes = (*mended, *space.notes())

    def page_of(body: Ring) -> Page:
        return page or page_about(body, kind, (side, side), size)

    return drawing_of(shapes, name, inner, page_of, part=part, notes=notes)


def _open(content: bytes, name: str) -> tuple["Document", tuple[str, ...]]:
    """Open the document; return it with a note on repairs by the reader."""
    if content.startswith(b"AutoCAD Binary DXF"):
        raise OutlineError(f"{name}: a binary DXF, which is not read: save it as DXF in text form (ASCII)")
    content = content.rstrip(b"\x1a\x00 \t\r\n")  # a Ctrl-Z ends a file of DOS
    if not re.search(rb"\bEOF\Z", content):
        raise OutlineError(f"{name}: not a whole DXF drawing, it does not end with EOF: export it again")
    from ezdxf import recover
    from ezdxf.lldxf.const import DXFError

    try:
        with _listening() as said:
            document, auditor = recover.read(io.BytesIO(_with_markers(content)))
    except (DXFError, OSError, *_BROKEN) as error:
        raise OutlineError(f"{name}: cannot be read as DXF ({one_line(error)}): export the drawing again") from error
    if auditor.errors:
        raise OutlineError(f"{name}: the file is damaged ({one_line(auditor.errors[0].message)}): export it again")
    mended = [one_line(text) for text in (*said, *(fix.message for fix in auditor.fixes))]
    return document, (f"mended {plural(len(mended), 'fault')} of the file: {mended[0]}",) if mended else ()


_MARKERS = {b"LWPOLYLINE": b"AcDbPolyline", b"SPLINE": b"AcDbSpline", b"ELLIPSE": b"AcDbEllipse"}
_COMMON = {5, 6, 8, 48, 60, 62, 102, 330, 360, 370}  # group codes of every entity, before those of its kind


def _with_markers(content: bytes) -> bytes:
    """The file, with the subclass markers of entities that some programs leave out and the reader asks for."""
    if all(content.count(b"\n" + kind) <= content.count(marker) for kind, marker in _MARKERS.items()):
        return content
    lines = content.splitlines()
    made: list[bytes] = []
    wanted: bytes | None = None  # marker of the entity that is read, until its own codes begin
    for code, value in zip(lines[::2], lines[1::2], strict=False):
        if code.strip() == b"0":
            wanted = _MARKERS.get(value.strip())
            made += [code, value, *([b"100", b"AcDbEntity"] if wanted else [])]
            continue
        if wanted and code.strip() == b"100":
            if value.strip() == b"AcDbEntity":
                continue
            wanted = None
        elif wanted and not (code.strip().isdigit() and int(code) in _COMMON):
            made += [b"100", wanted]
            wanted = None
        made += [code, value]
    text = b"\n".join([*made, *lines[len(lines) // 2 * 2 :], b""])
    newer = rb"\1AC1015"  # older versions have no such entities, so that the reader looks for no markers
    if b"$ACADVER" in text:
        return re.sub(rb"(\$ACADVER\s+1\s+)AC10(?:0\d|12|14)", newer, text)
    return b"0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n0\nENDSEC\n" + text


@contextmanager
def _listening() -> Iterator[list[str]]:
    """Collect the messages of ezdxf, which would otherwise go to the screen."""
    said: list[str] = []
    handler = logging.Handler(logging.WARNING)
    handler.emit = lambda record: said.append(record.getMessage())
    logger = logging.getLogger("ezdxf")
    before = logger.propagate
    logger.addHandler(handler)
    logger.propagate = False
    try:
        yield said
    finally:
        logger.removeHandler(handler)
        logger.propagate = before


def _unit(document: "Document") -> float | None:
    """Length of one unit of the drawing [m]; None if it names none."""
    return _METERS.get(document.header.get("$INSUNITS", 0))


@dataclass
class _Space:
    """Reader of the model space of a document, or of a layout where that has no lines; counts omitted entities."""

    document: "Document"
    name: str
    budget: int = MAX_ENTITIES
    points: int = 0
    ignored: Counter[str] = field(default_factory=Counter)
    texts: list[tuple[float, float]] = field(default_factory=list)  # places of texts
    layout: str = ""  # name of the layout that was read in place of the model space
    areas: bool = False  # filled areas are read instead of lines

    def lines(self) -> list[DrawnLine]:
        """Every visible line, in the drawing's units."""
        from ezdxf.lldxf.const import DXFError

        try:
            found = list(self._lines_of(self.document.modelspace(), 0, ""))
            for layout in () if found else self.document.layout_names_in_taborder():
                if layout != "Model" and (found := list(self._lines_of(self.document.layout(layout), 0, ""))):
                    self.layout = layout
                    break
            if not found and any(self.ignored[kind] for kind in _AREAS):
                self.areas, self.ignored, self.texts = True, Counter(), []
                found = list(self._lines_of(self.document.modelspace(), 0, ""))
        except (DXFError, *_BROKEN) as error:
            raise OutlineError(f"{self.name}: cannot be read as DXF ({one_line(error)}): export it again") from error
        return found

    def notes(self) -> tuple[str, ...]:
        """Notes on the layout and on omitted entities."""
        read = (f"read from the layout {self.layout!r}, as the model space is empty",) if self.layout else ()
        kinds = [f"{count} {kind}" for kind, count in sorted(self.ignored.items())]
        return (*read, f"left out {', '.join(kinds)}") if kinds else read

    def _lines_of(self, entities: Any, depth: int, block_name: str) -> Iterator[DrawnLine]:
        for entity in entities:
            self._spend(1, depth)
            kind = entity.dxftype()
            if self._is_hidden(entity):
                self.ignored["hidden"] += 1
            elif kind == "INSERT":
                block = entity.block()
                if block is None:
                    raise OutlineError(f"{self.name}: the block {entity.dxf.name!r} is missing: explode the blocks")
                self._spend(abs(entity.mcount) * (1 + len(block)), depth)
                named = f"{block_name} {entity.dxf.name}".strip()
                for insert in entity.multi_insert() if entity.mcount > 1 else (entity,):
                    yield from self._lines_of(insert.virtual_entities(), depth + 1, named)
            elif kind in _LINES and not (kind == "POLYLINE" and (entity.is_poly_face_mesh or entity.is_polygon_mesh)):
                yield from self._drawn(entity, [_flatten(entity)], block_name)
            elif self.areas and kind in _AREAS:
                yield from self._drawn(entity, _edges(entity), block_name)
            else:
                self.ignored[kind] += 1
                place = entity.dxf.get("insert") if kind in ("TEXT", "MTEXT", "ATTRIB", "ATTDEF") else None
                if place is not None:
                    self.texts.append((float(place.x), float(place.y)))

    def _drawn(self, entity: Any, found: list[Ring], block_name: str) -> Iterator[DrawnLine]:
        """Lines of an entity along some points."""
        self.points += sum(map(len, found))
        if self.points > MAX_POINTS:
            raise OutlineError(f"{self.name}: more than {MAX_POINTS} points: simplify the drawing")
        label = f"{entity.dxf.get('layer', '0')} {block_name}".strip()
        for points in found:
            if len(points) > 1:
                yield DrawnLine(points=points, closed=self.areas or _is_closed(entity, points), label=label)

    def _spend(self, count: int, depth: int) -> None:
        """Refuse drawings that repeat their blocks without end."""
        self.budget -= count
        if self.budget < 0:
            raise OutlineError(f"{self.name}: more than {MAX_ENTITIES} entities: save the outline alone")
        most_depth = 20
        if depth > most_depth:
            raise OutlineError(f"{self.name}: blocks nested deeper than {most_depth}: explode the blocks")

    def _is_hidden(self, entity: Any) -> bool:
        """Return True if an entity or its layer is switched off."""
        layers = self.document.layers
        layer = entity.dxf.get("layer", "0")
        off = layer in layers and (layers.get(layer).is_off() or layers.get(layer).is_frozen())
        return off or bool(entity.dxf.get("invisible", 0))


def _flatten(entity: Any) -> Ring:
    """Points along an entity, close enough that its chords stray less than a fixed part of its box."""
    from ezdxf.path import make_path

    if entity.dxftype() == "SPLINE":
        return without_repeats(_spline(entity))
    if entity.dxftype() == "POLYLINE" and any(vertex.dxf.flags & _FRAME_VERTEX for vertex in entity.vertices):
        places = [vertex.dxf.location for vertex in entity.vertices if not vertex.dxf.flags & _FRAME_VERTEX]
        return without_repeats(np.array([(place.x, place.y) for place in places]).reshape(-1, 2))
    return _along(make_path(entity, segments=16))


def _edges(entity: Any) -> list[Ring]:
    """Points around a filled area, and around the gaps in it."""
    from ezdxf.path import from_hatch, make_path

    return [_along(path) for path in (from_hatch(entity) if entity.dxftype() == "HATCH" else [make_path(entity)])]


def _along(path: Any) -> Ring:
    """Points along a path of ezdxf."""
    control = np.array([(point.x, point.y) for point in path.control_vertices()]).reshape(-1, 2)
    if not len(control):
        return control
    if not (np.abs(control) < _MAX_COORDINATE).all():
        return np.full((2, 2), np.nan)
    tolerance = CHORD_ERROR * float(np.ptp(control, axis=0).max()) or 1.0
    points = [(point.x, point.y) for point in islice(path.flattening(tolerance, segments=2), MAX_POINTS + 1)]
    return without_repeats(np.array(points).reshape(-1, 2))


def _spline(entity: Any) -> Ring:
    """Points along a spline, where its knots say it is: not all begin and end at a control point."""
    from scipy.interpolate import BSpline  # Imported here: few drawings need it.

    tool = entity.construction_tool()
    control = np.array([(point.x, point.y) for point in tool.control_points]).reshape(-1, 2)
    knots, degree = np.array(tool.knots(), dtype=float), tool.order - 1
    weights = np.array(tool.weights() or np.ones(len(control)), dtype=float)
    if not all((np.abs(values) < _MAX_COORDINATE).all() for values in (control, knots, weights)):
        return np.full((2, 2), np.nan)
    curve = BSpline(knots, np.column_stack([control * weights[:, None], weights]), degree)
    ends = np.unique(knots[degree : len(control) + 1])
    tolerance = CHORD_ERROR * float(np.ptp(control, axis=0).max()) or 1.0
    count = 4
    while True:
        shares = np.arange(2 * count) / (2 * count)
        at = np.r_[(ends[:-1, None] + np.diff(ends)[:, None] * shares).ravel(), ends[-1]]
        points = curve(at)[:, :2] / curve(at)[:, 2:]
        bends = np.linalg.norm(points[1:-1:2] - 0.5 * (points[:-2:2] + points[2::2]), axis=1)
        if not (bends > tolerance).any() or 4 * count * len(ends) > MAX_POINTS:
            return points[::2]
        count *= 2


def _is_closed(entity: Any, points: Ring) -> bool:
    """Return True if an entity is closed, by its own flag or by its points."""
    if entity.dxftype() in ("LWPOLYLINE", "POLYLINE") and entity.is_closed:
        return True
    extent = float(np.ptp(points, axis=0).max())
    return float(np.linalg.norm(points[0] - points[-1])) <= 1e-9 * extent
