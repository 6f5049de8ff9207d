"""Steps on the shaft of a winch, wherever their radius counts. Oracle: radii by hand."""

from dataclasses import replace

import pytest
from builders import strip_robot

from hydrostat.errors import InputError
from hydrostat.fabrication.patterns.marks import winch_marks
from hydrostat.fabrication.patterns.shape import Circle
from hydrostat.plot import Stop, cable_table
from hydrostat.robot import Robot, find_risks


def stepped(radius: float | None, *, travel: float = 0.06) -> Robot:
    """A strip whose winches have spools of 6 mm, the upper cable, 180 mm long, one of its own."""
    robot = strip_robot()
    winches = [replace(robot.winches[0], travel=travel), robot.winches[1]]
    return robot.with_network(winches, [replace(robot.cables[0], spool_radius=radius), robot.cables[1]])


def test_ratios_and_the_largest_step() -> None:
    robot = stepped(0.015)
    assert robot.spool_ratios == pytest.approx([2.5, 1.0], rel=1e-15)
    assert [robot.largest_spool(winch) for winch in robot.winches] == [0.015, 0.006]
    small = stepped(0.003)
    assert small.spool_ratios == pytest.approx([0.5, 1.0], rel=1e-15)
    assert small.largest_spool(small.winches[0]) == 0.006
    assert strip_robot().with_network((), ()).spool_ratios.shape == (0,)


@pytest.mark.parametrize("factor", [0.25, 4.0])
def test_the_smallest_and_the_largest_step_are_allowed(factor: float) -> None:
    assert stepped(factor * 0.006).spool_ratios[0] == pytest.approx(factor)
    with pytest.raises(InputError, match=r"^cable\[0\].spool_radius must be from 1.5 mm to 24 mm, at most 4 times"):
        stepped(0.006 * factor**1.01)


def test_a_cable_begins_within_its_own_spool() -> None:
    """20 mm from its winch: more than twice 6 mm, less than twice 15 mm."""
    robot = stepped(0.015)
    upper = robot.cables[0]
    away = replace(upper, points=((upper.points[0][0] + 0.02, upper.points[0][1]), *upper.points[2:]))
    assert robot.with_network(robot.winches, [away, robot.cables[1]]).cables[0] == away
    with pytest.raises(InputError, match="a cable begins at its winch"):
        robot.with_network(robot.winches, [replace(away, spool_radius=None), robot.cables[1]])


def test_a_travel_that_is_longer_than_the_cable_of_a_larger_step() -> None:
    """80 mm at the winch are 200 mm on a spool 2.5 times as large; a shorter cable of the winch has room."""
    assert not any("longer than a cable" in risk for risk in find_risks(stepped(None, travel=0.08)))
    robot = stepped(0.015, travel=0.08)
    short = replace(robot.cables[0], name="short", points=robot.cables[0].points[:5], spool_radius=None)
    risks = find_risks(robot.with_network(robot.winches, [short, *robot.cables]))
    assert (
        "winch[0] up: the travel of 80 mm, 200 mm at its spool, is longer than a cable that it pulls "
        "(180 mm outside sheaths)"
    ) in risks


def test_a_film_stops_before_a_cable_is_taken_in() -> None:
    """Oracle: the contraction of a plain winch, divided by the ratio."""
    plain, steps = (Stop.for_winches(stepped(radius, travel=1.0))[0] for radius in (None, 0.015))
    assert steps.contractions[0] == pytest.approx(plain.contractions[0] / 2.5)


def test_the_cable_table_marks_cables_that_are_wound_the_other_way() -> None:
    robot = stepped(None)
    assert "winding" not in str(cable_table(robot))
    back = robot.with_network(robot.winches, [replace(robot.cables[0], reverse=True), robot.cables[1]])
    rows = str(cable_table(back)).split("<tr")
    assert ["reversed" in row for row in rows[-2:]] == [True, False]
    assert "usual" in rows[-1]


def test_pictures_and_patterns_show_the_step() -> None:
    from shapely import box

    marks = winch_marks(stepped(0.015), box(-1e3, -1e3, 1e3, 1e3))
    assert sorted(mark.radius for mark in marks if isinstance(mark, Circle)) == pytest.approx([6.0, 15.0])
    assert "spool radius" not in str(cable_table(stepped(None)))
    table = str(cable_table(stepped(0.015)))
    assert "spool radius [mm]" in table
    assert "15.0" in table
