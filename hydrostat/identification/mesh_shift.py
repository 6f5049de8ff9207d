"""`estimate_mesh_shift`: change of fitted values that finer elements would make."""

from dataclasses import replace

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.identification.marker_predictor import MarkerPredictor
from hydrostat.identification.measurements import Measurements
from hydrostat.identification.model import IdentificationModel, Values
from hydrostat.robot import ElementKind, Robot

ROWS = 8
"""Rows that are solved again with quadratic elements, at most."""


def estimate_mesh_shift(
    model: IdentificationModel, measurements: Measurements, numbers: Vector, noise: float
) -> Vector:
    """Change of the coordinates of a fit if quadratic elements replace linear ones, to first order.

    The error of a mesh is the same in all rows, so that it moves values and shows in no residual. It is 0 for bodies
    that have no quadratic elements, or have them already.

    Args:
        model: robot and measurement.
        measurements: rows of the fit.
        numbers: coordinates of the fit.
        noise: standard deviation of a measured coordinate [m].
    """
    chosen = np.unique(np.linspace(0, len(measurements.commands) - 1, ROWS).astype(int))
    rows = measurements.rows(chosen)
    try:
        finer = _refine(model.robot(model.values(numbers)))
    except InputError:
        finer = None
    if finer is None or not len(numbers):
        return np.zeros(len(numbers))

    def make_finer(values: Values) -> Robot:
        robot = _refine(model.robot(values))
        assert robot is not None
        return robot

    coarse = MarkerPredictor(model, rows).predict(numbers, slopes=True)
    fine = MarkerPredictor(replace(model, robot=make_finer), rows).predict(numbers, slopes=False)
    assert coarse.jacobian is not None
    moved = fine.places - coarse.places
    known = np.isfinite(moved) & np.isfinite(rows.places)
    slopes = coarse.jacobian[known] / noise
    return -np.linalg.solve(slopes.T @ slopes + np.eye(len(numbers)), slopes.T @ (moved[known] / noise))


def _refine(robot: Robot) -> Robot | None:
    """Robot with quadratic elements; None if it has them."""
    if robot.body.mesh.quadratic is not None:
        return None
    return replace(robot, body=robot.body.with_elements(ElementKind.QUADRATIC))
