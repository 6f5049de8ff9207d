"""Small solvers of inverse kinematics against SciPy's."""

import numpy as np
import pytest
from scipy.linalg import solve_triangular
from scipy.optimize import nnls

from hydrostat.ik.search import linear_model
from hydrostat.ik.search.linear_model import solve_nonnegative, solve_upper


@pytest.mark.parametrize("alone", [True, False], ids=["solver alone", "by SciPy"])
@pytest.mark.parametrize(("rows", "size"), [(1, 1), (4, 9), (12, 5), (30, 30)])
def test_nonnegative_least_squares_are_those_of_scipy(rows: int, size: int, alone: bool, monkeypatch):
    if not alone:
        monkeypatch.setattr(linear_model, "load_compiled", lambda name: None)
    draw = np.random.default_rng(rows)
    for _ in range(10):
        matrix, right = draw.standard_normal((rows, size)), draw.standard_normal(rows)
        np.testing.assert_array_equal(solve_nonnegative(matrix, right), nnls(matrix, right)[0])


def test_a_number_that_is_not_finite_is_refused():
    with pytest.raises(ValueError, match="infs or NaNs"):
        solve_nonnegative(np.array([[np.nan]]), np.ones(1))


@pytest.mark.parametrize("transposed", [False, True])
def test_triangles_are_solved_as_by_scipy(transposed: bool):
    draw = np.random.default_rng(1)
    for size in (1, 2, 7, 20):
        triangle = np.triu(draw.standard_normal((size, size))) + 3.0 * np.eye(size)
        right = draw.standard_normal((size, 5))
        expected = solve_triangular(triangle, right, trans=int(transposed))
        found = solve_upper(triangle, right, transposed=transposed)
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())
