"""The tension law (R25, E1 to E3). Oracles: its definition, limits at the joints, central differences."""

import numpy as np
import pytest

from hydrostat.mechanics import TensionLaw

K, EPS = 4e3, 0.5e-3
LAWS = TensionLaw(stiffness=np.array([K]), smoothing=np.array([EPS]))


class LAW:
    """One cable, in numbers."""

    @staticmethod
    def energy(elongation: float) -> float:
        return float(LAWS.energy(np.array([elongation]))[0])

    @staticmethod
    def tension(elongation: float) -> float:
        return float(LAWS.tension(np.array([elongation]))[0])

    @staticmethod
    def tangent(elongation: float) -> float:
        return float(LAWS.tangent(np.array([elongation]))[0])


def test_a_cable_at_rest_has_neither_tension_nor_energy_nor_stiffness() -> None:
    assert (LAW.energy(0.0), LAW.tension(0.0), LAW.tangent(0.0)) == (0.0, 0.0, 0.0)
    assert (LAW.energy(-1.0), LAW.tension(-1.0), LAW.tangent(-1.0)) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("joint", [0.0, 2 * EPS])
@pytest.mark.parametrize(("name", "slope"), [("energy", K * EPS), ("tension", K), ("tangent", K / EPS)])
def test_energy_tension_and_tangent_are_continuous_at_the_joints(joint: float, name: str, slope: float) -> None:
    """Twice continuously differentiable: the limits from both sides agree to the width of the gap."""
    gap = 1e-9 * EPS
    before, after = (getattr(LAW, name)(joint + side) for side in (-gap, gap))
    assert abs(after - before) <= 4 * slope * gap


@pytest.mark.parametrize("elongation", [-0.3 * EPS, 0.4 * EPS, 1.7 * EPS, 2.5 * EPS, 40 * EPS])
def test_each_is_the_derivative_of_the_one_before(elongation: float) -> None:
    h = 1e-4 * EPS
    assert LAW.tension(elongation) == pytest.approx(
        (LAW.energy(elongation + h) - LAW.energy(elongation - h)) / (2 * h), rel=1e-6
    )
    assert LAW.tangent(elongation) == pytest.approx(
        (LAW.tension(elongation + h) - LAW.tension(elongation - h)) / (2 * h), rel=1e-6
    )


def test_the_stiffness_is_that_of_the_taut_cable() -> None:
    """E3: dT/ds = k, not k / 2; the thesis's own U, with K = k / 2 and moved by eps, is the same curve."""
    assert LAW.tangent(3 * EPS) == K
    assert LAW.tension(11 * EPS) - LAW.tension(10 * EPS) == pytest.approx(K * EPS)
    half = K / 2
    for elongation in np.linspace(-EPS, 5 * EPS, 31):
        a = elongation - EPS
        if a <= -EPS:
            thesis = 0.0
        elif a <= EPS:
            thesis = half / (6 * EPS) * a**3 + half / 2 * a**2 + half * EPS / 2 * a + half * EPS**2 / 6
        else:
            thesis = half * a**2 + half * EPS**2 / 3
        assert LAW.energy(float(elongation)) == pytest.approx(thesis, rel=1e-12, abs=1e-18)


def test_each_cable_follows_its_own_law() -> None:
    """Oracle: the same cables one by one."""
    random = np.random.default_rng(0)
    stiffness, smoothing = random.uniform(1e2, 1e4, 60), random.uniform(1e-4, 1e-2, 60)
    elongation = smoothing * random.uniform(-1, 4, 60)
    laws = TensionLaw(stiffness=stiffness, smoothing=smoothing)
    for name in ("energy", "tension", "tangent"):
        together = getattr(laws, name)(elongation)
        for k, eps, s, found in zip(stiffness, smoothing, elongation, together, strict=True):
            alone = TensionLaw(stiffness=np.array([k]), smoothing=np.array([eps]))
            assert getattr(alone, name)(np.array([s]))[0] == pytest.approx(found, rel=1e-14)


def test_the_elongation_of_a_tension_is_the_inverse_of_the_law() -> None:
    """In the cubic zone, at its end and beyond."""
    random = np.random.default_rng(1)
    laws = TensionLaw(stiffness=random.uniform(1e2, 1e4, 60), smoothing=random.uniform(1e-4, 1e-2, 60))
    elongation = laws.smoothing * np.concatenate([random.uniform(1e-3, 6, 59), [2.0]])
    assert laws.elongation(laws.tension(elongation)) == pytest.approx(elongation, rel=1e-12)
