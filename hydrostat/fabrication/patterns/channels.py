"""`channel_strips`: strips of cloth to sew on a skin as channels of cables, as on the glove of the thesis."""

import math
from collections.abc import Mapping, Sequence

from hydrostat.fabrication.patterns.lettering import Lettering
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import LaserLine, Layer, Panel, PatternPart
from hydrostat.fabrication.patterns.sheet_layout import lay_out

WIDTH = 14.0  # of a strip: a channel of 8 mm, and 3 mm beyond each of its seams [mm]
SEAM = 3.0  # from the edge of a strip to its seam [mm]
_MAX_PIECE = 150.0  # of a piece, so that it fits on one page of an office printer [mm]
_END = 12.0  # of a strip before its first point and beyond its last, with its name [mm]


def channel_strips(name: str, ways: Mapping[str, Sequence[tuple[str, float]]]) -> Pattern:
    """Strips at true scale, unrolled along each cable, with a line across at each point of its map.

    Args:
        name: name of the pattern.
        ways: points of each cable by its name, as (name, distance from the winch [mm]), in their order.
    """
    strips = [panel for cable, points in ways.items() for panel in _cut_strips(cable, points)]
    sheet = lay_out(tuple(strips[:1]), tuple(strips[1:]), 8.0)
    return Pattern(name=name, panels=sheet.panels, shapes=sheet.ruler, width=sheet.width, height=sheet.height)


def _cut_strips(cable: str, points: Sequence[tuple[str, float]]) -> list[Panel]:
    """The strip of one cable, in pieces; a piece ends where the next begins."""
    first, last = points[0][1], points[-1][1]
    count = max(1, math.ceil((last - first) / _MAX_PIECE))
    step, pieces = (last - first) / count, []
    for piece in range(count):
        start = first + piece * step
        marks = [(word, at - start) for word, at in points if start - 1e-6 <= at <= start + step + 1e-6]
        title = cable if count == 1 else f"{cable} {chr(ord('a') + piece)}"
        pieces.append(Panel(name=title, origin=(0.0, 0.0), mirrored=False, shapes=tuple(_draw(title, marks, step))))
    return pieces


def _draw(title: str, marks: Sequence[tuple[str, float]], length: float) -> list[LaserLine]:
    corners = ((-_END, 0.0), (length + _END, 0.0), (length + _END, WIDTH), (-_END, WIDTH))
    lines = [LaserLine(layer=Layer.CUT, part=PatternPart.EDGE, points=corners, closed=True)]
    lines += [
        LaserLine(layer=Layer.MARK, part=PatternPart.SEAM, points=((-_END, y), (length + _END, y)))
        for y in (SEAM, WIDTH - SEAM)
    ]
    for index, (word, at) in enumerate(marks):
        lines.append(LaserLine(layer=Layer.MARK, part=PatternPart.NOTCH, points=((at, 0.0), (at, WIDTH))))
        number = Lettering(word.split()[0], 2.5)
        row = WIDTH / 2 + (1.7 if index % 2 else -1.7)  # neighbors in two rows, as points may be 4 mm apart
        lines += number.lines((at + 1.0 + number.width / 2, row))
    lines += Lettering(title, 3.5).lines((-_END / 2 - 0.5, WIDTH / 2))
    return lines
