"""What Gauss-Newton leaves out. Oracle: the exact second derivatives of a residual that is quadratic."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from hydrostat.ik.search.descend import Curvature

pytestmark = pytest.mark.usefixtures("unchecked")

BEND = np.array([[2.0, 0.5], [0.5, -1.0]])


def model(values: np.ndarray) -> SimpleNamespace:
    """Three residuals: two linear ones, and a quadratic one."""
    residual = np.array([values[0] - 3.0, values[1], 5.0 + 0.5 * values @ BEND @ values])
    matrix = np.vstack([np.eye(2), BEND @ values])
    return SimpleNamespace(
        values=values,
        residual=residual,
        matrix=matrix,
        alike=lambda other: True,
        gradient=lambda other=None: matrix.T @ (residual if other is None else other),
    )


def test_it_is_true_along_the_last_step() -> None:
    places = [np.array(place) for place in ([1.0, 1.0], [0.8, 1.1], [0.7, 0.9], [0.75, 0.85])]
    curvature = Curvature()
    for before, after in pairwise(places):
        curvature.update(model(before), model(after))
    step = places[-1] - places[-2]
    exact = model(places[-1]).residual[2] * BEND @ step
    assert curvature._matrix @ step == pytest.approx(exact, rel=1e-9)


def test_it_is_forgotten_when_a_cable_becomes_taut() -> None:
    curvature = Curvature()
    first, second = model(np.array([1.0, 1.0])), model(np.array([0.5, 1.2]))
    curvature.update(first, second)
    assert curvature.matrix is not None
    second.alike = lambda other: False
    curvature.update(second, first)
    assert curvature.matrix is None
