import numpy as np
import pytest

from hydrostat.errors import OutlineError
from hydrostat.geometry import Outline

SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
HOLE = np.array([[0.2, 0.2], [0.6, 0.2], [0.6, 0.6], [0.2, 0.6]])


def test_measures() -> None:
    """Oracle: closed forms."""
    outline = Outline(SQUARE, (HOLE,))
    assert outline.area == pytest.approx(2 - 0.16)
    assert outline.size == 2.0
    assert outline.polygon.area == outline.area
    assert len(outline.rings) == 2


def test_turned_the_right_way_and_kept() -> None:
    """Oracle: the shoelace formula is positive for the outer ring, negative for holes.

    The caller's array is left alone."""

    def shoelace(ring: np.ndarray) -> float:
        after = np.roll(ring, -1, axis=0)
        return float((ring[:, 0] * after[:, 1] - ring[:, 1] * after[:, 0]).sum() / 2)

    for exterior in (SQUARE, SQUARE[::-1]):
        for hole in (HOLE, HOLE[::-1]):
            outline = Outline(exterior, (hole,))
            assert shoelace(outline.exterior) == pytest.approx(2)
            assert shoelace(outline.holes[0]) == pytest.approx(-0.16)
    assert SQUARE.flags.writeable
    assert not outline.exterior.flags.writeable


def test_repeated_points_are_dropped() -> None:
    """Oracle: the ring without them."""
    assert np.array_equal(Outline(np.concatenate([SQUARE[:2], SQUARE[1:], SQUARE[:1]])).exterior, SQUARE)


@pytest.mark.parametrize(
    ("exterior", "holes", "message"),
    [
        (SQUARE[:2], (), "three different corners"),
        (SQUARE * np.nan, (), "finite"),
        (SQUARE[[0, 2, 1, 3]], (), r"crosses itself at \(1000, 500\) mm"),
        (np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), (), "no area"),
        (SQUARE, (HOLE + 1.7,), "crossed or touched by a hole"),
        (SQUARE, (HOLE + 5.0,), "crossed or touched by a hole"),
        (SQUARE, (HOLE, HOLE + 0.1), "crossed or touched by a hole"),
    ],
)
def test_refused(exterior: np.ndarray, holes: tuple[np.ndarray, ...], message: str) -> None:
    """Oracle: one line that says what and where."""
    with pytest.raises(OutlineError, match=message) as caught:
        Outline(exterior, holes)
    assert "\n" not in str(caught.value)
