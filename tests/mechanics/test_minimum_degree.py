"""The order by minimum degree against SciPy's public function."""

import subprocess
import sys

import numpy as np
import pytest
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import spilu

from hydrostat.mechanics import ordering
from hydrostat.mechanics.ordering import order_by_minimum_degree


def _graph(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A random connected graph: starts, and neighbors of each node in any order."""
    draw = np.random.default_rng(seed)
    ends = np.concatenate(
        [draw.integers(0, count, (2, 4 * count)), [np.arange(count - 1), np.arange(1, count)]], axis=1
    )
    ends = np.unique(np.sort(ends[:, ends[0] != ends[1]], axis=0), axis=1)
    one, other = np.concatenate([ends, ends[::-1]], axis=1)
    order = np.lexsort((draw.random(len(one)), one))
    return np.append(0, np.cumsum(np.bincount(one, minlength=count))), other[order]


def _reference(starts: np.ndarray, neighbors: np.ndarray) -> np.ndarray:
    owners = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    links = coo_array((-np.ones(len(owners)), (neighbors, owners)), shape=(len(starts) - 1,) * 2)
    diagonal = coo_array((np.diff(starts) + 1.0, (np.arange(len(starts) - 1),) * 2))
    graph = csc_array(links + diagonal)
    return np.argsort(spilu(graph, drop_tol=1e9, fill_factor=1, permc_spec="MMD_AT_PLUS_A").perm_c)


@pytest.mark.parametrize("alone", [True, False], ids=["SuperLU alone", "by SciPy"])
@pytest.mark.parametrize("count", [2, 30, 400])
def test_the_order_is_that_of_scipy(count: int, alone: bool, monkeypatch: pytest.MonkeyPatch):
    if not alone:
        monkeypatch.setattr(ordering, "load_compiled", lambda name: None)
    starts, neighbors = _graph(count, seed=count)
    np.testing.assert_array_equal(order_by_minimum_degree(starts, neighbors), _reference(starts, neighbors))


@pytest.mark.slow
def test_scipy_works_after_superlu_was_loaded_alone():
    code = (
        "import sys, numpy as np\n"
        "from hydrostat.mechanics.ordering import order_by_minimum_degree\n"
        "order = order_by_minimum_degree(np.array([0, 1, 3, 4]), np.array([1, 0, 2, 1]))\n"
        "assert sorted(order) == [0, 1, 2] and 'scipy.sparse' not in sys.modules\n"
        "from scipy.sparse import csc_array\n"
        "from scipy.sparse.linalg import splu\n"
        "print(splu(csc_array(np.diag([1.0, 2.0, 4.0]))).solve(np.ones(3)).tolist())\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[1.0, 0.5, 0.25]"
