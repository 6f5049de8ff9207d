"""Labels beside points. Oracle: boxes of labels and of what they must not hide, which hide at most a tenth."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from hydrostat.plot.labels import Labels
from hydrostat.plot.sheet import PictureSheet

WORDS = ("thumb extensor +18.6 mm", "index flexor +24.6 mm", "ring flexor +38.0 mm", "little flexor +36.9 mm")


class Paper(PictureSheet):
    """A sheet of 800 by 400 points that keeps places of words."""

    boxes: list[np.ndarray]
    leaders: list[np.ndarray]

    def __init__(self) -> None:
        figure = Figure()
        super().__init__(figure, figure.add_subplot(), np.array([-400.0, -200.0]), np.array([400.0, 200.0]), 1.0)
        object.__setattr__(self, "boxes", [])
        object.__setattr__(self, "leaders", [])

    def curve(self, way: np.ndarray, **_: object) -> None:
        """Keep the line from a spool to its flag."""
        self.leaders.append(way)

    def text(self, place: tuple[float, float], words: str, **_: object) -> None:
        """Keep the box of a flag of 7 pt."""
        half = np.array([0.74 * len(words) + 1.2, 1.9]) * 7 / 2
        self.boxes.append(np.concatenate([place - half, place + half]))


def test_flags_hide_no_spools_and_no_flags() -> None:
    """Eight spools in two rows, near each other as on a base plate, with long names."""
    paper = Paper()
    labels = Labels(paper, rings=[], avoid=np.zeros((0, 2)))
    spools = [np.array([22.0 * column + 11 * row, 24.0 * row]) for row in range(2) for column in range(4)]
    for spool in spools:
        labels.reserve(spool, 18)
    labels.flags(np.array(spools), WORDS * 2, ["black"] * 8)
    boxes = [*paper.boxes, *(np.concatenate([spool - 9, spool + 9]) for spool in spools)]
    for index, one in enumerate(paper.boxes):
        for other in boxes[index + 1 :]:
            sides = np.minimum(one[2:], other[2:]) - np.maximum(one[:2], other[:2])
            smaller = min(np.prod(box[2:] - box[:2]) for box in (one, other))
            assert np.maximum(sides, 0.0).prod() < 0.1 * smaller


def test_flags_that_stay_are_placed_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: far spools, whose flags do not move when they are placed again."""
    placed, find = list[int](), Labels._find
    monkeypatch.setattr(Labels, "_find", lambda *args, **given: placed.append(1) or find(*args, **given))
    Labels(Paper(), rings=[], avoid=np.zeros((0, 2))).flags(
        np.array([(-200.0, 0.0), (200.0, 0.0)]), WORDS[:2], ["black"] * 2
    )
    assert len(placed) == 2 * 2


def test_lines_of_flags_do_not_cross() -> None:
    """Ten spools in two rows on a base plate, with long names. Oracle: signs of areas."""
    paper = Paper()
    labels = Labels(paper, rings=[], avoid=np.zeros((0, 2)))
    spools = [np.array([22.0 * column, 40.0 * row]) for column in range(5) for row in range(2)]
    for spool in spools:
        labels.reserve(spool, 18)
    labels.flags(np.array(spools), (WORDS * 3)[:10], ["black"] * 10)

    def lies_left(line: np.ndarray, point: np.ndarray) -> bool:
        (ax, ay), (bx, by) = line[1] - line[0], point - line[0]
        return bool(ax * by > ay * bx)

    def cross(one: np.ndarray, other: np.ndarray) -> bool:
        return all(lies_left(a, b[0]) != lies_left(a, b[1]) for a, b in ((one, other), (other, one)))

    leaders = paper.leaders
    assert len(leaders) == 10
    assert not [1 for index, one in enumerate(leaders) for other in leaders[:index] if cross(one, other)]
