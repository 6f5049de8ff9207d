"""Every energy keeps its contract. Oracle: central differences, in `hydrostat.testing.check_energy`."""

import numpy as np
import pytest
from states import ENERGIES, rod_twist

from hydrostat.testing import check_energy


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("name", ENERGIES)
def test_energy_keeps_its_contract(name: str, dim: int, seed: int) -> None:
    state = ENERGIES[name](dim, np.random.default_rng([seed, dim]))
    check_energy(state.energy, state.nodes, state.controls, seed=seed)


@pytest.mark.parametrize("seed", range(5))
def test_twist_of_a_rod_keeps_its_contract(seed: int) -> None:
    state = rod_twist(np.random.default_rng(seed))
    check_energy(state.energy, state.nodes, state.controls, seed=seed)
