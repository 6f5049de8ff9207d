"""The factorisation. Oracle: dense eigenvalues and dense solves."""

import numpy as np
import pytest
from scipy.sparse import csc_array

from hydrostat.mechanics import Factorisation


def random_symmetric(size: int, seed: int, *, shift: float) -> np.ndarray:
    """A sparse symmetric matrix whose eigenvalues are moved by `shift` from the middle of its spectrum."""
    random = np.random.default_rng(seed)
    matrix = np.where(random.random((size, size)) < 0.2, random.standard_normal((size, size)), 0.0)
    matrix = matrix + matrix.T
    values = np.linalg.eigvalsh(matrix)
    return matrix - (shift * values[0] + (1 - shift) * values[-1]) * np.eye(size)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("shift", [1.2, 1.001, 0.999, 0.9, 0.5, 0.1, -0.2])
def test_definite_says_what_the_eigenvalues_say(seed: int, shift: float) -> None:
    dense = random_symmetric(40, seed, shift=shift)
    factor = Factorisation(csc_array(dense))
    values = np.linalg.eigvalsh(dense)
    assert factor.definite == bool(values[0] > 0)
    assert not factor.singular
    right = np.random.default_rng(seed).standard_normal((40, 3))
    exact = np.linalg.solve(dense, right)
    # Without pivoting an indefinite matrix costs digits; how many is bounded by what the pivots grow to.
    assert factor.solve(right) == pytest.approx(exact, abs=1e-8 * np.linalg.cond(dense) * np.abs(exact).max() / 1e2)
    assert factor.solve(right[:, 0]) == pytest.approx(factor.solve(right)[:, 0], rel=1e-9)


def test_a_zero_pivot_of_a_regular_matrix_is_not_definite() -> None:
    """Eigenvalues 1 and -1: it needs a row exchange, after which the pivots are positive."""
    factor = Factorisation(csc_array(np.array([[0.0, 1.0], [1.0, 0.0]])))
    assert not factor.definite
    if not factor.singular:
        assert factor.solve(np.array([2.0, 3.0])) == pytest.approx([3.0, 2.0])


@pytest.mark.parametrize("dense", [np.zeros((3, 3)), np.diag([1.0, 0.0, 2.0]), np.ones((2, 2))])
def test_a_singular_matrix_is_called_so(dense: np.ndarray) -> None:
    factor = Factorisation(csc_array(dense))
    assert factor.singular
    assert not factor.definite
