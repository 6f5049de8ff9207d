from types import SimpleNamespace

import numpy as np
import pytest
import shapely
from kit_plans import change_plan, make_plan
from plush_robots import drawn_body, plush_robot

from hydrostat.fabrication import MOTORS, PartOptions, PatternOptions, plush_pattern
from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.parts.winch_unit import winch_units
from hydrostat.fabrication.passage import _find_stuck, _warning, find_open_seam, find_passage_warnings
from hydrostat.fabrication.patterns.opening import ZIPPERS, opening_at
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import Layer, PatternPart
from hydrostat.robot import Cable, Mount, Robot, Winch

WIDE = "M0 0H290V120H0Z"


def with_winches(path: str, *places: tuple[float, float]) -> Robot:
    """A body with winches in some places, each with a short cable."""
    at = [(1e-3 * x, 1e-3 * y) for x, y in places]
    winches = [Winch(name=f"w{i}", at=place) for i, place in enumerate(at)]
    cables = [Cable(winch=f"w{i}", points=((x, y), (0.9 * x + 0.01, 0.4 * y))) for i, (x, y) in enumerate(at)]
    return plush_robot(drawn_body(path)).with_network(winches, cables)


def back_parts(pattern: Pattern, part: PatternPart) -> list:
    return [shape for shape in pattern.panel("back").shapes if shape.part is part]


@pytest.mark.parametrize(
    ("places", "length"),
    [([(0, 0)], 100), ([(-30, 0), (30, 0)], 150), ([(-60, 5), (0, 5), (60, 5)], 200), ([(-130, 0), (130, 0)], 250)],
)
def test_the_zipper_is_one_that_is_sold(places, length):
    """Oracle: the row of winches and 30 mm beyond, rounded up by hand; 270 mm are free, so 320 become 250."""
    pattern = plush_pattern(with_winches(WIDE, *places))
    (slit,) = back_parts(pattern, PatternPart.OPENING)
    assert slit.layer is Layer.CUT
    assert slit.geometry.length == pytest.approx(length)
    assert pattern.opening is not None
    assert pattern.opening.label == f"zipper {length} mm"
    assert length in ZIPPERS
    (box,) = back_parts(pattern, PatternPart.ZIPPER)
    assert shapely.Polygon(box.points).area == pytest.approx((length + 8) * 8)
    assert box.layer is Layer.MARK


@pytest.mark.parametrize("places", [[(-120, 40)], [(130, -50)], [(-100, -40), (110, 45)], [(0, 0), (0, 30)]])
def test_the_slit_stays_inside_and_reaches_the_winches(places):
    """Oracle: shapely: the placket lies in the seam, the slit not farther from the winches' middle than its inset."""
    pattern = plush_pattern(with_winches(WIDE, *places))
    (slit,), (box,) = back_parts(pattern, PatternPart.OPENING), back_parts(pattern, PatternPart.ZIPPER)
    seam = shapely.Polygon(back_parts(pattern, PatternPart.SEAM)[0].points)
    assert seam.contains(shapely.Polygon(box.points))
    assert seam.exterior.distance(slit.geometry) > 10 - 1e-6
    middle = pattern.panel("back").on_sheet(tuple(1e-3 * np.mean(places, axis=0)))
    assert slit.geometry.distance(shapely.Point(middle)) < 12


def test_the_slit_keeps_off_pinholes_on_the_back():
    """Oracle: distances: without the option the slit runs over the exit of the cable, with it the placket is off."""
    robot = plush_robot(drawn_body(WIDE), [(-20, 0), (-40, 0), (-60, 0), (-80, 0), (-100, 0)])
    plain, careful = (plush_pattern(robot, options=PatternOptions(back_pinholes=back)) for back in (False, True))
    holes = [shape for shape in careful.panel("back").shapes if shape.part is PatternPart.PINHOLE]

    def gap(pattern: Pattern) -> float:
        box = shapely.Polygon(back_parts(pattern, PatternPart.ZIPPER)[0].points)
        return min(box.distance(shapely.Point(hole.center)) - hole.radius for hole in holes)

    assert gap(plain) < 0
    assert gap(careful) > 1.49


def test_a_short_slit_is_moved_between_the_pinholes_and_nearer_to_the_seam():
    """Oracle: a bar of 190 x 30 mm with a row of holes at 5 mm from its axis has 150 mm free on the other side."""
    robot = plush_robot(drawn_body("M0 0H190V30H0Z"), [(-70, 2), *((x, 10) for x in range(-55, 56, 22))], marker=(0, 0))
    pattern = plush_pattern(robot, options=PatternOptions(back_pinholes=True))
    (slit,), (box,) = back_parts(pattern, PatternPart.OPENING), back_parts(pattern, PatternPart.ZIPPER)
    assert slit.geometry.length == pytest.approx(100)
    seam = shapely.Polygon(back_parts(pattern, PatternPart.SEAM)[0].points)
    assert seam.contains(shapely.Polygon(box.points))
    assert not any("opening" in warning for warning in pattern.warnings)


def test_a_body_too_small_for_a_zipper_is_warned_of():
    """Oracle: a square of 60 mm has at most 40 mm of slit across and 57 mm along its diagonal."""
    robot = plush_robot(drawn_body("M0 0H60V60H0Z"), [(0, 0), (15, 20)], marker=(0, 0))
    pattern = plush_pattern(robot)
    assert pattern.opening is not None
    assert pattern.opening.slit.length < 57
    assert pattern.opening.label.startswith("zipper 100 mm cut to ")
    assert any("opening has room for" in warning for warning in pattern.warnings)
    assert not any("opening" in warning for warning in plush_pattern(with_winches(WIDE, (0, 0))).warnings)


def test_the_opening_lies_over_its_winches() -> None:
    """A torso with an arm, and a cable into the arm: the first slit beside it would be 25 mm off. Oracle: middles."""
    seam = shapely.union_all([shapely.box(-45, -60, 45, 60), shapely.box(-45, 25, 190, 60)])
    beside = seam.difference(shapely.LineString([(10, 0), (30, 30), (170, 35)]).buffer(4.0))
    found = opening_at([(10, 0), (10, 30)], seam, (), PatternOptions(), room=beside)
    assert found is not None
    middle = found.slit.interpolate(0.5, normalized=True)
    assert middle.distance(shapely.Point(10, 15)) < 0.25 * found.slit.length
    assert found.slit.length == pytest.approx(100.0)


def test_a_zipper_too_short_for_a_winch_is_told() -> None:
    """A slit opens to a ring of twice its length. Oracle: the girth 2 (27 + 39) of a box of 27 x 39 x 41 mm."""
    unit = SimpleNamespace(winch="left", mount=Mount.BODY, room=SimpleNamespace(size=(41.0, 27.0, 39.0)))

    assert _find_stuck([unit], 66.0) == ()
    assert _find_stuck([unit], 47.0) == (unit,)
    words = _warning(unit, 47.0)
    assert "Leave 80 mm of seam open" in words  # 66 mm and a tenth, in full tens
    assert 'unit of winch "left" (27 x 39 x 41 mm) does not pass through its opening of 47 mm (minimum 66 mm)' in words
    assert words.endswith("If no seam near it is so long, choose a smaller motor or spool")
    unit.mount = Mount.WORLD
    assert _find_stuck([unit], 47.0) == ()


def test_a_plush_without_a_zipper_takes_its_winches_through_the_seam() -> None:
    """The same winch passes through a zipper of 100 mm; where nothing is sewn, no zipper is missing."""
    robot = plush_robot(drawn_body(WIDE), [(0, 0), (40, 0)])
    units = winch_units(robot, PartOptions(), MOTORS[0])
    demand = Demand(poses=(), tensions=np.zeros(1), torques=np.zeros(1), taken=np.zeros((1, 2)))
    plan = make_plan(robot, demand, units=units)
    assert find_passage_warnings(plan) == ()
    for reach, told in ((30.0, 0), (0.0, 1)):
        sewn = change_plan(plan, pattern=plush_pattern(robot, options=PatternOptions(opening_reach=reach)))
        assert len(find_passage_warnings(sewn)) == told
    assert "has no zipper to pass through (minimum" in find_passage_warnings(sewn)[0]
    assert find_open_seam(sewn) > 0
