"""Slips of long chains of springs, slack ones among them. Oracle: tensions differ by no more than friction holds."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrostat.mechanics.tension_law import ChainLaw


def test_springs_between_slack_ones_find_their_least_energy() -> None:
    """Four spans, the outer two slack: neighbors may differ by the limit only, and by just that where cable slips."""
    elongation = np.array([-4.386e-3, 6.35e-4, 4.31e-4, -2.302e-3])
    limits = np.array([0.0, 0.0124, 0.0737, 0.0792])
    tensions = _tensions(elongation, limits)
    assert tensions == pytest.approx([0.0, 0.0124, 0.079, 0.0], abs=2e-3)


@pytest.mark.parametrize("seed", range(200))
def test_neighboring_tensions_differ_by_no_more_than_the_limit(seed: int) -> None:
    random = np.random.default_rng(seed)
    spans = int(random.integers(4, 24))
    elongation = random.uniform(-5e-3, 2e-3, spans)
    limits = np.concatenate([[0.0], random.uniform(0.0, 0.1, spans - 1)])
    tensions = _tensions(elongation, limits)
    assert (np.abs(np.diff(tensions)) <= limits[1:] + 1e-7 * max(tensions.max(), 1e-3)).all()


@pytest.mark.parametrize("seed", range(20))
def test_joined_springs_are_the_slope_of_the_tensions(seed: int) -> None:
    """G D G^T with a column for each spring is dT/ds: central differences. Its law is that of its least tight span."""
    random = np.random.default_rng(seed)
    spans = int(random.integers(4, 24))
    elongation = random.uniform(-1e-3, 2e-3, spans)
    law = _law(np.concatenate([[0.0], random.uniform(0.0, 3.0, spans - 1)]))
    springs, elongations, joined = law.springs(elongation)
    columns = (springs[:, None] == np.arange(len(elongations))).astype(float)
    own = elongation + law.slips(elongation) - np.append(law.slips(elongation)[1:], 0.0)
    assert elongations == pytest.approx(columns.T @ own, abs=1e-15)
    least = [law.tension(elongation)[springs == spring].min() for spring in range(len(elongations))]
    assert joined.tension(elongations) == pytest.approx(least, abs=1e-9)
    step = 1e-9 * np.eye(spans)
    slopes = np.array([law.tension(elongation + one) - law.tension(elongation - one) for one in step]).T / 2e-9
    assert columns @ np.diag(joined.tangent(elongations)) @ columns.T == pytest.approx(slopes, abs=1e-5 * 16e3)


def test_threads_that_share_a_law_get_their_own_slips() -> None:
    """What is kept for one must not be told to another. Oracle: a law that nobody shares."""
    random = np.random.default_rng(0)
    limits = np.concatenate([[0.0], random.uniform(0.0, 3.0, 11)])
    shared, asked = _law(limits), random.uniform(-1e-3, 2e-3, (4, 12))

    def wrong(elongation: np.ndarray) -> int:
        alone = _law(limits).slips(elongation)
        return sum(not np.array_equal(shared.slips(elongation), alone) for _ in range(3000))

    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        with ThreadPoolExecutor(4) as pool:
            assert sum(pool.map(wrong, asked)) == 0
    finally:
        sys.setswitchinterval(before)


def _tensions(elongation: np.ndarray, limits: np.ndarray) -> np.ndarray:
    return _law(limits).tension(elongation)


def _law(limits: np.ndarray) -> ChainLaw:
    count = len(limits)
    return ChainLaw(
        stiffness=np.full(count, 16e3), smoothing=np.full(count, 2.5e-5), starts=np.array([0, count]), limits=limits
    )
