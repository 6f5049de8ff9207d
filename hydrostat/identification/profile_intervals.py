"""`profile_intervals`: intervals of fitted values by profile likelihood, where the linearized ones are doubtful."""

from dataclasses import replace
from typing import Any, cast

import numpy as np
from scipy.optimize import least_squares

from hydrostat.arrays import Vector
from hydrostat.identification.fit import RULES, FittedModel, MarkerFit
from hydrostat.identification.measurements import Measurements
from hydrostat.progress import Progress, no_progress

LEVEL = 1.96
"""Root of the deviance at the ends of an interval: 95 % of a normal distribution."""

DOUBTFUL = 0.15
"""Relative difference of the root of the deviance at a linearized end from `LEVEL` from which on it is profiled."""

CLOSE = 0.03
"""The same at an end that was found."""

STEPS = 6
"""Most ends tried on each side."""

EVALUATIONS = 8
"""Most evaluations of the model for each of them."""


def profile_intervals(
    fitted: FittedModel, measurements: Measurements, *, progress: Progress = no_progress
) -> FittedModel:
    """Return the fit with ends of intervals by profile likelihood, where linearized ones are doubtful.

    At an end of an interval the sum of squares, minimized over all other parameters, is 1.96^2 above its minimum, or
    the parameter is at its limit. Errors of the model that are alike in all rows count as in
    `FittedModel.interval_covariance`, which is its curvature. A linearized end within the limits stays if the root of
    the sum of squares there is 1.96 to 15 %.

    Args:
        fitted: fit of these measurements.
        measurements: rows of the fit.
        progress: callback for progress, after each parameter.
    """
    deviance = _Deviance(fitted, measurements)
    numbers, deviations = fitted.numbers, np.sqrt(np.diag(fitted.interval_covariance))
    ends = np.stack([numbers - LEVEL * deviations, numbers + LEVEL * deviations])
    for index in range(len(numbers)):
        for side, sign in enumerate((-1.0, 1.0)):
            ends[side, index] = deviance.end(index, sign * deviations[index])
        progress("intervals by profile likelihood", index + 1, len(numbers))
    return replace(fitted, ends=ends)


class _Deviance:
    """Twice the negative logarithm of the posterior density, less its minimum, by the coordinates of a fit."""

    def __init__(self, fitted: FittedModel, measurements: Measurements) -> None:
        self._fitted, self._fit = fitted, MarkerFit(fitted.model, measurements, fitted.noise)
        self._fit.force_noise = fitted.force_noise
        self._covariance = fitted.interval_covariance
        self._limits = np.array([parameter.limits for parameter in fitted.model.parameters]).T
        pull = fitted.numbers / np.sqrt(
            1.0 + (fitted.numbers / RULES.robust) ** 2
        )  # gradient of the loss by the guesses
        self._middle = fitted.numbers - pull / fitted.spread  # of the guesses: the fit stays the minimum
        self._least = 0.0
        self._least = self._value(fitted.numbers)

    def end(self, index: int, deviation: float) -> float:
        """End of the interval of a parameter in the direction of a standard deviation."""
        numbers = self._fitted.numbers
        limit = self._limits[int(deviation > 0), index]
        start, low, high, at = numbers, 0.0, np.inf, LEVEL  # distances in standard deviations
        for step in range(STEPS):
            to = numbers[index] + at * deviation
            is_limit = abs(to - numbers[index]) >= abs(limit - numbers[index])
            start = numbers + self._covariance[:, index] / self._covariance[index, index] * (to - numbers[index])
            start[index] = limit if is_limit else to
            start = np.clip(start, *self._limits)
            found = np.sqrt(self._minimum(start, index))
            if is_limit and found <= LEVEL:
                return float(limit)
            if abs(found - LEVEL) < LEVEL * (CLOSE if step else DOUBTFUL):
                break
            low, high = (at, high) if found < LEVEL else (low, at)
            guess = at * np.clip(LEVEL / max(found, 1e-9), 0.4, 2.5)
            at = guess if low < guess < high else 0.5 * (low + high)
        return float(start[index])

    def _minimum(self, start: Vector, index: int) -> float:
        """Least deviance with one parameter held."""
        free = np.arange(len(start)) != index
        if not free.any():
            return self._value(start)

        def whole(others: Vector) -> Vector:
            numbers = start.copy()
            numbers[free] = others
            return numbers

        solved = least_squares(
            lambda others: self._residuals(whole(others)),
            start[free],
            jac=cast("Any", lambda others: self._jacobian(whole(others))[:, free]),
            bounds=self._limits[:, free],
            loss=cast("Any", self._loss),
            ftol=1e-3,
            xtol=1e-3,
            max_nfev=EVALUATIONS,
        )
        return max(2 * float(solved.cost) - self._least, 0.0)

    def _value(self, numbers: Vector) -> float:
        return max(float(self._loss(self._residuals(numbers) ** 2)[0].sum()) - self._least, 0.0)

    def _residuals(self, numbers: Vector) -> Vector:
        residuals = self._fit.residuals(numbers)
        residuals[: -len(numbers)] /= np.sqrt(self._fitted.spread)
        residuals[-len(numbers) :] -= self._middle
        return residuals

    def _jacobian(self, numbers: Vector) -> np.ndarray:
        jacobian = self._fit.jacobian(numbers)
        jacobian[: -len(numbers)] /= np.sqrt(self._fitted.spread)
        return jacobian

    def _loss(self, squares: Vector) -> np.ndarray:
        """Loss of the fit for what was measured, squares for the guesses, with two derivatives."""
        scale = np.full(len(squares), RULES.robust**2 / self._fitted.spread)
        scale[-len(self._middle) :] = np.inf
        root = np.sqrt(1.0 + squares / scale)
        robust = np.isfinite(scale)
        value = np.where(robust, 2 * np.where(robust, scale, 0.0) * (root - 1.0), squares)
        return np.array([value, 1.0 / root, -0.5 / (scale * root**3)])
