"""Which winches and cables reach given poses."""

from hydrostat.design.activation import activate
from hydrostat.design.design_cables import design_cables
from hydrostat.design.fibres import Fibres, edge_fibres, element_fibres
from hydrostat.design.network import Activation, Network
from hydrostat.design.options import DesignOptions, FibreKind
from hydrostat.design.score_card import rest_error, score_card

__all__ = [
    "Activation",
    "DesignOptions",
    "FibreKind",
    "Fibres",
    "Network",
    "activate",
    "design_cables",
    "edge_fibres",
    "element_fibres",
    "rest_error",
    "score_card",
]
