"""Via points slide along their cables to where every one can have its hole. Oracle: distances of all pairs."""

from itertools import combinations

import numpy as np
import pytest

from hydrostat.design.trees.via_points import keep_apart

GAP = 0.004


def line(start: tuple[float, float], end: tuple[float, float], points: int) -> np.ndarray:
    return np.linspace(start, end, points)


def least_gap(cables: list[np.ndarray]) -> float:
    """Between any two points that do not coincide."""
    points = [point for cable in cables for point in cable]
    gaps = [float(np.linalg.norm(one - other)) for one, other in combinations(points, 2)]
    return min(gap for gap in gaps if gap > 1e-5)


def test_points_that_are_apart_stay() -> None:
    cables = [line((0, 0), (0.1, 0), 6), line((0, 0.02), (0.1, 0.02), 6)]
    kept = keep_apart(cables, gap=GAP, winch_gap=0.012)
    assert kept is not None
    assert all(np.array_equal(one, other) for one, other in zip(kept, cables, strict=True))


@pytest.mark.parametrize(
    "second",
    [
        line((0, 0.002), (0.1, 0.002), 6),  # beside the first
        line((0.06, -0.05), (0.06, 0.05), 6),  # across it
        line((0.041, -0.04), (0.039, 0.04), 5),  # through one of its points, nearly
    ],
)
def test_points_slide_along_their_own_cable(second: np.ndarray) -> None:
    cables = [line((0.0, 0.0), (0.1, 0.0), 6), second]
    kept = keep_apart(cables, gap=GAP, winch_gap=GAP)
    assert kept is not None
    assert least_gap([cable[1:] for cable in kept]) >= GAP
    for before, after in zip(cables, kept, strict=True):
        assert np.array_equal(before[0], after[0])
        along = (before[-1] - before[0]) / np.linalg.norm(before[-1] - before[0])
        across = np.array([-along[1], along[0]])
        assert np.abs((after - before[0]) @ across).max() < 1e-12
        assert (np.diff(after @ along) > 0).all()


def test_a_shared_bend_may_stay_shared() -> None:
    lead = line((0, 0), (0.03, 0), 2)
    cables = [np.vstack([lead, [[0.06, 0.03]]]), np.vstack([lead, [[0.06, -0.03]]])]
    kept = keep_apart(cables, gap=GAP, winch_gap=0.012)
    assert kept is not None
    assert np.array_equal(kept[0][1], kept[1][1])


def test_points_keep_off_other_winches() -> None:
    cables = [line((0, 0), (0.1, 0), 6), line((0.04, 0.003), (0.04, 0.05), 3)]
    kept = keep_apart(cables, gap=GAP, winch_gap=0.008)
    assert kept is not None
    assert np.linalg.norm(kept[0] - cables[1][0], axis=1).min() >= 0.008


def test_no_room_is_told() -> None:
    crowd = [line((0, 1e-4 * index), (0.02, 1e-4 * index), 5) for index in range(4)]
    assert keep_apart(crowd, gap=GAP, winch_gap=GAP) is None
