"""`cut_sheet`: one plate as a drawing for the laser cutter."""

from collections.abc import Iterable

from hydrostat.fabrication.patterns.panel import Panel
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import Layer, Line, Part, Place
from hydrostat.fabrication.patterns.sheet_layout import lay_out

_GAP = 10.0
"""Round the plate [mm]."""


def cut_sheet(name: str, rings: Iterable[tuple[Place, ...]]) -> Pattern:
    """A plate with its holes [mm], above the bar of 100 mm."""
    lines = tuple(Line(layer=Layer.CUT, part=Part.EDGE, points=ring, closed=True) for ring in rings)
    sheet = lay_out((Panel(name="plate", origin=(0.0, 0.0), mirrored=False, shapes=lines),), (), _GAP)
    ruler = tuple(line for line in sheet.ruler if line.part is Part.RULER)
    return Pattern(name=name, panels=sheet.panels, shapes=ruler, width=sheet.width, height=sheet.height)
