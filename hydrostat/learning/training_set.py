"""`TrainingSet`: samples as networks see them, without units."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError
from hydrostat.learning.learned_model import LearnedModel, span_of
from hydrostat.learning.samples import Samples


@dataclass(frozen=True, kw_only=True, eq=False)
class TrainingSet:
    """Inputs scaled to -1 to 1, and normalized outputs: markers first, with one scale for each quantity.

    Attributes:
        low: least contraction of each winch [m].
        high: largest contraction of each winch [m].
        middle: mean of each output before normalization.
        unit: scale of each output: one length for all marker coordinates, one force for all tensions.
        inputs: inputs of the networks.
        outputs: marker coordinates, then cable tensions.
        jacobians: derivatives of the marker coordinates, then of the tensions if the samples have them.
        coordinates: number of outputs that are marker coordinates.
        linear: best linear map from inputs to outputs; the last row is the constant.
    """

    low: Vector
    high: Vector
    middle: Vector
    unit: Vector
    inputs: Float[np.ndarray, "samples winches"]
    outputs: Float[np.ndarray, "samples outputs"]
    jacobians: Float[np.ndarray, "samples differentiated winches"]
    coordinates: int
    linear: Float[np.ndarray, "rows outputs"]

    @staticmethod
    def of_samples(samples: Samples, like: LearnedModel | None = None) -> "TrainingSet":
        """Return the training set of samples; further training of a model keeps the scales of that model.

        Raises:
            InputError: fewer than `MIN_SAMPLES`, or than `MIN_CORRECTION_SAMPLES` for further training of a model.
        """
        count, least = len(samples), MIN_SAMPLES if like is None else MIN_CORRECTION_SAMPLES
        if count < least:
            raise InputError(f"there are {count} samples; learning takes {least} or more")
        low, high = samples.limits
        span = span_of(low, high)
        inputs = 2.0 * (samples.contractions - low) / span - 1.0
        markers = samples.markers.reshape(count, -1)
        found = np.hstack([markers, samples.tensions])
        middle, coordinates = found.mean(axis=0), markers.shape[1]
        length, force = (_rms_scale(part) for part in np.split(found - middle, [coordinates], axis=1))
        unit = np.r_[np.full(coordinates, length), np.full(found.shape[1] - coordinates, force)]
        if like is not None:
            middle, unit = like.middle, like.unit
        found_jacobians = samples.jacobians.reshape(count, coordinates, -1)
        if samples.tension_jacobians is not None:
            found_jacobians = np.hstack([found_jacobians, samples.tension_jacobians])
        derivatives = found_jacobians * (0.5 * span) / unit[: found_jacobians.shape[1], None]
        outputs = (found - middle) / unit
        return TrainingSet(
            low=low,
            high=high,
            middle=middle,
            unit=unit,
            inputs=inputs,
            outputs=outputs,
            jacobians=derivatives,
            coordinates=coordinates,
            linear=linear_map(inputs, outputs),
        )


def linear_map(inputs: np.ndarray, outputs: np.ndarray) -> np.ndarray:
    """Fit a linear map by ridge regression; its last row is the constant."""
    rows = np.hstack([inputs, np.ones((len(inputs), 1))])
    ridge = 1e-3
    return np.linalg.solve(rows.T @ rows + ridge * len(rows) * np.eye(rows.shape[1]), rows.T @ outputs)


def _rms_scale(part: np.ndarray) -> float:
    """Return the root mean square; 1 if all values are 0."""
    return float(np.sqrt(np.mean(np.square(part)))) if np.any(part) else 1.0


MIN_SAMPLES = 20
"""Minimum number of samples for training."""

MIN_CORRECTION_SAMPLES = 5
"""Minimum number of samples for correcting a model."""
