"""Cables during a step. Oracles: scipy.optimize on the same convex function, complementarity, measured lengths."""

import numpy as np
import pytest
from scipy.optimize import minimize

from hydrostat.mechanics import TensionLaw


def problem(seed: int, cables: int) -> tuple[TensionLaw, np.ndarray, np.ndarray]:
    """Cables of which about half would be slack, on a body that couples them."""
    random = np.random.default_rng([seed, cables])
    law = TensionLaw(stiffness=10 ** random.uniform(2, 5, cables), smoothing=10 ** random.uniform(-4, -2.5, cables))
    half = random.standard_normal((cables, cables))
    compliance = 10 ** random.uniform(-5, -3) * half @ half.T
    return law, random.uniform(-0.03, 0.03, cables), compliance


@pytest.mark.parametrize("cables", [1, 2, 5, 12])
@pytest.mark.parametrize("seed", range(6))
def test_tensions_settle_where_scipy_says(seed: int, cables: int) -> None:
    """The least of T C T / 2 + U(s - C T), by BFGS with the gradient C (T - U'), in units in which C is 1."""
    law, elongations, compliance = problem(seed, cables)
    root = np.linalg.cholesky(compliance)

    def cost(z: np.ndarray) -> tuple[float, np.ndarray]:
        remaining = elongations - root @ z
        value = 0.5 * z @ z + law.energy(remaining).sum()
        return 1e3 * float(value), 1e3 * (z - root.T @ law.tension(remaining))

    expected = minimize(cost, np.zeros(cables), jac=True, method="BFGS", options={"gtol": 1e-11, "maxiter": 5000})
    found = law.solve_slack_complementarity(elongations, compliance)
    assert found is not None
    reached = root.T @ found
    assert cost(reached)[0] <= expected.fun + 1e-9 * abs(expected.fun) + 1e-15
    scale = max(np.abs(expected.x).max(), 1e-9)
    assert reached == pytest.approx(expected.x, abs=1e-5 * scale)


@pytest.mark.parametrize("cables", [1, 3, 12])
@pytest.mark.parametrize("seed", range(6))
def test_each_cable_keeps_its_law_and_none_pushes(seed: int, cables: int) -> None:
    """Complementarity: T >= 0, T = 0 where what is left of the elongation is negative, T = law(s - C T) everywhere."""
    law, elongations, compliance = problem(seed, cables)
    tensions = law.solve_slack_complementarity(elongations, compliance)
    assert tensions is not None
    remaining = elongations - compliance @ tensions
    largest = tensions.max(initial=0.0)
    assert tensions.min() >= -1e-12 * largest
    assert np.abs(tensions[remaining < 0]).max(initial=0.0) <= 1e-11 * largest
    assert tensions == pytest.approx(law.tension(remaining), abs=1e-10 * max(largest, 1e-12))


def test_a_linear_law_would_let_a_cable_push() -> None:
    """The check can fail, and why `settle` is there: two cables of which one goes slack when the other pulls."""
    law = TensionLaw(stiffness=np.array([1e4, 1e4]), smoothing=np.array([1e-4, 1e-4]))
    compliance = 1e-3 * np.array([[1.0, 0.9], [0.9, 1.0]])
    elongations = np.array([0.02, 0.005])
    linear = np.linalg.solve(np.eye(2) / 1e4 + compliance, elongations - 1e-4)
    found = law.solve_slack_complementarity(elongations, compliance)
    assert found is not None
    assert linear[1] < -1.0
    assert found[1] == 0.0
    assert found[0] == pytest.approx((0.02 - 1e-4) / (1e-3 + 1e-4), rel=1e-9)


def test_slack_cables_stay_slack() -> None:
    law, _, compliance = problem(0, 4)
    found = law.solve_slack_complementarity(np.full(4, -0.01), compliance)
    assert found is not None
    assert not found.any()
