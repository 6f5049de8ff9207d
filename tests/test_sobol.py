"""Scrambled Sobol points. Oracle: SciPy's public class, to the last bit."""

import numpy as np
import pytest
from scipy.stats.qmc import Sobol

from hydrostat import sobol
from hydrostat.sobol import draw_sobol


@pytest.mark.parametrize("alone", [True, False], ids=["by the file", "by the class"])
@pytest.mark.parametrize(("size", "first", "count"), [(1, 0, 8), (10, 48, 16), (24, 64, 37), (40, 0, 1024), (2, 0, 1)])
def test_points_are_those_of_scipy(
    size: int, first: int, count: int, *, alone: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not alone:
        monkeypatch.setattr(sobol, "_read_directions", lambda: None)
    known = Sobol(size, rng=np.random.default_rng(5))
    wanted = known.random(2048)[first : first + count]
    np.testing.assert_array_equal(draw_sobol(size, count, np.random.default_rng(5), first=first), wanted)


def test_directions_stand_in_the_file_of_scipy() -> None:
    """Oracle: the first primitive polynomials of Joe and Kuo: x + 1, x^2 + x + 1, x^3 + x + 1."""
    found = sobol._read_directions()
    assert found is not None
    assert found[0][1:4] == [0b11, 0b111, 0b1011]
