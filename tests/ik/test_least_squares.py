"""Least squares under linear limits. Oracles: scipy's bounded solver, the conditions of Karush, Kuhn and Tucker."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear, nnls

from hydrostat.ik.search.linear_model import least_squares


def problem(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A matrix of full rank, though some columns hardly count, as those of contractions that move little."""
    draw = np.random.default_rng(seed)
    size = int(draw.integers(1, 11))
    matrix = draw.normal(size=(15, size)) * 10.0 ** draw.uniform(-4, 0, size)
    matrix = np.vstack([matrix, 1e-5 * np.eye(size)])
    return matrix, np.concatenate([draw.normal(size=15), np.zeros(size)])


@pytest.mark.parametrize("seed", range(40))
def test_bounds(seed: int) -> None:
    """Against scipy's bounded-variable least squares."""
    matrix, right = problem(seed)
    draw = np.random.default_rng(1000 + seed)
    size = matrix.shape[1]
    low, high = -draw.uniform(0, 1, size), draw.uniform(0, 1, size)
    eye = np.eye(size)
    found = least_squares(matrix, right, np.vstack([eye, -eye]), np.concatenate([high, -low]))
    expected = lsq_linear(matrix, right, (low, high), method="bvls", tol=1e-14)
    assert found is not None
    assert (found <= high + 1e-9).all()
    assert (found >= low - 1e-9).all()
    assert np.sum((matrix @ found - right) ** 2) <= 2 * expected.cost * (1 + 1e-9)


@pytest.mark.parametrize("seed", range(40))
def test_any_limits(seed: int) -> None:
    """Inside them, and what is left of the gradient is pushed by limits that hold."""
    matrix, right = problem(seed)
    draw = np.random.default_rng(2000 + seed)
    limits = draw.normal(size=(6, matrix.shape[1]))
    inside = draw.normal(size=matrix.shape[1])
    room = limits @ inside + draw.uniform(0, 0.1, 6)
    found = least_squares(matrix, right, limits, room)
    assert found is not None
    left = room - limits @ found
    assert left.min() >= -1e-8 * np.abs(room).max()
    gradient = matrix.T @ (matrix @ found - right)
    active = limits[left <= 1e-7 * np.abs(room).max()]
    missing = nnls(active.T, -gradient)[1] if len(active) else np.linalg.norm(gradient)
    assert missing <= 1e-6 * np.linalg.norm(matrix.T @ right)


def test_without_limits_it_is_least_squares() -> None:
    matrix, right = problem(3)
    found = least_squares(matrix, right, np.zeros((0, matrix.shape[1])), np.zeros(0))
    assert found == pytest.approx(np.linalg.lstsq(matrix, right, rcond=None)[0], rel=1e-6)


def test_nothing_within_the_limits() -> None:
    limits, room = np.array([[1.0], [-1.0]]), np.array([-1.0, -1.0])
    assert least_squares(np.eye(1), np.zeros(1), limits, room) is None
    assert least_squares(np.eye(1), np.zeros(1), np.zeros((1, 1)), np.array([-1.0])) is None


def test_nothing_unknown() -> None:
    found = least_squares(np.zeros((3, 0)), np.ones(3), np.zeros((0, 0)), np.zeros(0))
    assert found is not None
    assert found.shape == (0,)
