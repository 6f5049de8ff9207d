"""`SvgDocument`: the XML of a drawing, checked before anything trusts it, and the length of its unit."""

import re
from dataclasses import dataclass
from xml.etree import ElementTree
from xml.parsers import expat

from hydrostat.errors import OutlineError
from hydrostat.geometry.files.rings import MOST_POINTS

MOST_BYTES = 20_000_000
"""A drawing larger than this is refused."""

_MOST_DEPTH = 200
_NUMBER = re.compile(r"\d+\.?\d*|\.\d+")
_METRES = {"mm": 1e-3, "cm": 1e-2, "in": 0.0254, "pt": 0.0254 / 72, "pc": 0.0254 / 6, "q": 0.25e-3}
_PIXEL = 0.0254 / 96
_LENGTH = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([a-zA-Z]*)\s*")
_NO_SHAPES = {
    "text", "image", "clipPath", "mask", "pattern", "marker", "symbol", "foreignObject", "metadata", "script",
    "linearGradient", "radialGradient", "filter", "namedview",
}  # fmt: skip


@dataclass(frozen=True)
class SvgDocument:
    """A drawing without what is no shape, in its own units.

    Attributes:
        content: the SVG again, with width and height such that one user unit is one pixel.
        unit: length of one user unit along x and y [m], None if the drawing has no physical size.
        sheet: left, top, width and height of the page in user units; None if the drawing does not say.
    """

    content: bytes
    unit: tuple[float, float] | None
    sheet: tuple[float, float, float, float] | None


def open_svg(content: bytes, *, name: str) -> SvgDocument:
    """Check the bytes of a drawing, which nobody vouches for, and find the length of its unit.

    Raises:
        OutlineError: empty, too large, no XML, no SVG, with entities, or with `use` elements without end.
    """
    if not content.strip():
        raise OutlineError(f"{name}: the file is empty: export the drawing again as SVG")
    if len(content) > MOST_BYTES:
        raise OutlineError(
            f"{name}: the file has {len(content) / 1e6:.0f} MB, at most {MOST_BYTES / 1e6:.0f} MB are read: "
            "save the outline alone, without pictures"
        )
    _guard(content, name)
    root = ElementTree.fromstring(content)
    if _tag(root) != "svg":
        raise OutlineError(f"{name}: not an SVG drawing, its first element is <{_tag(root)}>: save it as SVG")
    _strip(root)
    _count(root, name)
    sheet = _sheet(root)
    unit = _normalise(root)
    return SvgDocument(ElementTree.tostring(root), unit, sheet)


def _guard(content: bytes, name: str) -> None:
    """Read the XML once without building anything: refuse what is broken, deep, or declares entities."""
    depth = 0

    def start(_tag: str, _attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > _MOST_DEPTH:
            raise OutlineError(f"{name}: elements nested deeper than {_MOST_DEPTH}: ungroup the drawing")

    def end(_tag: str) -> None:
        nonlocal depth
        depth -= 1

    def entity(*_arguments: object) -> None:
        raise OutlineError(f"{name}: declares XML entities, which are not read: save it as plain SVG")

    parser = expat.ParserCreate(namespace_separator="}")
    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.EntityDeclHandler = entity
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise OutlineError(f"{name}: not an SVG drawing ({error}): save it as SVG") from error


def _tag(element: ElementTree.Element) -> str:
    """Name of an element without its namespace."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""


def _strip(element: ElementTree.Element) -> None:
    """Remove what is no shape, everywhere below an element."""
    for child in list(element):
        if _tag(child) in _NO_SHAPES:
            element.remove(child)
        else:
            _strip(child)


def _count(root: ElementTree.Element, name: str) -> None:
    """Refuse drawings with too many points, or that repeat themselves without end by way of `use`."""
    targets = {element.attrib["id"]: element for element in root.iter() if "id" in element.attrib}
    points = 0
    stack: list[tuple[ElementTree.Element, tuple[str, ...]]] = [(root, ())]
    while stack:
        element, users = stack.pop()
        drawn = element.get("d", "") + element.get("points", "")
        points += 1 + sum(1 for _ in _NUMBER.finditer(drawn)) // 2
        if points > MOST_POINTS:
            raise OutlineError(f"{name}: more than {MOST_POINTS} points: simplify the drawing, save the outline alone")
        stack.extend((child, users) for child in element)
        if _tag(element) == "use":
            link = next((text for key, text in element.attrib.items() if key.rpartition("}")[2] == "href"), "")
            target = link.strip().removeprefix("#")
            if target in users:
                raise OutlineError(f"{name}: the <use> of #{target} holds itself: ungroup the clones")
            if target in targets:
                stack.append((targets[target], (*users, target)))


def _length(text: str | None) -> tuple[float, str] | None:
    """Number and unit of an SVG length; None if there is none, or it is no positive number."""
    match = _LENGTH.fullmatch(text or "")
    return (float(match[1]), match[2].lower()) if match and 0.0 < float(match[1]) < 1e9 else None


def _sheet(root: ElementTree.Element) -> tuple[float, float, float, float] | None:
    """The page in user units: the viewBox, or width and height from the origin."""
    width, height = (_length(root.get(key)) for key in ("width", "height"))
    pixels = (0.0, 0.0, _pixels(width), _pixels(height)) if width and height else None
    return _box(root.get("viewBox", "")) or pixels


def _pixels(length: tuple[float, str]) -> float:
    """A length in pixels."""
    return length[0] * _METRES.get(length[1], _PIXEL) / _PIXEL


def _normalise(root: ElementTree.Element) -> tuple[float, float] | None:
    """Make one user unit one pixel; return the length of a user unit along x and y [m], if it has one."""
    sides = [_length(root.get(key)) for key in ("width", "height")]
    box = _box(root.attrib.pop("viewBox", ""))
    keep = root.attrib.pop("preserveAspectRatio", "").strip()
    for key, side, extent in zip(("width", "height"), sides, box[2:] if box else (None, None), strict=True):
        pixels = extent or (_pixels(side) if side else 1000.0)
        root.set(key, repr(pixels))
    lengths = [side[0] * _METRES[side[1]] if side and side[1] in _METRES else None for side in sides]
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
