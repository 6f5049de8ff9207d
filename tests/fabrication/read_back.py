"""Read patterns back with other people's programs, as a laser's software would: [mm] from the lower left corner."""

import io
from dataclasses import dataclass

import ezdxf
import numpy as np
from svgelements import SVG, Circle, Close, Path


@dataclass(frozen=True)
class Seen:
    """What another program sees.

    Attributes:
        circles: by layer, (circles, 3): x, y and radius [mm].
        lines: by layer, points of every line (points, 2) [mm].
        closed: by layer, whether each line is closed.
    """

    circles: dict[str, np.ndarray]
    lines: dict[str, list[np.ndarray]]
    closed: dict[str, list[bool]]


def see_svg(content: bytes) -> Seen:
    """With svgelements; a millimeter is taken from the drawing's physical size, not from its viewBox."""
    names = {"#000000": "MARK", "#008000": "GUIDE", "#0000ff": "PINHOLE", "#ff0000": "CUT"}
    page = SVG.parse(io.BytesIO(content), reify=True, ppi=25.4)  # a pixel of svgelements is 1 mm then
    height = float(page.height)
    circles, lines, closed = ({name: [] for name in names.values()} for _ in range(3))
    for element in page.elements():
        if isinstance(element, Circle):
            layer = names[element.stroke.hex]
            circles[layer].append((element.cx, height - element.cy, element.rx))
        elif isinstance(element, Path):
            layer = names[element.stroke.hex]
            corners = [part.end for part in element.segments() if not isinstance(part, Close)]
            lines[layer].append(np.array([(corner.x, height - corner.y) for corner in corners]))
            closed[layer].append(isinstance(element[-1], Close))
    return Seen({name: np.array(rows).reshape(-1, 3) for name, rows in circles.items()}, lines, closed)


def see_dxf(content: bytes) -> Seen:
    """With ezdxf."""
    document = ezdxf.read(io.StringIO(content.decode()))
    names = ("MARK", "GUIDE", "PINHOLE", "CUT")
    circles, lines, closed = ({name: [] for name in names} for _ in range(3))
    for entity in document.modelspace():
        layer = entity.dxf.layer
        if entity.dxftype() == "CIRCLE":
            circles[layer].append((entity.dxf.center.x, entity.dxf.center.y, entity.dxf.radius))
        else:
            lines[layer].append(np.array([point[:2] for point in entity.get_points()]))
            closed[layer].append(entity.closed)
    return Seen({name: np.array(rows).reshape(-1, 3) for name, rows in circles.items()}, lines, closed)
