"""Verdicts of several seeds. Oracles: scipy's trimmed mean, cases whose answer is plain, coverage by chance."""

import numpy as np
import pytest
from scipy.stats import trim_mean

from hydrostat_lab.verdict import interquartile, verdict


def test_interquartile_mean_leaves_the_outer_quarters_out() -> None:
    values = [100.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, -50.0]
    found = interquartile(values)
    assert found.mean == pytest.approx(3.5) == trim_mean(values, 0.25)
    assert found.low < 3.5 < found.high


def test_verdicts() -> None:
    assert verdict([1.0, 1.1, 0.9, 1.2, 1.0], 0.0) == "confirmed"
    assert verdict([-1.0, -1.1, -0.9, -1.2, -1.0], 0.0) == "contradicted"
    assert verdict([-1.0, 1.1, -0.9, 1.2, 0.1], 0.0) == "cannot be told"
    assert verdict([5.0], 0.0) == "cannot be told"  # one seed tells nothing
    assert verdict([0.0, 0.0, 0.0], 0.0) == "contradicted"  # not above


def test_intervals_cover_the_truth_mostly() -> None:
    """Of ten draws of a symmetric law the interval holds its middle in most cases."""
    draw = np.random.default_rng(1)
    found = [interquartile(draw.standard_normal(10)) for _ in range(200)]
    assert 0.8 < np.mean([each.low < 0 < each.high for each in found]) < 0.99
