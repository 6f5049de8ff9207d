"""Identification: parameters of a robot from measurements of it."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.identification.contraction_map import ContractionMap
    from hydrostat.identification.find_faults import find_slip, find_swaps, is_mirrored
    from hydrostat.identification.fit import FittedModel, fit_model
    from hydrostat.identification.identified_robot import IdentifiedRobot, identified_tolerances, identify
    from hydrostat.identification.kinds import named_model
    from hydrostat.identification.marker_predictor import MarkerPredictor
    from hydrostat.identification.measurements import Measurements, rms
    from hydrostat.identification.model import IdentificationModel, Parameter
    from hydrostat.identification.profile_intervals import profile_intervals
    from hydrostat.identification.read import read_measurements
    from hydrostat.identification.suggest_measurements import suggest_measurements

__all__ = [
    "ContractionMap",
    "FittedModel",
    "IdentificationModel",
    "IdentifiedRobot",
    "MarkerPredictor",
    "Measurements",
    "Parameter",
    "find_slip",
    "find_swaps",
    "fit_model",
    "identified_tolerances",
    "identify",
    "is_mirrored",
    "named_model",
    "profile_intervals",
    "read_measurements",
    "rms",
    "suggest_measurements",
]

open_package(__name__)
