"""Inertia and time schemes."""

import numpy as np
import pytest
from states import deform, rough_mesh

from hydrostat.mechanics.inertia import SCHEMES, InertiaEnergy, TimeScheme
from hydrostat.testing import check_energy


@pytest.mark.parametrize("dim", [2, 3])
def test_inertia_keeps_the_contract_of_energies(dim: int) -> None:
    """Oracle: central differences."""
    random = np.random.default_rng(dim)
    mesh = rough_mesh(dim, random)
    energy = InertiaEnergy(deform(mesh, random), random.uniform(1, 2, len(mesh.nodes)))
    check_energy(energy, deform(mesh, random), np.zeros(0))


def square(scheme: TimeScheme) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The table as a matrix, its weights and its times."""
    matrix = np.zeros((len(scheme.table), len(scheme.table)))
    for row, given in enumerate(scheme.table):
        matrix[row, : len(given)] = given
    return matrix, matrix[-1], matrix.sum(axis=1)


@pytest.mark.parametrize("name", SCHEMES)
def test_schemes_fulfil_the_conditions_of_their_order_and_no_more(name: str) -> None:
    """Oracle: Butcher's conditions."""
    matrix, weights, times = square(SCHEMES[name])
    misses = [
        [weights.sum() - 1],
        [weights @ times - 1 / 2],
        [weights @ times**2 - 1 / 3, weights @ matrix @ times - 1 / 6],
        [weights @ times**3 - 1 / 4],
    ]
    order = SCHEMES[name].order
    assert np.abs(np.concatenate(misses[:order])).max() < 1e-14
    assert np.abs(misses[order]).max() > 1e-3


@pytest.mark.parametrize("name", SCHEMES)
def test_schemes_damp_what_is_too_fast_to_follow(name: str) -> None:
    """Oracle: the stability function R(z) = 1 + z b (I - z A)^-1 1: at most 1 on the imaginary axis, 0 at infinity."""
    matrix, weights, _ = square(SCHEMES[name])
    one = np.ones(len(weights))

    def growth(z: complex) -> float:
        return abs(1 + z * weights @ np.linalg.solve(np.eye(len(one)) - z * matrix, one))

    assert max(growth(1j * w) for w in np.logspace(-3, 6, 400)) <= 1 + 1e-12
    assert growth(-1e9) < 1e-8
