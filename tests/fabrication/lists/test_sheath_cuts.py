"""Pieces of tube, by closed forms."""

from dataclasses import replace

import pytest
from small_inputs import square

from hydrostat.fabrication.lists.cuts import check_sheaths, sheath_cuts, sheath_table
from hydrostat.robot import Cable
from hydrostat.simulation import Simulation

POINTS = ((-0.02, -0.01), (0.01, 0.03), (0.04, 0.03), (0.04, -0.03), (0.0, -0.03))
"""Segments of 50, 30, 60 and 40 mm."""


def cuts(sheathed: tuple[tuple[int, int], ...], seat: float = 0.0, outside: float = 0.0) -> list[tuple]:
    robot = square(Cable(winch="pull", points=POINTS, sheathed=sheathed))
    found = sheath_cuts(robot, seats={0: seat}, outside={0: outside})
    return [(cut.start, cut.end, pytest.approx(cut.length)) for cut in found]


def test_a_sheath_at_the_winch_has_a_seat_and_another_has_none() -> None:
    assert cuts(((0, 1), (2, 3)), seat=6.0) == [(0, 1, 56.0), (2, 3, 60.0)]


def test_sheaths_that_touch_or_overlap_are_one_piece() -> None:
    assert cuts(((0, 1), (1, 2))) == cuts(((0, 2), (0, 1))) == [(0, 2, 80.0)]


def test_tube_from_the_base_goes_on_in_the_body_or_ends_at_it() -> None:
    assert cuts(((0, 1),), seat=6.0, outside=300.0) == [(None, 1, 356.0)]
    assert cuts(((2, 3),), seat=6.0, outside=300.0) == [(None, 0, 306.0), (2, 3, 60.0)]
    assert cuts((), outside=300.0) == [(None, 0, 300.0)]


def test_the_table_ends_with_its_total() -> None:
    robot = square(Cable(winch="pull", points=POINTS, sheathed=((0, 1), (2, 4))))
    found = sheath_cuts(robot, seats={0: 5.0}, outside={})
    table = sheath_table(robot, found, bore=1.0, tube=2.0)
    assert [row[2:4] for row in table.rows[:-1]] == [("1 (winch)", "2"), ("3", "5 (stopper)")]
    assert table.column("cut to") == pytest.approx((55.0, 100.0, 155.0))
    assert sheath_table(robot, (), bore=1.0, tube=2.0).rows == ()
    assert any("from its shaft" in note for note in table.notes)
    assert not any("from the base" in note for note in table.notes)
    outside = sheath_table(robot, sheath_cuts(robot, seats={}, outside={0: 200.0}), bore=1.0, tube=2.0)
    assert any("from the base" in note for note in outside.notes)


def test_tubes_are_what_the_simulation_holds_and_others_are_caught() -> None:
    robot = square(Cable(winch="pull", points=POINTS, sheathed=((0, 1), (2, 3))))
    found = sheath_cuts(robot, seats={0: 5.0}, outside={0: 300.0})
    table = sheath_table(robot, found, bore=1.0, tube=2.0)
    assert check_sheaths(table, Simulation(robot), outside={0: 300.0}).passed
    assert not check_sheaths(table, Simulation(robot), outside={}).passed
    wrong = sheath_table(robot, (replace(found[0], run=found[0].run + 0.2), *found[1:]), bore=1.0, tube=2.0)
    check = check_sheaths(wrong, Simulation(robot), outside={0: 300.0})
    assert not check.passed
    assert "0.200 mm" in check.measured
