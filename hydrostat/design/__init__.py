"""Which winches and cables reach given poses."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.design.built_error import BuiltErrors, built_errors, expected_error
    from hydrostat.design.constraints import Constraints
    from hydrostat.design.craft import Craft, SewingTimes, craft_of
    from hydrostat.design.design_cables import design_cables, find_network
    from hydrostat.design.faced import faced
    from hydrostat.design.filled_reach import FilledReach
    from hydrostat.design.finding import Finding, Weight
    from hydrostat.design.judgement import judgement_of
    from hydrostat.design.muscles.activation import Activation, FibreKind, Fibres, activate, edge_fibres, element_fibres
    from hydrostat.design.network import Alternative, Certificate, DesignStage, Network, RouteTrace, TreeTrace
    from hydrostat.design.request import AUTO, DesignMethod, DesignRequest, RouteOptions, TreeOptions
    from hydrostat.design.score_card import rest_error, score_card
    from hydrostat.design.uncertainty import Uncertainty
    from hydrostat.design.zone import Zone

__all__ = [
    "AUTO",
    "Activation",
    "Alternative",
    "BuiltErrors",
    "Certificate",
    "Constraints",
    "Craft",
    "DesignMethod",
    "DesignRequest",
    "DesignStage",
    "FibreKind",
    "Fibres",
    "FilledReach",
    "Finding",
    "Network",
    "RouteOptions",
    "RouteTrace",
    "SewingTimes",
    "TreeOptions",
    "TreeTrace",
    "Uncertainty",
    "Weight",
    "Zone",
    "activate",
    "built_errors",
    "craft_of",
    "design_cables",
    "edge_fibres",
    "element_fibres",
    "expected_error",
    "faced",
    "find_network",
    "judgement_of",
    "rest_error",
    "score_card",
]

open_package(__name__)
