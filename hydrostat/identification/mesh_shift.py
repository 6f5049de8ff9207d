"""`estimate_mesh_shift`: change of fitted values that finer elements would make."""

from dataclasses import replace

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.identification.marker_predictor import MarkerPredictor
from hydrostat.identification.measurements import Measurements
from hydrostat.identification.model import IdentificationModel, Values
from hydrostat.identification.residuals import Residuals
from hydrostat.robot import ElementKind, Robot

ROWS = 8
"""Rows that are solved again with quadratic elements, at most."""


def estimate_mesh_shift(
    model: IdentificationModel, measurements: Measurements, numbers: Vector, noises: tuple[float, float]
) -> Vector:
    """Change of the coordinates of a fit if quadratic elements replace linear ones, to first order.

    The error of a mesh is the same in all rows, so that it moves values and shows in no residual. It is 0 for bodies
    that have no quadratic elements, or have them already.

    Args:
        model: robot and measurement.
        measurements: rows of the fit.
        numbers: coordinates of the fit.
        noises: standard deviation of a measured coordinate or length [m], and of a force [N].
    """
    rows = measurements.rows(choose_rows(measurements))
    try:
        refined = _refine(model.robot(model.values(numbers)))
    except InputError:
        refined = None
    if refined is None or not len(numbers):
        return np.zeros(len(numbers))

    def make_finer(values: Values) -> Robot:
        robot = _refine(model.robot(values))
        assert robot is not None
        return robot

    found = MarkerPredictor(model, rows).predict(numbers, with_jacobian=True)
    finer = MarkerPredictor(replace(model, robot=make_finer), rows).predict(numbers, with_jacobian=False)
    finer = replace(finer, jacobian=found.jacobian, force_jacobian=found.force_jacobian)
    coarse, fine = Residuals.of(found, rows), Residuals.of(finer, rows)
    moved = fine.errors - coarse.errors
    known, scales = np.isfinite(moved), np.where(coarse.is_force, noises[1], noises[0])
    jacobian = (coarse.jacobian / scales[:, None])[known]
    return -np.linalg.solve(jacobian.T @ jacobian + np.eye(len(numbers)), jacobian.T @ (moved / scales)[known])


def choose_rows(measurements: Measurements) -> np.ndarray:
    """Indices of up to eight rows, evenly spread, and of as many with hung masses, which alone may show the modulus."""
    spread = np.linspace(0, len(measurements.commands) - 1, ROWS).astype(int)
    return np.union1d(spread, np.flatnonzero(measurements.hung_masses.any(axis=1))[:ROWS])


def _refine(robot: Robot) -> Robot | None:
    """Robot with quadratic elements; None if it has them."""
    if robot.body.mesh.quadratic is not None:
        return None
    return replace(robot, body=robot.body.with_elements(ElementKind.QUADRATIC))
