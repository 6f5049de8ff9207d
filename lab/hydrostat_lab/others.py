"""Baselines on the same samples: a constant, nearest neighbors, ridge regression."""

from collections.abc import Callable, Mapping

import numpy as np
from scipy.optimize import lsq_linear

from hydrostat.arrays import Float, Vector
from hydrostat.learning import Samples, linear_map
from hydrostat_lab.thesis_network import Answers, Goals

Method = Callable[[Samples, Goals], Answers]


def constant(train: Samples, goals: Goals) -> Answers:
    """The mean contractions, whatever is asked."""
    return np.tile(train.contractions.mean(axis=0), (len(goals), 1))


def nearest(train: Samples, goals: Goals) -> Answers:
    """Contractions of the sample whose markers are nearest (R88)."""
    return train.contractions[_nearest(train, goals)]


def nearest_with_slopes(train: Samples, goals: Goals) -> Answers:
    """The same, and one bounded Gauss-Newton step by the sample's own slopes."""
    low, high = train.limits
    rows = []
    for goal, place in zip(goals, _nearest(train, goals), strict=True):
        begun, markers = train.contractions[place], train.markers[place].ravel()
        slopes = train.jacobians[place].reshape(len(goal), -1)
        rows.append(begun + _solve_bounded(slopes, markers - goal, low - begun, high - begun))
    return np.array(rows)


def ridge(train: Samples, goals: Goals) -> Answers:
    """Ridge regression from markers to contractions (R88)."""
    size = train.facts["size"]
    linear = linear_map(train.markers.reshape(len(train), -1) / size, train.contractions)
    return np.clip(np.hstack([goals / size, np.ones((len(goals), 1))]) @ linear, *train.limits)


def kernel_ridge(train: Samples, goals: Goals) -> Answers:
    """Kernel ridge regression from markers to contractions, with a Gaussian kernel.

    Width and weight are those, of a few, that do best on a tenth of the samples. It learns from `_MOST` samples at
    most, as it solves for all of them at once.
    """
    known = train if len(train) <= _MOST else train.first(_MOST)
    low, high = train.limits
    places = known.markers.reshape(len(known), -1)
    actions, middle = known.contractions, known.contractions.mean(axis=0)
    squares = _squares(places, places)
    usual = float(np.median(squares[squares > 0])) if (squares > 0).any() else 1.0
    held = np.arange(len(known)) % 10 == 9 if len(known) >= 10 else np.zeros(len(known), dtype=bool)
    best, least = (1.0, 1e-6), np.inf
    for width in (0.3, 1.0, 3.0, 10.0) if held.any() else ():
        kernel = np.exp(-squares / (width * usual))
        values, vectors = np.linalg.eigh(kernel[np.ix_(~held, ~held)])
        shares = vectors.T @ (actions[~held] - middle)
        for weight in (1e-10, 1e-8, 1e-6, 1e-4, 1e-2):
            solved = vectors @ (shares / (np.maximum(values, 0.0) + weight * len(values))[:, None])
            missed = float(np.square(kernel[np.ix_(held, ~held)] @ solved + middle - actions[held]).mean())
            if missed < least:
                best, least = (width, weight), missed
    width, weight = best
    kernel = np.exp(-squares / (width * usual)) + weight * len(known) * np.eye(len(known))
    found = np.exp(-_squares(goals, places) / (width * usual)) @ np.linalg.solve(kernel, actions - middle) + middle
    return np.clip(found, low, high)


def _squares(some: Goals, others: Goals) -> Float[np.ndarray, "some others"]:
    """Squared distances between rows."""
    return np.maximum(np.square(some).sum(1)[:, None] + np.square(others).sum(1) - 2.0 * some @ others.T, 0.0)


def _solve_bounded(slopes: np.ndarray, residual: Vector, low: Vector, high: Vector) -> Vector:
    """The change within limits that best undoes what is missed; the shortest where several do."""
    low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
    some = _SHORT * np.sqrt(np.square(slopes).sum(axis=0).max(initial=0.0))
    rows = np.vstack([slopes, some * np.eye(len(low))])
    found = lsq_linear(rows, np.r_[-residual, np.zeros(len(low))], bounds=(low - _ROOM, high + _ROOM))
    return np.clip(found.x, low, high)


def _nearest(train: Samples, goals: Goals) -> np.ndarray:
    known = train.markers.reshape(len(train), -1)
    return np.array([np.square(known - goal).sum(axis=1).argmin() for goal in goals])


OTHERS: Mapping[str, Method] = {
    "constant": constant,
    "1-NN": nearest,
    "1-NN, Jacobian": nearest_with_slopes,
    "ridge": ridge,
    "kernel ridge": kernel_ridge,
}
"""Ways from samples and goals to contractions, by their names in tables."""

_SHORT = 1e-3
"""Weight of a change beside its effect, as a share of the steepest slope."""

_ROOM = 1e-12
"""Bounds are moved apart by so much [m], as an empty range is refused."""

_MOST = 4000
"""Samples that kernel ridge regression learns from at most: their kernel is a full matrix."""
