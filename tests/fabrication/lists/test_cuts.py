"""Cables and tubes to cut: lengths against the simulation, each with what is laid on and where it goes."""

import math
from dataclasses import replace

import pytest
from small_inputs import square

from hydrostat.fabrication.lists.cuts import (
    KNOT,
    STEP,
    cable_cuts,
    cable_table,
    check_lengths,
    check_sheaths,
    sheath_cuts,
    sheath_table,
)
from hydrostat.robot import Cable
from hydrostat.simulation import Simulation

START = (-0.02, -0.01)
TAIL = 80.0  # line beyond the stopper [mm]


def test_sum_of_a_cable_of_known_points() -> None:
    cable = Cable(winch="pull", points=(START, (0.01, 0.03), (0.04, 0.03)), slack=0.007)
    (cut,) = cable_cuts(
        square(cable, spool_radius=0.005, release=0.01), leads={0: 12.0}, outside={0: 300.0}, spare_wraps=2.0, tail=TAIL
    )
    assert cut.body == pytest.approx(50 + 30)  # a triangle of 30, 40, 50 and a straight piece
    assert cut.wraps == pytest.approx(20 * math.pi)
    assert cut.length == pytest.approx(80 + 7 + 300 + 12 + 20 * math.pi + 10 + KNOT + TAIL)
    assert cut.spool_mark == pytest.approx(TAIL + 7 + 80 + 300 + 12)
    assert cut.length <= cut.cut_length < cut.length + STEP
    assert cut.cut_length % STEP == 0


def test_in_the_body_the_spool_is_where_the_cable_is_counted_from():
    """Oracle: the body's length is counted from the shaft, so the way from the exit to the spool is in it already."""
    (cut,) = cable_cuts(square(), leads={0: 12.0}, outside={}, spare_wraps=2.0, tail=TAIL)
    assert cut.spool_mark == pytest.approx(TAIL + 80)


def test_the_table_tells_no_mark_more_precisely_than_it_is_known():
    """Oracle: where the stopper goes is a matter of the robot, not of the list."""
    table = cable_table(cable_cuts(square(), leads={0: 12.3}, outside={0: 7.7}, spare_wraps=2.0, tail=TAIL))
    titles = [column.title for column in table.columns.values()]
    assert {"cable", "cut to", "slack", "spool mark from end", "body"} <= set(titles)
    assert not any("stopper" in title or "exit" in title for title in titles)
    numbers = dict(zip(titles, table.texts[0], strict=True))
    assert numbers["spool mark from end"] == f"{TAIL + 80 + 20:.0f}"
    told = " ".join(table.notes)
    assert "winch at zero" in told
    assert "last hole" in told
    assert "about" in told


def test_a_stepped_spool_has_its_own_wraps_and_release() -> None:
    cable = Cable(winch="pull", points=(START, (0.01, 0.03)), spool_radius=0.009)
    (cut,) = cable_cuts(
        square(cable, spool_radius=0.006, release=0.01), leads={}, outside={}, spare_wraps=3.0, tail=TAIL
    )
    assert cut.wraps == pytest.approx(3 * 2 * math.pi * 9)
    assert cut.release == pytest.approx(15)


def test_a_reversed_cable_lets_out_what_its_winch_takes_in() -> None:
    cable = Cable(winch="pull", points=(START, (0.01, 0.03)), reverse=True, spool_radius=0.009)
    robot = square(cable, spool_radius=0.006, release=0.01)
    cuts = cable_cuts(robot, leads={}, outside={}, spare_wraps=3.0, tail=TAIL)
    assert cuts[0].release == pytest.approx(1.5e3 * robot.winches[0].travel)
    assert "C1" in cable_table(cuts).notes[-1]


def test_columns_add_up_to_the_total() -> None:
    robot = square(Cable(winch="pull", points=(START, (0.01, 0.03)), slack=0.003), release=0.004)
    table = cable_table(cable_cuts(robot, leads={0: 9.0}, outside={0: 40.0}, spare_wraps=2.0, tail=TAIL))
    parts = ("body", "slack", "outside", "lead", "wraps", "release", "knot", "tail")
    numbers = dict(zip(table.headings, table.texts[0], strict=True))
    assert sum(float(numbers[f"{part} [mm]"]) for part in parts) == pytest.approx(float(numbers["total [mm]"]), abs=0.3)


def test_lengths_are_those_of_the_simulation_and_others_are_caught() -> None:
    cable = Cable(winch="pull", points=(START, (0.0, 0.0), (0.01, 0.03), (0.04, 0.03)), sheathed=((0, 1),))
    robot = square(cable)
    cuts = cable_cuts(robot, leads={}, outside={}, spare_wraps=2.0, tail=TAIL)
    assert check_lengths(cable_table(cuts), Simulation(robot)).passed
    wrong = cable_table((replace(cuts[0], body=cuts[0].body + 1.3),))
    check = check_lengths(wrong, Simulation(robot))
    assert not check.passed
    assert float(check.measured.split()[2]) == pytest.approx(1.3, abs=0.06)


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
    assert [(row.start, row.end) for row in table.rows[:-1]] == [("1 (winch)", "2"), ("3", "5 (stopper)")]
    assert tuple(row.length for row in table.rows) == pytest.approx((55.0, 100.0, 155.0))
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
    wrong = sheath_table(robot, (replace(found[0], run=found[0].run + 1.2), *found[1:]), bore=1.0, tube=2.0)
    check = check_sheaths(wrong, Simulation(robot), outside={0: 300.0})
    assert not check.passed
    assert "1.200 mm" in check.measured
