"""`fit_contraction_map`: a map of contractions for the errors that a fitted model leaves."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.identification.contraction_map import ContractionMap, cable_lengths, features
from hydrostat.identification.fit import FittedModel
from hydrostat.identification.marker_predictor import MarkerPredictor
from hydrostat.identification.measurements import Measurements, rms
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation

GAINED = 0.9
"""Share of the held-out error that must remain at most for a correction to be kept."""

FOLDS = 5
"""Parts of the rows, each of which is held out once."""

MIN_ROWS = 10
"""Rows from which on a correction is fitted."""

PENALTIES = tuple(10.0**power for power in range(-4, 3))
"""Penalties of the weights to choose from, as multiples of the mean square of the inputs."""


def fit_contraction_map(fitted: FittedModel, robot: Robot, measurements: Measurements) -> ContractionMap | None:
    """Fit a map to the errors that a fitted model leaves, by its exact Jacobian (ridge regression).

    The map is kept only if it predicts rows that it did not see with at most 90 % of the model's error. In each fold
    the penalty is chosen without the rows that are held out.

    Args:
        fitted: fitted model.
        robot: fitted robot.
        measurements: rows of commands and places.

    Returns:
        The map; None with fewer than ten rows, if it does not win, or if it cannot be inverted.
    """
    travel = np.array([winch.travel for winch in robot.winches])
    if len(measurements.commands) < MIN_ROWS or not len(travel) or not (travel > 0).all():
        return None
    values = fitted.values
    rest = fitted.model.contractions(values, np.zeros((1, len(travel))))
    commands = fitted.model.contractions(values, measurements.commands) - rest
    rows = _error_rows(fitted, measurements, features(commands / travel), travel)
    known = [row for row, (errors, _) in enumerate(rows) if len(errors)]
    if len(known) < MIN_ROWS:
        return None
    before, after = [], []
    for fold in range(FOLDS):
        seen = [row for place, row in enumerate(known) if place % FOLDS != fold]
        weights = _fit(rows, seen, _choose_penalty(rows, seen))
        for row in (row for place, row in enumerate(known) if place % FOLDS == fold):
            errors, jacobian = rows[row]
            before.append(errors)
            after.append(errors + jacobian @ weights)
    dim = measurements.places.shape[2]
    lengths = [rms(np.linalg.norm(np.concatenate(each).reshape(-1, dim), axis=1)) for each in (before, after)]
    if lengths[1] > GAINED * lengths[0]:
        return None
    weights = _fit(rows, known, _choose_penalty(rows, known)).reshape(-1, len(travel))
    names = tuple(winch.name for winch in robot.winches)
    found = ContractionMap(
        winches=names,
        travel=travel,
        lengths=cable_lengths(robot),
        weights=weights,
        before=lengths[0],
        after=lengths[1],
    )
    return found if found.is_invertible else None


Rows = list[tuple[np.ndarray, np.ndarray]]
"""Errors of the measured markers of each row [m], and their Jacobian by all weights."""


def _error_rows(fitted: FittedModel, measurements: Measurements, inputs: np.ndarray, travel: Vector) -> Rows:
    """Predicted less measured coordinates, with the Jacobian of the markers by the weights of a map."""
    predictor = MarkerPredictor(fitted.model, measurements)
    places = predictor.predict(fitted.numbers, with_jacobian=False).places
    step, rows = 1e-6, Rows()
    for row, pose in enumerate(predictor.poses):
        whole = np.isfinite(measurements.places[row]).all(axis=1)
        if pose is None or not whole.any() or not np.isfinite(places[row]).all():
            rows.append((np.zeros(0), np.zeros((0, inputs.shape[1] * len(travel)))))
            continue
        simulation = Simulation(pose.robot)
        order = [[marker.name for marker in pose.robot.markers].index(name) for name in measurements.markers]
        jacobian = simulation.marker_jacobian(pose)[order]
        at = np.array([pose.markers[name] for name in measurements.markers])
        turned = np.stack(
            [
                (fitted.model.places(fitted.values, at + step * column) - fitted.model.places(fitted.values, at)) / step
                for column in np.moveaxis(jacobian, 2, 0)
            ],
            axis=2,
        )
        by_weights = np.einsum("mdw,f->mdfw", turned * travel, inputs[row])[whole]
        errors = (places[row] - measurements.places[row])[whole]
        rows.append((errors.ravel(), by_weights.reshape(errors.size, -1)))
    return rows


def _fit(rows: Rows, chosen: list[int], penalty: float) -> Vector:
    """Weights with the least squares of errors and a penalty."""
    errors, jacobian = (np.concatenate([rows[row][part] for row in chosen]) for part in (0, 1))
    size = penalty * float((jacobian**2).sum()) / jacobian.shape[1]
    return -np.linalg.solve(jacobian.T @ jacobian + max(size, 1e-30) * np.eye(jacobian.shape[1]), jacobian.T @ errors)


def _choose_penalty(rows: Rows, chosen: list[int]) -> float:
    """Penalty with the least error of rows that are left out in turn."""

    def left_out(penalty: float) -> float:
        total = 0.0
        for fold in range(FOLDS):
            weights = _fit(rows, [row for place, row in enumerate(chosen) if place % FOLDS != fold], penalty)
            for row in chosen[fold::FOLDS]:
                errors, jacobian = rows[row]
                total += float(((errors + jacobian @ weights) ** 2).sum())
        return total

    return min(PENALTIES, key=left_out)
