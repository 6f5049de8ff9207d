"""Automatic cable routing: winches and cables that reach given poses."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.design.build_cost import BuildCost, front
    from hydrostat.design.buildable import violations
    from hydrostat.design.built_error import built_errors, expected_error
    from hydrostat.design.cable_design import design_cables, find_network
    from hydrostat.design.cable_sides import assign_cable_sides
    from hydrostat.design.constraints import Constraints, Range
    from hydrostat.design.constraints_file import cable_name, read_constraints, read_uncertainty
    from hydrostat.design.corrected_error import corrected_errors
    from hydrostat.design.drawn_shapes import find_pinned_drawings
    from hydrostat.design.fewer_cables import PosedNetwork, drop_cables
    from hydrostat.design.finding import Diagnostic, Severity, places_in
    from hydrostat.design.first_cable import draw_first_cable, place_first_winch
    from hydrostat.design.lifts import Lift, find_lifts
    from hydrostat.design.marker_estimator import MarkerEstimator
    from hydrostat.design.mirror_axis import find_mirror_axis, find_unmirrored_poses
    from hydrostat.design.muscles.activation import Activation, FibreKind, activate, edge_fibres
    from hydrostat.design.muscles.free_posing import FreePosing
    from hydrostat.design.network import (
        Alternative,
        Certificate,
        DesignStage,
        Network,
        RouteTrace,
        TreeTrace,
        on_front,
        rms_error,
        size_of,
    )
    from hydrostat.design.polyline import nearest_shares, turns
    from hydrostat.design.region import Region
    from hydrostat.design.request import DesignMethod, DesignRequest, RouteOptions, TreeOptions, TreeSettings
    from hydrostat.design.robot_review import review_robot
    from hydrostat.design.routes.finalists import kit_fits
    from hydrostat.design.routes.layout import CableRoute, Layout, WinchSite
    from hydrostat.design.routes.price import PricedPath
    from hydrostat.design.routes.propose import route_along
    from hydrostat.design.routes.quick_search import QuickSearch, propose_routes
    from hydrostat.design.routes.route_graph import RouteGraph
    from hydrostat.design.routes.search_record import SearchRecord
    from hydrostat.design.score_card import corrected_error, score_card
    from hydrostat.design.stuffed_motion import describe_uncounted_motion, find_stuffed_motion
    from hydrostat.design.stuffed_results import StuffedResults
    from hydrostat.design.trees.design_trees import propose_trees
    from hydrostat.design.uncertainty import BuildTolerances
    from hydrostat.design.winch_front import FrontRow, winch_front
    from hydrostat.design.winch_room import find_no_room
    from hydrostat.design.zone import Zone

__all__ = [
    "Activation",
    "Alternative",
    "BuildCost",
    "BuildTolerances",
    "CableRoute",
    "Certificate",
    "Constraints",
    "DesignMethod",
    "DesignRequest",
    "DesignStage",
    "Diagnostic",
    "FibreKind",
    "FreePosing",
    "FrontRow",
    "Layout",
    "Lift",
    "MarkerEstimator",
    "Network",
    "PosedNetwork",
    "PricedPath",
    "QuickSearch",
    "Range",
    "Region",
    "RouteGraph",
    "RouteOptions",
    "RouteTrace",
    "SearchRecord",
    "Severity",
    "StuffedResults",
    "TreeOptions",
    "TreeSettings",
    "TreeTrace",
    "WinchSite",
    "Zone",
    "activate",
    "assign_cable_sides",
    "built_errors",
    "cable_name",
    "corrected_error",
    "corrected_errors",
    "describe_uncounted_motion",
    "design_cables",
    "draw_first_cable",
    "drop_cables",
    "edge_fibres",
    "expected_error",
    "find_lifts",
    "find_mirror_axis",
    "find_network",
    "find_no_room",
    "find_pinned_drawings",
    "find_stuffed_motion",
    "find_unmirrored_poses",
    "front",
    "kit_fits",
    "nearest_shares",
    "on_front",
    "place_first_winch",
    "places_in",
    "propose_routes",
    "propose_trees",
    "read_constraints",
    "read_uncertainty",
    "review_robot",
    "rms_error",
    "route_along",
    "score_card",
    "size_of",
    "turns",
    "violations",
    "winch_front",
]

open_package(__name__)
