"""Symbols, clip paths and layers of SVG drawings, written as plain groups that the reader knows."""

import re
from collections.abc import Iterable, Iterator, Mapping
from copy import deepcopy
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
from shapely import LineString, MultiLineString, Polygon, get_parts, unary_union
from shapely.geometry.base import BaseGeometry

from hydrostat.geometry.files.drawn_line import PAINTED, DrawnLine, painted_area

LABEL = "data-label"
"""Attribute for the names of an element: its own, and the labels of its layers."""

_CLIP, _CLIPPED = "data-clip-", "data-clipped-"
_URL = re.compile(r"url\(\s*['\"]?#([^'\")]+)['\"]?\s*\)")
_STYLE = re.compile(r"(?:^|;)\s*(clip-path|mask)\s*:\s*([^;]+)")
_WINDOWS = ("clipPath", "mask")
_BLACK = re.compile(r"(?:^|[;:\s])(black|#000|#000000)\s*(?:;|$)", re.IGNORECASE)
_MAX_STYLE = 100_000  # letters of a style sheet that are searched for clip paths


def _tag(element: ElementTree.Element) -> str:
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""


def _rename(element: ElementTree.Element, tag: str) -> str:
    """Name of another element in the same namespace."""
    space = element.tag.rpartition("}")[0]
    return f"{space}}}{tag}" if space else tag


def symbols_to_groups(root: ElementTree.Element, sheet: tuple[float, float, float, float] | None) -> None:
    """Make a group of each symbol, which is drawn where it is used only, with the scale of its viewBox.

    Args:
        root: document; it is changed.
        sheet: left, top, width and height of its page, for uses without a size of their own.
    """
    boxes: dict[str, list[float] | None] = {}
    hidden = ElementTree.SubElement(root, _rename(root, "defs"))
    for parent in list(root.iter()):
        for symbol in [child for child in parent if _tag(child) == "symbol"]:
            parent.remove(symbol)
            hidden.append(symbol)
            symbol.tag = _rename(symbol, "g")
            box = _numbers(symbol.attrib.pop("viewBox", ""))
            boxes[symbol.get("id", "")] = box if len(box) == 4 and min(box[2:]) > 0.0 else None
    for use in root.iter():
        if _tag(use) == "use" and (target := _link(use)) in boxes:
            x, y = (_length(use.attrib.pop(key, ""), 0.0) for key in ("x", "y"))
            whole = sheet[2:] if sheet else (100.0, 100.0)
            size = [
                _length(use.attrib.pop(key, ""), full) for key, full in zip(("width", "height"), whole, strict=True)
            ]
            move = f"translate({x!r},{y!r})"
            if (box := boxes[target]) is not None:
                scale = min(size[0] / box[2], size[1] / box[3])
                left, top = (x + (size[0] - scale * box[2]) / 2, y + (size[1] - scale * box[3]) / 2)
                move = f"translate({left!r},{top!r}) scale({scale!r}) translate({-box[0]!r},{-box[1]!r})"
            use.set("transform", f"{use.get('transform', '')} {move}".strip())


def _numbers(text: str) -> list[float]:
    try:
        return [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        return []


def _length(text: str, otherwise: float) -> float:
    """Length in user units; another where there is none, or it is a share of the page."""
    found = _numbers(text.strip().removesuffix("px"))
    return found[0] if len(found) == 1 and np.isfinite(found[0]) else otherwise


def _link(element: ElementTree.Element) -> str:
    """Name of the element that another refers to."""
    link = next((text for key, text in element.attrib.items() if key.rpartition("}")[2] == "href"), "")
    return link.strip().removeprefix("#")


def mark_labels(root: ElementTree.Element, layers: str = "") -> None:
    """Give each element its names as an attribute that the reader keeps: id, class, and the labels of its layers."""
    label = next((text for key, text in root.attrib.items() if key.endswith("}label")), "")
    layers = f"{layers} {label}".strip()
    root.set(LABEL, f"{root.get('id', '')} {root.get('class', '')} {layers}".strip())
    for child in root:
        mark_labels(child, layers)


def mark_clips(root: ElementTree.Element) -> int:
    """Put the shapes of a clip path beside each element that it clips; both are marked by a number.

    A mask clips as well, unless it has black in it. Only clip paths in the units of the drawing are known; others clip
    nothing here. Returns the number of elements whose clip path or mask is not applied. Raises ValueError: clip paths
    would be repeated too often.
    """
    most = 20_000  # elements that clip paths are repeated as
    clips = {each.get("id", ""): each for each in root.iter() if _is_window(each)}
    sheet = _clips_of_names(root)
    number, unread = 0, 0
    windows = {each.get("id", "") for each in root.iter() if _tag(each) in _WINDOWS}
    for parent in list(root.iter()):
        if _tag(parent) in _WINDOWS:
            continue
        for place, element in enumerate(list(parent)):
            names = [f"#{element.get('id', '')}", *(f".{each}" for each in element.get("class", "").split())]
            style = next((words[1] for words in _STYLE.findall(element.get("style", ""))), "")
            said = element.get("clip-path") or style or element.get("mask")
            said = said or next((sheet[each] for each in names if each in sheet), "")
            found = _URL.search(said)
            clip = clips.get(found[1]) if found else None
            if clip is None:
                unread += said.strip() not in ("", "none") and (found is None or found[1] in windows)
                continue
            unread += bool(element.get("clip-path") and element.get("mask"))
            number += 1
            most -= sum(1 for _ in clip.iter())
            if most < 0:
                raise ValueError("clip paths are repeated too often")
            group = ElementTree.Element(_rename(element, "g"), {f"{_CLIPPED}{number}": "1"})
            moves = f"{element.get('transform', '')} {clip.get('transform', '')}".strip()
            window = ElementTree.SubElement(group, _rename(element, "g"), {f"{_CLIP}{number}": "1", "transform": moves})
            window.extend(deepcopy(list(clip)))
            group.append(element)
            parent[place] = group
    return unread


def _is_window(element: ElementTree.Element) -> bool:
    """True for a clip path with shapes in the units of the drawing, and for such a mask without black."""
    if _tag(element) not in _WINDOWS or not len(element):
        return False
    units = element.get("clipPathUnits") or element.get("maskContentUnits") or "userSpaceOnUse"
    black = any(_BLACK.search(f"{each.get('fill', '')};{each.get('style', '')}") for each in element.iter())
    return units == "userSpaceOnUse" and not (_tag(element) == "mask" and black)


def _clips_of_names(root: ElementTree.Element) -> dict[str, str]:
    """Clip paths that style sheets give, by class (.name) and id (#name)."""
    found: dict[str, str] = {}
    for sheet in (each.text or "" for each in root.iter() if _tag(each) == "style"):
        for rule in sheet[:_MAX_STYLE].split("}"):
            chosen, _, body = rule.partition("{")
            for _, said in _STYLE.findall(body):
                found |= {name.strip(): said for name in chosen.split(",")}
    return found


def is_clip(values: Mapping[str, str]) -> bool:
    """True if an element is the window of a clip path."""
    return any(key.startswith(_CLIP) for key in values)


def clipped_lines(elements: Iterable[tuple[Mapping[str, str], list[DrawnLine]]]) -> list[DrawnLine]:
    """Lines of elements, cut by their clip paths.

    Args:
        elements: attributes of each element, those of its groups too, and its lines.
    """
    drawn, windows = [], {}
    for values, lines in elements:
        names = [key.removeprefix(_CLIP) for key in values if key.startswith(_CLIP)]
        if names:
            windows.setdefault(max(names, key=int), []).append(_window(lines))
        else:
            drawn.append(([key.removeprefix(_CLIPPED) for key in values if key.startswith(_CLIPPED)], lines))
    areas = {name: unary_union(parts) for name, parts in windows.items()}
    made = []
    for names, lines in drawn:
        for name in names:
            lines = list(_clip_lines(lines, areas[name])) if name in areas else lines
        made += lines
    return made


def _window(lines: list[DrawnLine]) -> BaseGeometry:
    """Area of a shape of a clip path (ValueError: it has too many lines)."""
    most_lines = 200
    if len(lines) > most_lines:
        raise ValueError(f"a clip path has {len(lines)} lines, more than {most_lines}")
    return painted_area(lines)


def _clip_lines(lines: list[DrawnLine], window: BaseGeometry) -> Iterator[DrawnLine]:
    """Lines of an element within a window; unchanged where they lie in it."""
    if all(window.covers(LineString(line.points)) for line in lines):
        yield from lines
    elif lines and lines[0].fill in PAINTED:
        for part in get_parts(_window(lines).intersection(window)):
            if isinstance(part, Polygon):
                for ring in (part.exterior, *part.interiors):
                    yield replace(lines[0], points=np.array(ring.coords), closed=True)
    else:
        for line in lines:
            whole = np.concatenate([line.points, line.points[:1]]) if line.closed else line.points
            for part in get_parts(LineString(whole).intersection(window)):
                if isinstance(part, LineString | MultiLineString) and part.length > 0.0:
                    yield replace(line, points=np.array(part.coords), closed=part.is_ring)
