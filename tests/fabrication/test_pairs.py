"""Kits with cables on both faces. Oracles: the kit of one face doubled, drawings read back by another program."""

import csv
import io
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from plush_robots import SQUARE, crossed, drawn_body, plush_robot
from shapely import LineString

from hydrostat.errors import InputError
from hydrostat.fabrication import Kit, KitOptions, Method, PatternOptions, build_kit
from hydrostat.fabrication.checks.pattern_checks import SeenSvg, pattern_checks
from hydrostat.fabrication.demand import find_demand
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.pattern import Pattern, plush_pattern
from hydrostat.fabrication.patterns.shape import Circle, PatternPart
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.fabrication.sheets.legible import typeset
from hydrostat.robot import Face, Robot, gallery_folder, load_robot, robot_hash, sewn_robot


def starfish(face: str | None) -> Robot:
    return replace(load_robot(gallery_folder("starfish")), face=face)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def single() -> Kit:
    return build_kit(starfish(None))


@pytest.fixture(scope="module")
def pairs() -> Kit:
    return build_kit(starfish("pairs"))


def table(kit: Kit, name: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(kit.files[f"lists/{name}.csv"].decode("utf-8-sig"))))


def item(kit: Kit, what: str) -> dict[str, str]:
    return next(row for row in table(kit, "bill_of_materials") if what in (row["what"], row["specification"]))


@pytest.mark.slow
def test_lists_of_pairs_are_those_of_one_face_twice(single: Kit, pairs: Kit) -> None:
    """Oracle: the list of cables of the single kit, written down twice, but for the longer way within the winch."""
    parts = ("body [mm]", "slack [mm]", "wraps [mm]", "release [mm]", "knot [mm]", "tail [mm]")
    one, both = ([[row["winch"], *map(row.get, parts)] for row in table(kit, "cable_cuts")] for kit in (single, pairs))
    assert both == [*one, *one]
    assert [row["cable"] for row in table(pairs, "cable_cuts")] == [f"C{number}" for number in range(1, 11)]
    line = [float(item(kit, "braided fishing line")["quantity"]) for kit in (single, pairs)]
    assert line[1] == pytest.approx(2 * line[0], rel=0.02)
    printed = [{part.name: part.count for part in kit.printed} for kit in (single, pairs)]
    for name in ("stopper_base", "stopper_lid", "grommet"):
        assert printed[1][name] == 2 * printed[0][name]
    spools = [sum(part.count for part in kit.printed if part.name.startswith("spool")) for kit in (single, pairs)]
    assert spools == [3, 3]
    assert [row["cables"] for row in table(pairs, "motor_sizing")] == ["2", "4", "4"]
    assert (pairs.robot.face, len(pairs.robot.cables)) == (Face.PAIRS, 5)
    assert robot_hash(pairs.robot) in pairs.files["manifest.json"].decode()
    assert "Cables: 10, on both faces, in pairs" in pairs.summary


@pytest.mark.slow
def test_both_panels_are_sewn_alike(single: Kit, pairs: Kit) -> None:
    """Oracle: rows of the single kit, with the panel and the numbers of the twins."""
    one, both = table(single, "stitching"), table(pairs, "stitching")
    twins = [{**row, "cable": f"C{int(row['cable'][1:]) + 5}", "panel": "back"} for row in one]
    assert both == [*one, *twins]
    assert {row["panel"] for row in one} == {"front"}


@pytest.mark.slow
def test_the_back_panel_read_back_has_the_holes_of_the_front_mirrored(single: Kit, pairs: Kit) -> None:
    holes = {
        side: SeenSvg(pairs.files["pattern/pattern.svg"]).circles(PatternPart.PINHOLE, panel=side)
        for side in ("front", "back")
    }
    alone = SeenSvg(single.files["pattern/pattern.svg"])
    assert len(alone.circles(PatternPart.PINHOLE, panel="back")) == 0
    assert len(holes["front"]) == len(holes["back"]) == len(alone.circles(PatternPart.PINHOLE))
    shapes = [_centred(holes["front"][:, :2]), _centred(holes["back"][:, :2] * [-1, 1])]
    np.testing.assert_allclose(_sorted(shapes[0]), _sorted(shapes[1]), atol=2e-3)
    held = {check.what: check.passed for check in pairs.checks}
    assert held["pinholes of the back are where the 35 points of the simulated cables are"]
    assert all(held.values())


def _centred(places: np.ndarray) -> np.ndarray:
    return places - places.mean(axis=0)


def _sorted(places: np.ndarray) -> np.ndarray:
    return places[np.lexsort(np.round(places, 1).T)]


@pytest.mark.slow
def test_motors_are_asked_for_the_same_and_each_line_for_half(pairs: Kit) -> None:
    """Oracle: two equal cables beside each other share what one bore, at the same torque but for their stretch."""
    robot = starfish("pairs")
    one, both = find_demand(starfish(None)), find_demand(sewn_robot(robot))
    np.testing.assert_allclose(both.tensions[:5], both.tensions[5:], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(both.torques, one.torques, rtol=0.03)
    assert not any("alone" in warning for warning in pairs.warnings)


@pytest.mark.slow
def test_the_sheet_tells_of_pairs(pairs: Kit) -> None:
    from test_kit import words_of

    words = words_of(pairs.files["assembly_sheet.pdf"])
    for told in (
        "10 cables in 5 pairs",
        "C1 C6",
        "Then the back panel, as its marks show: C6 to C10, each behind its twin",
        "Set the two of a pair (C1 with C6, and so on) equally tight",
        "the second behind it on the back",
    ):
        assert typeset(told) in words, told


def count(pattern: Pattern, panel: str, part: PatternPart) -> int:
    return sum(shape.part is part for shape in pattern.panel(panel).shapes)


@pytest.mark.parametrize(("face", "front", "back"), [(None, 5, 0), ("front", 5, 0), ("back", 0, 5), ("pairs", 5, 5)])
def test_holes_are_where_the_robot_says(face: str | None, front: int, back: int) -> None:
    pattern = plush_pattern(replace(crossed(), face=face))
    assert [count(pattern, side, PatternPart.PINHOLE) for side in ("front", "back")] == [front, back]
    assert [count(pattern, side, PatternPart.STOPPER) for side in ("front", "back")] == [
        2 * bool(front),
        2 * bool(back),
    ]
    alone = [warning for warning in pattern.warnings if "alone" in warning]
    assert len(alone) == (face != "pairs")
    if face != "pairs":
        assert alone[0].startswith(f"the cables are sewn on the {face or 'front'} alone")


def test_marks_of_the_back_are_those_of_the_front_mirrored() -> None:
    """Oracle: a point of the robot on either panel; numbers go on from those of the front."""
    robot = replace(crossed(), face="pairs")
    pattern = plush_pattern(robot)
    for side in ("front", "back"):
        panel = pattern.panel(side)
        rings = [shape for shape in panel.shapes if isinstance(shape, Circle) and shape.part is PatternPart.STOPPER]
        wanted = [panel.on_sheet(cable.points[-1]) for cable in robot.cables]
        np.testing.assert_allclose([ring.centre for ring in rings], wanted)
    assert [(sewn.cable, sewn.panel) for sewn in pattern.stitches] == [
        (1, "front"),
        (2, "front"),
        (3, "back"),
        (4, "back"),
    ]


def test_a_hole_that_is_missing_on_the_back_is_told() -> None:
    """Oracle: a drawing of one panel does for a robot of pairs on that panel only."""
    robot = replace(crossed(), face="pairs")
    drawn = plush_pattern(crossed())  # the front alone
    files = pattern_svg(drawn), pattern_dxf(drawn)
    passed = {check.what: check.passed for check in pattern_checks(robot, drawn, *files, PatternOptions())}
    assert passed["pinholes of the front are where the 6 points of the simulated cables are"]
    assert not passed["pinholes of the back are where the 6 points of the simulated cables are"]


def test_the_zipper_keeps_off_the_cables_of_the_back() -> None:
    """Oracle: shapely; where a cable runs along the row of winches, the slit moves beside it."""
    route = [(-20.0, 0.0), (0.0, 0.0), (30.0, 0.0)]
    wide = "M0 0H200V120H0Z"
    found = {}
    for face in ("front", "pairs"):
        pattern = plush_pattern(replace(plush_robot(drawn_body(wide), route), face=face))
        assert pattern.opening is not None
        found[face] = pattern.opening.slit.distance(LineString(route))
    assert found["front"] == 0
    assert found["pairs"] > 4 - 1e-6


def test_the_middle_is_for_bodies_that_are_cast() -> None:
    robot = replace(crossed(), face="middle")
    with pytest.raises(InputError, match="cables in the middle are held by nothing in loose filling"):
        plush_pattern(robot)
    told: Mapping[str, tuple[str, ...]] = {
        face: build_kit(_foam(replace(robot, face=face)), options=KitOptions(method=Method.FOAM, force=True)).warnings
        for face in ("middle", "pairs")
    }
    assert not any("cast body" in warning for warning in told["middle"])
    assert sum("a cast body has them in the middle" in warning for warning in told["pairs"]) == 1


def _foam(robot: Robot) -> Robot:
    assert SQUARE in robot.body.content.decode()
    return replace(robot, body=replace(robot.body, material="flexfoam-it x"))
