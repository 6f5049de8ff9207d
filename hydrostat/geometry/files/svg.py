"""Outlines from SVG drawings, whose XML is checked first."""

import io
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree
from xml.parsers import expat

import numpy as np

from hydrostat.errors import GIVE_SIZE, OutlineError
from hydrostat.geometry.files.drawing_body import Inner, drawing_of
from hydrostat.geometry.files.drawn_line import DrawnLine, Fill, PageFacts
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
from hydrostat.geometry.files.svg_groups import (
    LABEL,
    clipped_lines,
    is_clip,
    mark_clips,
    mark_labels,
    symbols_to_groups,
)
from hydrostat.geometry.outline import Ring
from hydrostat.units import plural, printable

if TYPE_CHECKING:
    from svgelements import Path

_REFERENCE = re.compile(r"&([^;&#\s]+);")
_COMMAND = re.compile(r"[A-DF-Za-df-z]")  # of a path; an e is part of a number
_NUMBER = re.compile(r"\d+\.?\d*|\.\d+")
_METERS = {"mm": 1e-3, "cm": 1e-2, "in": 0.0254, "pt": 0.0254 / 72, "pc": 0.0254 / 6, "q": 0.25e-3}
_PIXEL = 0.0254 / 96
_LENGTH = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([a-zA-Z]*)\s*")
_NO_SHAPES = {
    "text", "image", "clipPath", "mask", "pattern", "marker", "foreignObject", "metadata", "script",
    "linearGradient", "radialGradient", "filter", "namedview",
}  # fmt: skip


@dataclass(frozen=True)
class _SvgDocument:
    """Drawing without elements that are no shapes, in its own units."""

    content: bytes  # the SVG again, with width and height such that one user unit is one pixel
    # length of one user unit along x and y [m], None if the drawing has no physical size
    unit: tuple[float, float] | None
    # left, top, width and height of the page in user units; None if the drawing does not say
    sheet: tuple[float, float, float, float] | None
    unread_clips: int  # elements whose clip path or mask is not applied


def _open(content: bytes, name: str) -> _SvgDocument:
    """Check a stranger's drawing and find its unit (OutlineError: no XML, no SVG, entities, or endless `use`)."""
    _guard(content, name)
    root = ElementTree.fromstring(content)
    if _tag(root) != "svg":
        raise OutlineError(f"{name}: not an SVG drawing, its first element is <{_tag(root)}>: save it as SVG")
    symbols_to_groups(root, _sheet(root))
    mark_labels(root)
    try:
        unread = mark_clips(root)
    except ValueError as error:
        raise OutlineError(f"{name}: {error}: release them, or save the outline alone") from None
    _strip_others(root)
    _check_points(root, name)
    for element in root.iter():
        if _tag(element) == "style":
            element.text = _plain_rules(element.text or "")
    if root.get("viewBox", "").strip() and _box(root.get("viewBox", "")) is None:
        said = printable(root.get("viewBox", ""))[:60]
        raise OutlineError(f"{name}: its viewBox, {said!r}, must be four numbers, the last two above 0: save it again")
    sheet = _sheet(root)
    unit = _normalize(root)
    return _SvgDocument(ElementTree.tostring(root), unit, sheet, unread)


def _guard(content: bytes, name: str) -> None:
    """Read the XML once without building anything: reject XML that is broken, deep, or whose entities are no words."""
    depth = 0

    most_depth, most_expanded = 200, 2_000_000  # elements in one another; letters that entities may become

    def start(_tag: str, _attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > most_depth:
            raise OutlineError(f"{name}: elements nested deeper than {most_depth}: ungroup the drawing")

    def end(_tag: str) -> None:
        nonlocal depth
        depth -= 1

    lengths: dict[str, int] = {}  # letters that each entity becomes

    def entity(called: str, parameter: bool, value: str | None, *_others: object) -> None:
        used = _REFERENCE.findall(value or "")
        length = len(value or "") + sum(lengths.get(each, most_expanded) for each in used)
        if parameter or value is None or length * content.count(b"&") > most_expanded:
            raise OutlineError(f"{name}: declares XML entities that are not plain words: save it as plain SVG")
        lengths.setdefault(called, length)

    def refuse_attributes(*_arguments: object) -> None:
        raise OutlineError(f"{name}: declares XML attributes, which are not read: save it as plain SVG")

    parser = expat.ParserCreate(namespace_separator="}")
    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.EntityDeclHandler = entity
    parser.AttlistDeclHandler = refuse_attributes
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise OutlineError(f"{name}: {_fault(content, error)}") from error


def _fault(content: bytes, error: Exception) -> str:
    """Words for a file that is no XML: a picture by its first bytes, else a text that breaks off, else another one."""
    for kind, start in (("PNG", b"\x89PNG"), ("JPEG", b"\xff\xd8\xff"), ("PDF", b"%PDF")):
        if content.startswith(start):
            return f"not an SVG drawing but a {kind}: rename it to end in .{kind.lower().replace('jpeg', 'jpg')}"
    if b"<svg" in content[:4000]:
        return f"not an SVG drawing that is whole ({error}): it is cut off or damaged; save it again"
    return f"not an SVG drawing ({error}): save it as SVG"


def _plain_rules(text: str) -> str:
    """Rules of a style sheet, without comments and truncated rules, in which the reader would search forever."""
    first, *others = text.split("/*")
    said = " ".join([first, *(other.partition("*/")[2] for other in others)])
    rules = (rule.partition("{") for rule in said.split("}")[:-1])
    return "\n".join(f"{chosen.strip()} {{{body.strip()}}}" for chosen, _, body in rules if body.strip())


def _tag(element: ElementTree.Element) -> str:
    """Name of an element without its namespace."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""


def _strip_others(element: ElementTree.Element) -> None:
    """Remove all elements below one that are no shapes."""
    for child in list(element):
        if _tag(child) in _NO_SHAPES:
            element.remove(child)
        else:
            _strip_others(child)


def _check_points(root: ElementTree.Element, name: str) -> None:
    """Reject drawings with too many points, or with endless repetition by `use`."""
    _check_words(root, name)
    targets = {element.attrib["id"]: element for element in root.iter() if "id" in element.attrib}
    points = 0
    stack: list[tuple[ElementTree.Element, tuple[str, ...]]] = [(root, ())]
    while stack:
        element, users = stack.pop()
        drawn = element.get("d", "") + element.get("points", "")
        numbers, letters = (sum(1 for _ in kind.finditer(drawn)) for kind in (_NUMBER, _COMMAND))
        points += 1 + max(numbers // 2, letters)
        if points > MAX_POINTS:
            raise OutlineError(f"{name}: more than {MAX_POINTS} points: simplify the drawing, save the outline alone")
        stack.extend((child, users) for child in element)
        if _tag(element) == "use":
            link = next((text for key, text in element.attrib.items() if key.rpartition("}")[2] == "href"), "")
            target = link.strip().removeprefix("#")
            if target in users:
                raise OutlineError(f"{name}: the <use> of #{target} holds itself: ungroup the clones")
            if target in targets:
                stack.append((targets[target], (*users, target)))


def _check_words(root: ElementTree.Element, name: str) -> None:
    """Refuse long style sheets and long attributes that are no points: reading them could take for ever."""
    most_words = 100_000  # letters of a style sheet, and of an attribute that holds no points
    for element in root.iter():
        words = {key: len(value) for key, value in element.attrib.items() if key not in ("d", "points")}
        words["text"] = len(element.text or "") if _tag(element) == "style" else 0
        key = max(words, key=lambda each: words[each])
        if words[key] > most_words:
            what = "a style sheet" if key == "text" else f"an attribute {printable(key.rpartition('}')[2])[:40]!r}"
            raise OutlineError(
                f"{name}: has {what} of {words[key]} letters, at most {most_words} are read: save it as plain SVG"
            )


def _length(text: str | None) -> tuple[float, str] | None:
    """Number and unit of an SVG length; None if there is none, or it is no positive number."""
    match = _LENGTH.fullmatch(text or "")
    return (float(match[1]), match[2].lower()) if match and 0.0 < float(match[1]) < 1e9 else None


def _sheet(root: ElementTree.Element) -> tuple[float, float, float, float] | None:
    """Page in user units: the viewBox, or width and height from the origin."""
    width, height = (_length(root.get(key)) for key in ("width", "height"))
    pixels = (0.0, 0.0, _pixels(width), _pixels(height)) if width and height else None
    return _box(root.get("viewBox", "")) or pixels


def _pixels(length: tuple[float, str]) -> float:
    """Length in pixels."""
    return length[0] * _METERS.get(length[1], _PIXEL) / _PIXEL


def _normalize(root: ElementTree.Element) -> tuple[float, float] | None:
    """Make one user unit one pixel; return the length of a user unit along x and y [m], if it has one."""
    sides = [_length(root.get(key)) for key in ("width", "height")]
    box = _box(root.attrib.pop("viewBox", ""))
    keep = root.attrib.pop("preserveAspectRatio", "").strip()
    for key, side, extent in zip(("width", "height"), sides, box[2:] if box else (None, None), strict=True):
        pixels = extent or (_pixels(side) if side else 1000.0)
        root.set(key, repr(pixels))
    lengths = [side[0] * _METERS[side[1]] if side and side[1] in _METERS else None for side in sides]
    if box is None:
        return (_PIXEL, _PIXEL) if any(lengths) else None
    units = [length / extent for length, extent in zip(lengths, box[2:], strict=True) if length]
    if not units:
        return None
    if keep.startswith("none"):
        return units[0], units[-1]
    unit = max(units) if "slice" in keep else min(units)
    return unit, unit


def _box(text: str) -> tuple[float, float, float, float] | None:
    """Left, top, width and height of a viewBox in user units; None if there is none, or it is empty."""
    try:
        left, top, width, height = map(float, text.replace(",", " ").split())
    except ValueError:
        return None
    return (left, top, width, height) if 0.0 < width < 1e9 and 0.0 < height < 1e9 else None


_BROKEN = (ValueError, TypeError, AttributeError, LookupError, ArithmeticError, RecursionError)


def read_svg(
    content: bytes, name: str, size: float | None, page: Page | None, inner: Inner, part: int | None = None
) -> Drawing:
    """Read the outline of a body from an SVG drawing, with notes on omissions.

    What is painted is the body: filled shapes that overlap are one, filled lines are closed, what is clipped is cut,
    grounds and what is invisible are left out. Lines without fill are joined where their ends meet within their width.
    The largest closed shape, or that of number `part`, is the body; the shapes inside it are holes, or drawn on it.
    Text, pictures and open lines smaller than the body are ignored. Curves become chords. Without `size` or `page` the
    file must have a size in mm, cm, in, ...; see `read_outline`. Raises OutlineError: the file is no SVG, or no body
    can be made of it; the message says where, in the drawing's units.
    """
    document = _open(content, name)
    across, down = document.unit or (1.0, 1.0)
    kind = _kind_of_page(document)
    if page is not None:
        page.check(kind, name)
    lines = _read_lines(document, name)
    shapes = sorted_shapes(lines, _sheet_of(document), name)
    if page is None and size is None and document.unit is None:
        raise OutlineError(f"{name}: the drawing has no physical size (width in mm, cm or in): {GIVE_SIZE}")

    def page_of(body: Ring) -> Page:
        return page or page_about(body, kind, (across, -down), size)

    drawing = drawing_of(shapes, name, inner, page_of, part=part)
    if not document.unread_clips:
        return drawing
    note = (
        f"did not apply {plural(document.unread_clips, 'clip')} (clip-path or mask); if the body needs it, release it"
    )
    return replace(drawing, notes=(*drawing.notes, note))


def _sheet_of(document: _SvgDocument) -> PageFacts:
    """Facts on the page of the drawing."""
    unit = 1e3 * document.unit[0] if document.unit else None
    if document.sheet is None:
        return PageFacts(unit=unit)
    left, top, width, height = document.sheet
    return PageFacts(box=(left, top, left + width, top + height), unit=unit)


def _kind_of_page(document: _SvgDocument) -> str:
    """Unit and page in words, which two drawings must have in common: some programs count from a corner of the page."""
    kind = "an SVG drawing without a physical size"
    if document.unit is not None:
        across, down = document.unit
        kind = f"an SVG drawing in units of {1e3 * across:.4g} x {1e3 * down:.4g} mm"
    if document.sheet is None:
        return f"{kind} or page"
    left, top, width, height = document.sheet
    return f"{kind} on a page of {width:.6g} x {height:.6g} units from ({left:.6g}, {top:.6g})"


def _read_lines(document: _SvgDocument, name: str) -> list[DrawnLine]:
    """Lines of the drawing, cut by its clip paths; where nothing is painted, those that are not painted either."""
    try:
        return clipped_lines(_elements(document, name)) or clipped_lines(_elements(document, name, unpainted=True))
    except ValueError as error:
        raise OutlineError(f"{name}: {error}: release the clip paths, or save the outline alone") from None


def _elements(
    document: _SvgDocument, name: str, *, unpainted: bool = False
) -> Iterator[tuple[Mapping[str, str], list[DrawnLine]]]:
    """Yield the attributes of every visible element of a drawing, those of its groups too, and its lines."""
    from svgelements import SVG, Path, Shape

    try:
        elements = SVG.parse(io.BytesIO(document.content), reify=True, ppi=96).elements()
        for number, element in enumerate(elements):
            values = getattr(element, "values", None) or {}
            if not isinstance(element, Shape) or values.get("visibility") in ("hidden", "collapse"):
                continue
            fill, color, width = _paint(element, values)
            if fill is Fill.NONE and width == 0.0 and not unpainted and not is_clip(values):
                continue
            lines = []
            whole = Path(element)
            whole.reify()  # a turned rectangle or ellipse keeps its transform beside its numbers
            for subpath in whole.as_subpaths():
                path = Path(subpath)
                points = _flatten(path)
                if len(points) > 1:
                    closed = any(type(segment).__name__ == "Close" for segment in path)
                    label = values.get(LABEL) or ""
                    paint = {"fill": fill, "color": color, "width": width, "label": label, "element": number}
                    lines.append(DrawnLine(points=points, closed=closed, **paint))
            yield values, lines
    except _BROKEN as error:
        raise OutlineError(f"{name}: cannot be read as SVG ({one_line(error)}): save it again as plain SVG") from error


def _paint(element: Any, values: Mapping[str, Any]) -> tuple[Fill, tuple[int, int, int] | None, float]:
    """Fill of an element, its color, and the width of its line; no fill and no width where nothing is to be seen."""
    seen = _number(values.get("opacity"))
    fill, stroke = element.fill, element.stroke
    faint = 0.05
    width = 0.0
    if stroke is not None and stroke.value is not None and seen * stroke.opacity > faint:
        width = max(float(element.stroke_width or 0.0), 0.0)
    if fill is None or fill.value is None or seen * fill.opacity <= faint or type(element).__name__ == "SimpleLine":
        return Fill.NONE, None, width
    if str(values.get("fill")).startswith("url("):
        return Fill.FULL, None, width  # a gradient or pattern, of which the reader knows no color
    color = (int(fill.red), int(fill.green), int(fill.blue))
    pale = 235  # white, and what paper looks like
    return (Fill.PALE if min(color) >= pale else Fill.FULL), color, width


def _number(text: Any) -> float:
    """An opacity; 1 where it is none."""
    try:
        return float(str(text).rstrip("%")) / (100.0 if str(text).endswith("%") else 1.0)
    except ValueError:
        return 1.0


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
    return without_repeats(np.concatenate(pieces).astype(float))


def _chords(segment: Any, tolerance: float) -> int:
    """Number of chords that keep within `tolerance` of a bend: n^2 = max|second derivative| / (8 tolerance)."""
    if type(segment).__name__ == "Arc":
        bend = max(segment.rx, segment.ry) * segment.sweep**2
    elif type(segment).__name__ == "QuadraticBezier":
        bend = 2.0 * abs(complex(segment.start) - 2 * complex(segment.control) + complex(segment.end))
    else:
        knots = [complex(point) for point in (segment.start, segment.control1, segment.control2, segment.end)]
        bend = 6.0 * max(abs(a - 2 * b + c) for a, b, c in zip(knots, knots[1:], knots[2:], strict=False))
    return int(min(max(np.ceil(np.sqrt(bend / (8.0 * tolerance))), 1), MAX_POINTS))
