"""Build kits of robots: patterns, printed parts, molds, lists and pages. Lengths are in millimeters."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.fabrication.board_kind import BOARDS, board_for, check_board
    from hydrostat.fabrication.cable_work import CableWork
    from hydrostat.fabrication.demand import Demand, shaft_torques
    from hydrostat.fabrication.kit import Check, Kit, UnbuildableError
    from hydrostat.fabrication.kit_build import build_kit, summarize_kit, write_kit
    from hydrostat.fabrication.kit_options import (
        MATERIAL_FIX,
        OVER_BUDGET,
        STUFFINGS,
        KitOptions,
        Method,
        MoldKind,
        MoldOptions,
        Paper,
        PartOptions,
        PatternOptions,
        StopperKind,
    )
    from hydrostat.fabrication.lists.motors import check_motor_and_board
    from hydrostat.fabrication.lists.stitching import depth_table
    from hydrostat.fabrication.motor_choice import (
        drive_price,
        find_motor,
        find_turn_problems,
        fit_motor,
        motor_offers,
        motors_price,
    )
    from hydrostat.fabrication.moulds.mould import make_mold
    from hydrostat.fabrication.moulds.pocket_room import PocketRoom
    from hydrostat.fabrication.parts.motor import ALL_MOTORS, AUTO_MOTORS, MOTORS, Motor
    from hydrostat.fabrication.parts.places import COMPRESSION_SHARE, OVERLAP_TOLERANCE, UnitBox, seam_of
    from hydrostat.fabrication.parts.winch_unit import unit_room
    from hydrostat.fabrication.patches.skin_mesh import skin_of_surface
    from hydrostat.fabrication.patches.space_pattern import Sewing, space_pattern
    from hydrostat.fabrication.patterns.pattern import plush_pattern
    from hydrostat.fabrication.refusals import find_material_problems, find_refusals
    from hydrostat.fabrication.sheets.tiles import PAPERS
    from hydrostat.fabrication.solids.construct import Cuboid, sides_text
    from hydrostat.fabrication.weak_lines import find_weak_lines
    from hydrostat.fabrication.winch_marks import winch_marks_of

__all__ = [
    "ALL_MOTORS",
    "AUTO_MOTORS",
    "BOARDS",
    "COMPRESSION_SHARE",
    "MATERIAL_FIX",
    "MOTORS",
    "OVERLAP_TOLERANCE",
    "OVER_BUDGET",
    "PAPERS",
    "STUFFINGS",
    "CableWork",
    "Check",
    "Cuboid",
    "Demand",
    "Kit",
    "KitOptions",
    "Method",
    "MoldKind",
    "MoldOptions",
    "Motor",
    "Paper",
    "PartOptions",
    "PatternOptions",
    "PocketRoom",
    "Sewing",
    "StopperKind",
    "UnbuildableError",
    "UnitBox",
    "board_for",
    "build_kit",
    "check_board",
    "check_motor_and_board",
    "depth_table",
    "drive_price",
    "find_material_problems",
    "find_motor",
    "find_refusals",
    "find_turn_problems",
    "find_weak_lines",
    "fit_motor",
    "make_mold",
    "motor_offers",
    "motors_price",
    "plush_pattern",
    "seam_of",
    "shaft_torques",
    "sides_text",
    "skin_of_surface",
    "space_pattern",
    "summarize_kit",
    "unit_room",
    "winch_marks_of",
    "write_kit",
]

open_package(__name__)
