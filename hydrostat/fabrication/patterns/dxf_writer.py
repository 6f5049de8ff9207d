"""`pattern_dxf`: a pattern as a DXF drawing at true scale."""

from collections.abc import Iterator
from contextlib import contextmanager
from io import StringIO
from threading import Lock
from typing import TYPE_CHECKING

from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import Circle, Layer, Shape

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts.layout import Modelspace

_COLORS = {Layer.MARK: 7, Layer.GUIDE: 3, Layer.PINHOLE: 5, Layer.CUT: 1}
"""By DXF's index of colors: 5 is blue, 3 green, 1 red, and 7 is black on paper and white on a dark screen."""

_WRITING = Lock()  # dates are switched off for all drawings of a process: one at a time


def pattern_dxf(pattern: Pattern) -> bytes:
    """The bytes of the drawing (R2010, millimeters): a layer for each operation, closed polylines and circles."""
    with _WRITING, _without_dates():
        text = StringIO()
        document = pattern_document(pattern)
        document.write(text)
        return text.getvalue().encode(document.output_encoding)


def pattern_document(pattern: Pattern) -> "Drawing":
    """The drawing as a document of ezdxf."""
    from ezdxf import new  # pyright: ignore[reportPrivateImportUsage]
    from ezdxf.units import MM

    document = new("R2010", units=MM)
    document.header["$EXTMIN"] = (0.0, 0.0, 0.0)
    document.header["$EXTMAX"] = (pattern.width, pattern.height, 0.0)
    for layer in Layer:
        document.layers.add(layer.upper(), color=_COLORS[layer])
    space = document.modelspace()
    for shape in (*(shape for panel in pattern.panels for shape in panel.shapes), *pattern.shapes):
        _draw(space, shape)
    _sort_classes(document)
    return document


def _sort_classes(document: "Drawing") -> None:
    """Classes by name: ezdxf takes them from a set, whose order is another one on every run."""
    section = document.classes
    section.add_required_classes(document.dxfversion)
    section.classes = dict(sorted(section.classes.items()))


def _draw(space: "Modelspace", shape: Shape) -> None:
    layer = {"layer": shape.layer.upper()}
    if isinstance(shape, Circle):
        space.add_circle(shape.center, shape.radius, dxfattribs=layer)
    else:
        space.add_lwpolyline(shape.points, close=shape.closed, dxfattribs=layer)


@contextmanager
def _without_dates() -> Iterator[None]:
    """No date and no random identity in a drawing, so that one pattern is one file."""
    from ezdxf import options  # pyright: ignore[reportPrivateImportUsage]

    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before
