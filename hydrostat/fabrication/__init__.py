"""What a robot is built from: drawings at true scale, in millimetres."""

from hydrostat.fabrication.kit import export_kit
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.pattern import Panel, Pattern, plush_pattern
from hydrostat.fabrication.patterns.pattern_options import Corner, PatternOptions
from hydrostat.fabrication.patterns.shape import Circle, Layer, Line, Part, Shape
from hydrostat.fabrication.patterns.svg_writer import pattern_svg

__all__ = [
    "Circle",
    "Corner",
    "Layer",
    "Line",
    "Panel",
    "Part",
    "Pattern",
    "PatternOptions",
    "Shape",
    "export_kit",
    "pattern_dxf",
    "pattern_svg",
    "plush_pattern",
]
