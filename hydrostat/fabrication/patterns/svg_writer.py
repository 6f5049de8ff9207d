"""`pattern_svg`: a pattern as an SVG drawing at true scale."""

import re
from collections.abc import Iterable
from xml.sax.saxutils import escape

from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import Circle, Layer, Shape

COLOURS = {Layer.MARK: "#000000", Layer.PINHOLE: "#0000ff", Layer.CUT: "#ff0000"}
"""Stroke of each layer: LightBurn and its like tell operations apart by these."""

_HAIRLINE = 0.1
_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def pattern_svg(pattern: Pattern) -> bytes:
    """The bytes of the drawing: millimetres, a group for each layer in the order of work, one for each panel within."""
    width, height = _number(pattern.width), _number(pattern.height)
    title = escape(_NOT_XML.sub("", pattern.name))
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
        f' width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}">',
        f"<title>{title}</title>",
        "<desc>Black: engrave; a cable runs outside along a solid line, inside along a dashed one. Blue: cut the "
        "pinholes. Red: cut the panels, last. The bar is 100 mm long.</desc>",
        *(line for layer in Layer for line in _layer(pattern, layer)),
        "</svg>",
    ]
    return ("\n".join(lines) + "\n").encode()


def _layer(pattern: Pattern, layer: Layer) -> Iterable[str]:
    yield (
        f'<g id="{layer}" inkscape:groupmode="layer" inkscape:label="{layer.upper()}" fill="none"'
        f' stroke="{COLOURS[layer]}" stroke-width="{_HAIRLINE}" stroke-linecap="round" stroke-linejoin="round">'
    )
    groups = [(panel.name, panel.shapes) for panel in pattern.panels] + [("sheet", pattern.shapes)]
    for name, shapes in groups:
        drawn = [shape_element(shape, pattern.height) for shape in shapes if shape.layer is layer]
        if drawn:
            yield from (f'<g id="{layer}-{name}">', *drawn, "</g>")
    yield "</g>"


def shape_element(shape: Shape, height: float) -> str:
    """A shape as an SVG element on a sheet of this height [mm]; the y axis turns over, as SVG counts it downwards."""
    if isinstance(shape, Circle):
        x, y = shape.centre
        centre = f'cx="{_number(x)}" cy="{_number(height - y)}"'
        return f'<circle class="{shape.part}" {centre} r="{_number(shape.radius)}"/>'
    path = "L".join(f"{_number(x)} {_number(height - y)}" for x, y in shape.points)
    return f'<path class="{shape.part}" d="M{path}{"Z" if shape.closed else ""}"/>'


def _number(value: float) -> str:
    """Micrometres are enough."""
    return f"{round(value, 3) + 0.0:.3f}".rstrip("0").rstrip(".")
