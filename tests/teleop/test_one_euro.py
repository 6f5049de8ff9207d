"""The One-Euro filter. Oracles: the closed forms of a low pass of first order."""

from math import pi, sqrt

import numpy as np
import pytest

from hydrostat.errors import InputError
from hydrostat.teleop import Smoothing
from hydrostat.teleop.mapped_hand import OneEuro

STEP = 1 / 90


def share(frequency: float) -> float:
    return 1 / (1 + 1 / (2 * pi * frequency * STEP))


def run(smoothing: Smoothing, values: np.ndarray) -> np.ndarray:
    """What becomes of values of one sensor at even steps."""
    smooth = OneEuro(smoothing)
    return np.array([smooth(np.array([value]), number * STEP)[0] for number, value in enumerate(values)])


def test_a_step_without_rise_is_that_of_a_low_pass() -> None:
    found = run(Smoothing(least=2.0, rise=0.0), np.r_[0.0, np.ones(50)])
    assert found == pytest.approx(1 - (1 - share(2.0)) ** np.arange(51), abs=1e-12)


def test_noise_at_rest_becomes_smaller_by_the_closed_form() -> None:
    noise = 0.5 / 254 * np.random.default_rng(1).normal(size=200_000)
    still = run(Smoothing(least=1.5, rise=0.0), noise)[1000:]
    assert still.std() / noise.std() == pytest.approx(sqrt(share(1.5) / (2 - share(1.5))), rel=0.03)
    assert run(Smoothing(), noise[:20_000])[1000:].std() < 0.3 * noise.std()  # of a glove, as it is used


def test_what_rises_evenly_is_followed_late_by_the_closed_form() -> None:
    smoothing, speed = Smoothing(least=1.5, rise=60.0), 0.5
    ramp = speed * STEP * np.arange(400)
    late = (ramp - run(smoothing, ramp))[-1] / speed
    frequency = smoothing.least + smoothing.rise * speed
    assert late == pytest.approx(1 / (2 * pi * frequency), rel=1e-6)
    assert late < 6e-3


def test_a_jump_of_a_hand_is_followed_at_once_and_a_pause_forgets() -> None:
    found = run(Smoothing(), np.r_[np.zeros(90), np.full(3, 0.1)])
    assert found[90] > 0.05
    assert found[92] > 0.09
    smooth = OneEuro()
    smooth(np.zeros(2), 0.0)
    assert smooth(np.array([0.5, 0.2]), 60.0) == pytest.approx([0.5, 0.2], abs=2e-3)
    assert smooth(np.array([0.7, 0.1]), 60.0) == pytest.approx([0.7, 0.1])  # of no later time


@pytest.mark.parametrize("wrong", [{"least": 0.0}, {"least": float("nan")}, {"rise": -1.0}, {"speed": 1e4}])
def test_smoothing_has_ranges(wrong: dict[str, float]) -> None:
    with pytest.raises(InputError, match=f"smoothing: {next(iter(wrong))} must be from"):
        Smoothing(**wrong)
