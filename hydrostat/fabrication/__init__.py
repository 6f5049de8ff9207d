"""What a robot is built from: patterns, printed parts, moulds, lists and pages; lengths in millimetres."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.fabrication.build_kit import build_kit, export_kit
    from hydrostat.fabrication.demand import Demand, find_demand
    from hydrostat.fabrication.kit import Check, Kit, UnbuildableError
    from hydrostat.fabrication.kit_options import (
        Corner,
        KitOptions,
        Method,
        MouldKind,
        MouldOptions,
        Paper,
        PartOptions,
        PatternOptions,
    )
    from hydrostat.fabrication.moulds.mould import Mould, make_mould
    from hydrostat.fabrication.parts.motor import MOTORS, Motor
    from hydrostat.fabrication.patches.sewable import Sewing, find_sewing
    from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
    from hydrostat.fabrication.patterns.pattern import Pattern, plush_pattern
    from hydrostat.fabrication.patterns.shape import Circle, LaserLine, Layer, Panel, PatternPart, Shape
    from hydrostat.fabrication.patterns.svg_writer import pattern_svg
    from hydrostat.fabrication.refusals import find_refusals
    from hydrostat.fabrication.solids.printed import Printed

__all__ = [
    "MOTORS",
    "Check",
    "Circle",
    "Corner",
    "Demand",
    "Kit",
    "KitOptions",
    "LaserLine",
    "Layer",
    "Method",
    "Motor",
    "Mould",
    "MouldKind",
    "MouldOptions",
    "Panel",
    "Paper",
    "PartOptions",
    "Pattern",
    "PatternOptions",
    "PatternPart",
    "Printed",
    "Sewing",
    "Shape",
    "UnbuildableError",
    "build_kit",
    "export_kit",
    "find_demand",
    "find_refusals",
    "find_sewing",
    "make_mould",
    "pattern_dxf",
    "pattern_svg",
    "plush_pattern",
]

open_package(__name__)
