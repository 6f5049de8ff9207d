"""A small map for each cable, and the marks of winches. Oracles: the words and the colors of the SVG."""

import re
from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot
from kit_plans import change_plan, make_plan

from hydrostat.drawing import Canvas, Color
from hydrostat.fabrication import Demand
from hydrostat.fabrication.kit_options import Method, PatternOptions
from hydrostat.fabrication.patterns.skin import flat_skin
from hydrostat.fabrication.patterns.stitches import cable_stitches
from hydrostat.fabrication.sheets.assembly_sheet import _single_maps
from hydrostat.fabrication.sheets.cable_map import flat_map
from hydrostat.fabrication.sheets.legible import note_lines
from hydrostat.fabrication.sheets.map_layout import LabelPlaces, best_views, body_solid
from hydrostat.fabrication.sheets.single_maps import single_maps
from hydrostat.fabrication.sheets.solid_pictures import portrait
from hydrostat.fabrication.winch_marks import marked_name, winch_marks_of
from hydrostat.robot import Robot


def words(svg: str) -> list[str]:
    return re.findall(r">([^<>]+)</text>", svg)


def stitched(name: str) -> tuple[Robot, tuple]:
    robot = gallery_robot(name)
    return robot, cable_stitches(robot, flat_skin(robot.body, PatternOptions()).seam)


def renamed(robot: Robot, names: list[str]) -> Robot:
    known = dict(zip((winch.name for winch in robot.winches), names, strict=True))
    winches = [replace(winch, name=known[winch.name]) for winch in robot.winches]
    return robot.with_network(winches, [replace(cable, winch=known[cable.winch]) for cable in robot.cables])


@pytest.mark.slow
def test_a_foam_hand_has_a_map_for_each_cable(unchecked: None) -> None:
    """Oracle: the titles; a body with few cables has one map of all."""
    robot = gallery_robot("cupping_hand")
    views = best_views(robot, body_solid(robot))
    plan = make_plan(robot, Demand.of_results(robot, []), method=Method.FOAM)
    pages = _single_maps(plan, views)
    told = [word for page in pages for word in words(page.svg)]
    titles = [word for word in told if " from " in word]
    assert [title.split()[0] for title in titles] == [f"C{number}" for number in range(1, 11)]
    sides = [title.rpartition(", ")[2] for title in titles]
    assert {*sides[2::2]} == {"near side"}, "flexors of fingers"
    assert {*sides[3::2]} == {"far side"}, "extensors of fingers"
    assert [sum(" from " in word for word in words(page.svg)) for page in pages] == [5, 5]
    few = robot.with_network(robot.winches[:6], robot.cables[:6])
    assert _single_maps(change_plan(plan, robot=few), views) == []


def test_a_winch_has_one_mark_everywhere() -> None:
    """Those whose names are numbers keep these, in whatever order they stand."""
    robot = gallery_robot("starfish")
    assert winch_marks_of(robot) == {"right": "W1", "left": "W2", "feet": "W3"}
    crossed = renamed(robot, ["winch_2", "winch_3", "winch_1"])
    assert winch_marks_of(crossed) == {"winch_2": "W2", "winch_3": "W3", "winch_1": "W1"}
    assert marked_name(crossed, "winch_2") == "W2 winch_2"
    assert winch_marks_of(renamed(robot, ["a1", "b1", "c"])) == {"a1": "W1", "b1": "W2", "c": "W3"}
    assert note_lines(('winch "left" is hot',), (), robot) == ['Winch W2 "left" is hot.']


def test_the_map_tells_cables_apart() -> None:
    """A color for each, and the cable's name at the first and the last hole that is numbered."""
    robot, stitches = stitched("starfish")
    svg = flat_map(robot, stitches, width=112.0, height=119.0).svg
    assert all(color in svg for color in Color.WINCHES[: len(robot.cables)])
    assert {f"C{number}-2" for number in range(1, 6)} <= set(words(svg))


def test_an_eye_is_on_every_picture_that_shows_the_front() -> None:
    """Oracle: the same pictures without it have its line less."""
    bare, stitches = stitched("starfish")
    eye = 0.005 * np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (1.0, 0.0)])
    seeing = replace(bare, body=replace(bare.body, marks=(eye,)))

    def drawn(robot: Robot) -> list[int]:
        pages = single_maps(robot, stitches, width=182.0, height=235.0)
        map_of_all = flat_map(robot, stitches, width=112.0, height=119.0)
        return [
            canvas.svg.count("<path") for canvas in (map_of_all, portrait(robot, None, width=60.0, height=60.0), *pages)
        ]

    more = np.subtract(drawn(seeing), drawn(bare)).tolist()
    assert more[:2] == [1, 1]
    assert more[2] == len(bare.cables), "one in each small map"


@pytest.mark.parametrize(("name", "pages"), [("starfish", 1), ("squid", 1), ("pig", 0)])
def test_each_cable_has_a_map_with_all_of_its_numbers(name: str, pages: int) -> None:
    robot, stitches = stitched(name)
    found = single_maps(robot, stitches, width=182.0, height=235.0)
    assert len(found) == pages
    said = [word for canvas in found for word in words(canvas.svg)]
    if pages:
        marks = winch_marks_of(robot)
        titles = [f"C{number} from {marks[cable.winch]}" for number, cable in enumerate(robot.cables, start=1)]
        assert [word for word in said if " from " in word] == titles
        assert said.count("2") + said.count("3") >= len(robot.cables)
        assert max(canvas.height for canvas in found) <= 235.0


def test_a_line_to_a_number_goes_round_other_labels() -> None:
    """Oracle: the line drawn by hand. A label stands to the right, places above and below are as free as behind it."""
    places, spot, size = LabelPlaces((0.0, 0.0, 100.0, 100.0)), (50.0, 50.0), (6.0, 2.0)
    for x, y in ((53.0, 50.0), (47.0, 50.0), (50.0, 47.0)):
        places.take_box((x - 2.5, y - 2.0, x + 2.5, y + 2.0))
    middle = places.beside(spot, size, gap=0.75, led=True)
    assert middle is not None
    assert middle[1] > 50.0
    end, start = places.lead(middle, size, spot)
    assert start == spot
    assert end[1] == pytest.approx(middle[1] - 1.0) or abs(end[0] - middle[0]) == pytest.approx(3.0)


def test_bold_words_are_wider() -> None:
    """Oracle: widths that typst measures in its font [em]: C1 1.22, C1 C2 2.69."""
    point = 25.4 / 72  # mm
    for words, measured in (("C1", 1.22), ("C1 C2", 2.69)):
        wide, _ = Canvas.text_size(words, 9.0, bold=True)
        assert measured * 9.0 * point <= wide <= 1.2 * measured * 9.0 * point
