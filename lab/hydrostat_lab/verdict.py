"""`Verdict`: what several seeds say of a claim, by the interquartile mean and its bootstrap interval."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import bootstrap, trim_mean


@dataclass(frozen=True, kw_only=True)
class Interval:
    """Interquartile mean of some seeds, and where it lies with 95 % (bootstrap by percentiles)."""

    mean: float
    low: float
    high: float


def interquartile(values: Sequence[float] | np.ndarray) -> Interval:
    """The interquartile mean of values and its interval; both ends are the value itself where there is but one."""
    given = np.asarray(values, dtype=float).ravel()
    mean = float(_iqm(given))
    if len(given) < 2 or np.ptp(given) == 0:
        return Interval(mean=mean, low=mean, high=mean)
    found = bootstrap((given,), _iqm, n_resamples=2000, method="percentile", rng=np.random.default_rng(0))
    low, high = found.confidence_interval
    return Interval(mean=mean, low=float(low), high=float(high))


def verdict(values: Sequence[float] | np.ndarray, above: float) -> str:
    """Judge the claim that values are above a bound: by the interval of their interquartile mean.

    Returns:
        "confirmed" if all of the interval is above, "contradicted" if all of it is below or at the bound, else, and
        for a single seed, "cannot be told".
    """
    found = interquartile(values)
    if np.size(values) < 2 or found.low <= above < found.high:
        return "cannot be told"
    return "confirmed" if found.low > above else "contradicted"


def _iqm(values: np.ndarray, axis: int = -1) -> np.ndarray:
    return trim_mean(values, 0.25, axis=axis)
