"""`estimate_build_variance`: uncertainty of fitted values by numbers of the robot that are not fitted."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.identification.marker_predictor import MarkerPredictor
from hydrostat.identification.measurements import Measurements
from hydrostat.identification.mesh_shift import choose_rows
from hydrostat.identification.model import IdentificationModel
from hydrostat.identification.residuals import Residuals

DEVIATIONS = {"routes": 1e-3, "poisson": 0.1}
"""Standard deviations of what is seldom fitted: coordinates of the points of cables [m], Poisson's ratio."""


def estimate_build_variance(
    model: IdentificationModel, measurements: Measurements, numbers: Vector, noises: tuple[float, float]
) -> Vector:
    """Variance of each coordinate of a fit if points of cables and Poisson's ratio are unknown as well.

    They are further parameters of the linearized fit, over which the values are marginalized.

    Args:
        model: robot and measurement.
        measurements: rows of the fit.
        numbers: coordinates of the fit.
        noises: standard deviation of a measured coordinate or length [m], and of a force [N].
    """
    chosen = choose_rows(measurements)
    rows = measurements.rows(chosen)
    residuals = Residuals.of(
        MarkerPredictor(model, rows, deviations=DEVIATIONS).predict(numbers, with_jacobian=True), rows
    )
    jacobian = residuals.jacobian / np.where(residuals.is_force, noises[1], noises[0])[:, None]
    information = len(measurements.commands) / len(chosen) * jacobian.T @ jacobian
    return np.diag(np.linalg.inv(information + np.eye(len(information))))[: len(numbers)]
