"""Strength of lines against tensions."""

from dataclasses import replace

import numpy as np
import pytest
from small_inputs import square

from hydrostat.errors import InputError
from hydrostat.fabrication.lists.line import KNOT, LINES, SAFETY, FishingLine, check_line, line_for
from hydrostat.fabrication.weak_lines import find_weak_lines
from hydrostat.robot import CableSide

TEN = FishingLine(name="ten", diameter=0.3, pounds=10 / 4.448222)
"""A line that breaks at 10 N."""


def test_strength_of_a_line() -> None:
    assert TEN.strength == pytest.approx(10)
    assert TEN.working_load == pytest.approx(10 * KNOT * SAFETY)


def test_thicker_lines_are_stronger() -> None:
    assert list(LINES) == sorted(LINES, key=lambda line: line.diameter)
    assert list(LINES) == sorted(LINES, key=lambda line: line.strength)


def test_a_pose_names_the_cables_that_break() -> None:
    """Oracle: half of 80 lb at the knot, 178 N; pairs share a pull."""
    (told,) = find_weak_lines(square(), np.array([200.0]))
    assert "pulls 200.0 N, but PE 6, 80 lb breaks at its knot at 178 N" in told
    assert find_weak_lines(square(), np.array([170.0])) == ()
    assert find_weak_lines(replace(square(), face=CableSide.PAIRS), np.array([200.0])) == ()


def test_no_line_is_stronger_than_its_fibres() -> None:
    area = [np.pi / 4 * line.diameter**2 for line in LINES]  # gel-spun polyethylene breaks at 3.6 GPa at most
    assert all(line.strength / each < 3600 for line, each in zip(LINES, area, strict=True))


def test_the_line_that_is_advised_fits() -> None:
    assert line_for(0.4).diameter == pytest.approx(0.405)  # a label is no more precise
    assert line_for(0.3).diameter == 0.285
    assert line_for(0.01) is LINES[0]


@pytest.mark.parametrize(("tension", "problems", "warnings"), [(2.4, 0, 0), (2.6, 0, 1), (4.9, 0, 1), (5.1, 1, 0)])
def test_who_breaks_and_who_is_overloaded(tension: float, problems: int, warnings: int) -> None:
    check = check_line(square(), np.array([tension]), TEN)
    assert (len(check.problems), len(check.warnings)) == (problems, warnings)
    for sentence in (*check.problems, *check.warnings):
        assert f"{tension:.1f} N" in sentence
        assert 'C1 of winch "pull"' in sentence
        assert "PE 1, 15 lb" in sentence


def test_a_stopper_that_may_slip_is_knotted() -> None:
    assert check_line(square(), np.array([2.0]), TEN, hold=2.1).warnings == ()
    check = check_line(square(), np.array([2.2]), TEN, hold=2.1)
    assert "its stopper may slip at 2 N" in check.warnings[0]
    assert tuple(row.verdict for row in check.table.rows) == ("holds; knot the stopper",)


def test_no_line_for_a_crane() -> None:
    (sentence,) = check_line(square(), np.array([1e4]), TEN).problems
    assert "No listed line" in sentence


def test_tensions_of_another_robot_are_refused() -> None:
    with pytest.raises(InputError, match="2 tensions given for 1 cables"):
        check_line(square(), np.ones(2), TEN)


@pytest.mark.parametrize(("name", "mass"), [("PE 1, 15 lb", 1.5), ("PE 2, 25 lb", 2.5), ("PE 6, 80 lb", 5.0)])
def test_a_line_is_stretched_within_its_working_load(name: str, mass: float) -> None:
    """Oracle: the working loads 16.7, 27.8 and 89 N, divided by 9.81 m/s^2; 5 kg at most."""
    (line,) = [line for line in LINES if line.name == name]
    assert line.stretch_mass == mass


@pytest.mark.parametrize(("hold", "words"), [(2.1, "the stopper slips first, at about 2 N"), (5.1, ""), (None, "")])
def test_the_list_says_what_gives_way_first(hold: float | None, words: str) -> None:
    """Oracle: a line that breaks at its knot at 5 N."""
    notes = " ".join(check_line(square(), np.array([1.0]), TEN, hold=hold).table.notes)
    assert ("slips first" in notes) == bool(words)
    assert words in notes
