"""`Ridge`: regression with a penalty, with the errors that it would make on poses left out."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError

Table = Float[np.ndarray, "rows _"]
"""Numbers in rows; two in one signature have as many."""
PENALTIES = tuple(10.0**power for power in range(-8, 3))
"""Candidate ridge penalties, as multiples of the mean square of the inputs."""


@dataclass(frozen=True, eq=False)
class Ridge:
    """A straight map from inputs to outputs, centered.

    Attributes:
        center: mean of the inputs.
        level: mean of the outputs.
        weights: (inputs, outputs).
        penalty: on the squares of the weights.
    """

    center: Vector
    level: Vector
    weights: Table
    penalty: float

    def __call__(self, inputs: Float[np.ndarray, "... inputs"]) -> Float[np.ndarray, "... outputs"]:
        """Outputs of inputs, one row or many."""
        return self.level + (inputs - self.center) @ self.weights


def fit_ridge(
    inputs: Table,
    outputs: Table,
    groups: Sequence[int],
    *,
    penalty: float | None = None,
) -> Ridge:
    """Fit outputs to inputs.

    Args:
        inputs: (rows, inputs).
        outputs: (rows, outputs).
        groups: pose of each row; a penalty that is left out is that with the least error on poses left out.
        penalty: on the squares of the weights.

    Raises:
        InputError: there are fewer than two poses.
    """
    if len(set(groups)) < 2:
        raise InputError(f"{len(set(groups))} poses are too few to learn of; mimic two at least")
    if penalty is None:
        size = max(float(np.mean((inputs - inputs.mean(0)) ** 2)), 1e-9) * len(inputs)
        tried = {size * each: left_out_error(inputs, outputs, groups, size * each) for each in PENALTIES}
        penalty = min(tried, key=lambda each: tried[each])
    center, level = inputs.mean(0), outputs.mean(0)
    centered = inputs - center
    weights = np.linalg.solve(centered.T @ centered + penalty * np.eye(inputs.shape[1]), centered.T @ (outputs - level))
    return Ridge(center, level, weights, penalty)


def left_out_error(inputs: Table, outputs: Table, groups: Sequence[int], penalty: float) -> float:
    """Root mean square error on each pose by what the others teach, without fitting again.

    For a linear fit the error of rows left out together is (I - H)^-1 e, with their part H of its projection and their
    errors e in it.
    """
    table = np.column_stack([np.ones(len(inputs)), inputs - inputs.mean(0)])
    costs = np.full(table.shape[1], penalty)
    costs[0] = 0.0
    inverse = np.linalg.inv(table.T @ table + np.diag(costs))
    errors = outputs - table @ (inverse @ (table.T @ outputs))
    total, which = 0.0, np.asarray(groups)
    for group in set(groups):
        rows = np.flatnonzero(which == group)
        part = table[rows] @ inverse @ table[rows].T
        total += float(np.sum(np.linalg.solve(np.eye(len(rows)) - part, errors[rows]) ** 2))
    return float(np.sqrt(total / outputs.size))


def folded_error(
    inputs: Table,
    outputs: Table,
    groups: Sequence[int],
    penalty: float,
    *,
    folds: int = 5,
) -> float:
    """Root mean square error of k-fold cross-validation; poses are never torn apart, folds always the same."""
    which = np.asarray(groups)
    poses = np.random.default_rng(0).permutation(np.unique(which))
    total = 0.0
    for fold in np.array_split(poses, min(folds, len(poses))):
        out = np.isin(which, fold)
        known = fit_ridge(inputs[~out], outputs[~out], which[~out].tolist(), penalty=penalty)
        total += float(np.sum((known(inputs[out]) - outputs[out]) ** 2))
    return float(np.sqrt(total / outputs.size))
