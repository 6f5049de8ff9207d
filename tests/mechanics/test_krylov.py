"""Systems known by products alone. Oracle: elimination of the whole matrix."""

import numpy as np
import pytest

from hydrostat.mechanics.krylov import solve_krylov


@pytest.mark.parametrize("size", [1, 12, 30])
@pytest.mark.parametrize("scale", [1e-3, 0.5, 3.0])
def test_solution_is_that_of_the_whole_matrix(size: int, scale: float) -> None:
    random = np.random.default_rng(size)
    matrix = scale * random.standard_normal((size, size)) / size**0.5
    right = 1e-4 * random.standard_normal(size)
    expected = np.linalg.solve(np.eye(size) - matrix, right)
    found = solve_krylov(lambda vector: matrix @ vector, right, share=1e-10)
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-8 * np.abs(expected).max())


def test_products_are_few_where_little_is_asked_and_none_where_nothing_is() -> None:
    random = np.random.default_rng(0)
    matrix, right = 0.05 * random.standard_normal((200, 200)) / 200**0.5, random.standard_normal(200)
    asked = []

    def product(vector: np.ndarray) -> np.ndarray:
        asked.append(vector)
        return matrix @ vector

    found = solve_krylov(product, right)
    assert np.linalg.norm(found - matrix @ found - right) <= 1e-4 * np.linalg.norm(right)
    assert len(asked) <= 5  # each product leaves about a twentieth
    assert not solve_krylov(product, np.zeros(200)).any()
    assert len(asked) <= 5
