"""Stitching order of flat and solid robots."""

import pytest
from shapely import box as rectangle
from small_inputs import box, given, square

from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.kit_plan import FoamNeeds
from hydrostat.fabrication.lists.lists import make_lists
from hydrostat.fabrication.lists.stitching import (
    NEEDLE,
    SKIN,
    CableDepths,
    close_warnings,
    deep_warnings,
    depth_table,
    plane_table,
    stitch_table,
)
from hydrostat.fabrication.patterns.stitches import cable_stitches
from hydrostat.robot import Cable

SEAM = rectangle(-50, -50, 50, 50)


def test_from_hole_to_hole_of_a_known_cable() -> None:
    robot = square(Cable(winch="pull", points=((-0.02, -0.01), (0.01, 0.03), (0.04, 0.03), (0.04, 0.01))))
    table = stitch_table(cable_stitches(robot, SEAM))
    assert tuple(row.point for row in table.rows) == ("1 (winch)", "2", "3", "4 (stopper)")
    assert tuple(row.gap for row in table.rows) == (None, *map(pytest.approx, (50.0, 30.0, 20.0)))
    assert tuple(row.along for row in table.rows) == tuple(map(pytest.approx, (0.0, 50.0, 80.0, 100.0)))
    assert table.rows[0].x == pytest.approx(-20)
    assert table.rows[1].y == pytest.approx(30)


def test_ways_go_out_and_in_by_turns_and_end_outside() -> None:
    for count in (2, 3, 4, 5):
        points = tuple((-0.02 + 0.01 * place, -0.01) for place in range(count))
        table = stitch_table(cable_stitches(square(Cable(winch="pull", points=points)), SEAM))
        ways = [row.way for row in table.rows]
        passes = [way for way in ways if way in ("in", "out")]
        assert passes == ["out", "in", "out", "in", "out"][: len(passes)]
        assert passes[-1] == "out"
        assert all(str(way).startswith("tie") for way in ways if way not in ("in", "out"))


def test_depths_in_a_box() -> None:
    robot = box((-0.05, 0.08, 0.08), (0.02, 0.08, 0.003), (0.1, 0.08, 0.05), (0.1, 0.08, 0.08), (0.15, 0.02, 0.08))
    table = depth_table(robot)
    assert tuple(row.depth for row in table.rows) == tuple(map(pytest.approx, (-50.0, 3.0, 50.0, 80.0, 20.0)))
    hows = ("outside the body", "sewn to the skin", "long needle", "tube laid before casting", "long needle")
    assert tuple(row.how for row in table.rows) == hows
    third = table.rows[2]
    assert [third.skin_x, third.skin_y, third.skin_z] == pytest.approx([100.0, 80.0, 0.0])
    assert SKIN < NEEDLE
    (warning,) = deep_warnings(table)
    assert "C1" in warning
    assert "80 mm" in warning


def test_a_tube_needs_no_needle() -> None:
    robot = box((-0.05, 0.08, 0.08), (0.02, 0.08, 0.08), (0.1, 0.08, 0.08), (0.15, 0.02, 0.08), sheathed=((0, 2),))
    table = depth_table(robot)
    assert tuple(row.how for row in table.rows) == ("outside the body", "in its tube", "end of its tube", "long needle")
    assert deep_warnings(table) == ()


def test_points_too_close_for_a_needle() -> None:
    robot = box((-0.05, 0.08, 0.08), (0.02, 0.08, 0.08), (0.021, 0.08, 0.08), (0.15, 0.02, 0.08))
    (warning,) = close_warnings(robot)
    assert warning.startswith("cable C1: some points are only 1.0 mm apart, too close for two stitches (minimum 2 mm)")


def test_a_flat_body_of_foam_has_its_points_in_the_plane() -> None:
    """Oracle: the points that were given, and a triangle of 30, 40, 50."""
    robot = square(Cable(winch="pull", points=((-0.02, -0.01), (0.01, 0.03), (0.04, 0.03))))
    table = plane_table(robot)
    assert tuple(row.point for row in table.rows) == ("1 (winch)", "2", "3 (stopper)")
    assert tuple(row.x for row in table.rows) == pytest.approx((-20.0, 10.0, 40.0))
    assert tuple(row.y for row in table.rows) == pytest.approx((-10.0, 30.0, 30.0))
    assert tuple(row.along for row in table.rows) == pytest.approx((0.0, 50.0, 80.0))
    assert "before you cast the body" in " ".join(table.notes)
    foam = FoamNeeds(volume=3e5, part_a=20.0, part_b=20.0)
    lists = make_lists(given(robot, method=Method.FOAM, foam=foam))
    assert lists.stitching is not None
    assert lists.stitching.texts == table.texts
    assert CableDepths.of(lists.stitching, 1) == CableDepths(drawn=("C1",))
