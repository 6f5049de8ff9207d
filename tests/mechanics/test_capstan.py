"""Balance by the capstan law. Oracles: conditions of complementarity, and `ChainLaw` at the limits that are found."""

from dataclasses import replace

import numpy as np
import pytest

from hydrostat.kernel import native
from hydrostat.mechanics.capstan import CapstanChains
from hydrostat.mechanics.tension_law import ChainLaw


@pytest.mark.parametrize("seed", range(10))
def test_unknowns_and_rows_complement_each_other(seed: int) -> None:
    """A copositive matrix: semidefinite, and more where products of unknowns are positive."""
    random = np.random.default_rng(seed)
    half, right, found = random.standard_normal((12, 12)), random.standard_normal(12), np.zeros(12)
    matrix = half @ half.T + random.uniform(0, 3, (12, 12))
    assert native.complement(matrix, right, True, found)
    rows = matrix @ found + right
    assert found.min() >= 0
    assert rows.min() > -1e-9
    assert np.abs(found * rows).max() < 1e-9


def test_a_problem_without_a_solution_is_told() -> None:
    assert not native.complement(-np.eye(2), -np.ones(2), True, np.zeros(2))


def chains(seed: int) -> CapstanChains:
    """Two cables that turn by up to half a turn at each point, on a soft body that couples them."""
    random = np.random.default_rng(seed)
    starts, stiffness = np.array([0, 7, 12]), 10 ** random.uniform(3, 6, 12)
    friction, half = np.full(12, random.uniform(0.2, 0.8)), random.standard_normal((12, 12))
    friction[starts[:-1]] = 0.0
    law = ChainLaw(stiffness=stiffness, smoothing=np.full(12, 1e-4), starts=starts, limits=np.zeros(12))
    elongations, compliance = random.uniform(-0.005, 0.02, 12), 1e-3 * half @ half.T
    return CapstanChains(
        law=law,
        friction=friction,
        tensions=np.zeros(12),
        elongations=elongations,
        angles=random.uniform(0, np.pi, 12),
        compliance=compliance,
        turning=1e-4 * half,
        stable=True,
    )


@pytest.mark.parametrize("seed", range(20))
def test_tensions_are_those_of_the_limits_that_they_ask_for(seed: int) -> None:
    problem = chains(seed)
    tensions = problem.solve_slip_complementarity()
    assert tensions is not None
    law = replace(problem.law, limits=problem.limits(tensions))
    again = law.tension(problem.elongations - problem.compliance @ tensions)
    slips = law.slips(problem.elongations - problem.compliance @ tensions)
    assert np.count_nonzero(slips) > 0
    assert np.abs(again - tensions).max() < 1e-6 * tensions.max()
