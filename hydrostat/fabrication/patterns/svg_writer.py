"""`pattern_svg`: a pattern as an SVG drawing at true scale."""

import re
from collections.abc import Iterable, Mapping
from xml.sax.saxutils import escape

from hydrostat.drawing import NAMESPACE, Html, number, path, shape, tag
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import Circle, Layer, Shape

COLORS = {Layer.MARK: "#000000", Layer.GUIDE: "#008000", Layer.PINHOLE: "#0000ff", Layer.CUT: "#ff0000"}
"""Stroke of each layer: LightBurn and its like tell operations apart by these."""


_DIGITS = 3  # micrometers are enough

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def pattern_svg(pattern: Pattern) -> bytes:
    """The bytes of the drawing: millimeters, a group for each layer in the order of work, one for each panel within."""
    width, height = number(pattern.width, _DIGITS), number(pattern.height, _DIGITS)
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="{NAMESPACE}" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
        f' width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}">',
        f"<title>{escape(_NOT_XML.sub('', pattern.name))}</title>",
        "<desc>Black: engrave. Green: guides that show on the right side of the cloth, to be drawn with a pen that "
        "washes out or left off; a cable runs outside along a solid line, inside along a dashed one. Blue: cut the "
        "pinholes. Red: cut the panels, last. The bar is 100 mm long.</desc>",
        *(line for layer in Layer for line in _layer(pattern, layer)),
        "</svg>",
    ]
    return ("\n".join(lines) + "\n").encode()


def _layer(pattern: Pattern, layer: Layer) -> Iterable[str]:
    hairline = 0.1
    yield (
        f'<g id="{layer}" inkscape:groupmode="layer" inkscape:label="{layer.upper()}" fill="none"'
        f' stroke="{COLORS[layer]}" stroke-width="{hairline}" stroke-linecap="round" stroke-linejoin="round">'
    )
    groups = [(panel.name, panel.shapes) for panel in pattern.panels] + [("sheet", pattern.shapes)]
    for name, shapes in groups:
        drawn = [shape_element(shape, pattern.height) for shape in shapes if shape.layer is layer]
        if drawn:
            yield from (f'<g id="{layer}-{name}">', *drawn, "</g>")
    yield "</g>"


def shape_element(drawn: Shape, height: float) -> Html:
    """A shape as an SVG element on a sheet of this height [mm]; the y axis turns over, as SVG counts it downwards."""
    if isinstance(drawn, Circle):
        x, y = drawn.center
        cx, cy, r = (number(value, _DIGITS) for value in (x, height - y, drawn.radius))
        return shape("circle", class_=drawn.part, cx=cx, cy=cy, r=r)
    way = [(x, height - y) for x, y in drawn.points]
    return shape("path", class_=drawn.part, d=path([way], digits=_DIGITS, closed=drawn.closed))


def shapes_svg(
    shapes: Iterable[Shape], height: float, view: str, size: tuple[float, float], widths: Mapping[Layer, float]
) -> Html:
    """A window (left, top, width, height) of a sheet as a picture, a group for each layer with its width; in mm."""
    shapes = tuple(shapes)
    groups = [
        tag(
            "g",
            [shape_element(drawn, height) for drawn in shapes if drawn.layer is layer],
            fill="none",
            stroke=COLORS[layer],
            stroke_width=f"{widths[layer]:.4f}",
            stroke_linecap="round",
            stroke_linejoin="round",
        )
        for layer in Layer
    ]
    width, tall = (f"{side:.6f}mm" for side in size)
    return tag("svg", groups, xmlns=NAMESPACE, width=width, height=tall, viewBox=view)
