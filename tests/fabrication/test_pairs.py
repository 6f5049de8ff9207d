"""Kits with cables on both faces. Oracles: the kit of one face doubled, drawings read back by another program."""

import csv
import io
import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold
from page_words import read_words
from plush_robots import SQUARE, crossed, drawn_body, plush_robot
from shapely import LineString

from hydrostat.design import BuildCost
from hydrostat.errors import InputError
from hydrostat.fabrication import MOTORS, Kit, KitOptions, Method, PatternOptions, build_kit
from hydrostat.fabrication.checks.pattern_checks import SeenSvg, pattern_checks
from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.spool import capacity, spool_turns
from hydrostat.fabrication.parts.winch_unit import WinchUnit, winch_units
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.pattern import Pattern, plush_pattern
from hydrostat.fabrication.patterns.shape import PatternPart
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.fabrication.sheets.legible import typeset
from hydrostat.fabrication.solids.construct import solid_of
from hydrostat.ik import IKOptions, solve_ik
from hydrostat.robot import CableSide, Robot, gallery_folder, get_material, load_robot, robot_hash, sewn_robot
from hydrostat.simulation import Simulation, solve_stuffed_motion


def starfish(face: CableSide | None) -> Robot:
    return replace(load_robot(gallery_folder("starfish")), face=face)


@pytest.fixture(scope="module")
def single(plush_kit: Kit) -> Kit:
    assert plush_kit.robot.face is None
    return plush_kit


@pytest.fixture(scope="module")
def pairs() -> Kit:
    return build_kit(starfish(CableSide.PAIRS))


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
    for name in ("stopper", "grommet"):
        assert printed[1][name] == 2 * printed[0][name]
    grooves = {unit.winch: [len(cables) for cables in unit.wound] for unit in _units(pairs)}
    assert grooves == {"right": [2], "left": [2, 2], "feet": [2, 2]}
    spools = [sum(part.count for part in kit.printed if part.name.startswith("spool")) for kit in (single, pairs)]
    assert spools == [3, 3]
    assert [row["cables"] for row in table(pairs, "motor_sizing")] == ["2", "4", "4"]
    assert (pairs.robot.face, len(pairs.robot.cables)) == (CableSide.PAIRS, 5)
    assert robot_hash(pairs.robot) in pairs.files["manifest.json"].decode()
    assert "Cables: 5 pairs on both faces, 10 to sew" in pairs.summary
    costs = [BuildCost.of_robot(kit.robot, []) for kit in (single, pairs)]  # a design prints the work of its kit
    assert [cost.holes for cost in costs] == [parts["grommet"] for parts in printed]
    steps = re.findall(r"(?:Cut|Stitch) the cables \((\d+) min\)", single.files["steps.txt"].decode())
    assert [sum(map(int, steps)), 2 * costs[0].minutes] == pytest.approx([costs[0].minutes, costs[1].minutes], abs=2.6)


def _units(kit: Kit) -> tuple[WinchUnit, ...]:
    motor = next(motor for motor in MOTORS if motor.key == kit.motor)
    return winch_units(sewn_robot(kit.robot), PartOptions(), motor)


@pytest.mark.slow
def test_a_pair_shares_a_groove_and_has_a_channel_each(pairs: Kit) -> None:
    """Oracle: as much line on the groove as both take; a tube of 2 mm in each seat, two that do not touch."""
    robot, options = sewn_robot(pairs.robot), PartOptions()
    for unit in _units(pairs):
        winch = robot.winch(unit.winch)
        turns = spool_turns(1e3 * (winch.travel + winch.release), 1e3 * winch.spool_radius, options.spare_wraps)
        for groove in unit.spool.grooves:
            length = 2 * turns * 2 * np.pi * groove.radius
            assert capacity(groove.width, groove.radius, options.cable, groove.layers) >= length
        exits = {way.cable: np.array(way.point) for way in unit.exits}
        for one, other in unit.wound:
            assert other == one + 5
            np.testing.assert_allclose(exits[one] - exits[other], (0, 0, options.tube + options.fit), atol=1e-9)
        box = solid_of(unit.housing.box())
        for way in unit.exits:
            angle = np.degrees(np.arctan2(way.direction[1], way.direction[0]))
            tube = (
                Manifold.cylinder(way.seat - 0.05, options.tube / 2, -1, 48).rotate((0, -90, 0)).rotate((0, 0, angle))
            )
            assert (box ^ tube.translate(way.point)).volume() < 1e-6


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
    shapes = [_centered(holes["front"][:, :2]), _centered(holes["back"][:, :2] * [-1, 1])]
    np.testing.assert_allclose(_sorted(shapes[0]), _sorted(shapes[1]), atol=2e-3)
    held = {check.what: check.passed for check in pairs.checks}
    assert held["pinholes of the back are where the 35 points of the simulated cables are"]
    assert all(held.values())


def _centered(places: np.ndarray) -> np.ndarray:
    return places - places.mean(axis=0)


def _sorted(places: np.ndarray) -> np.ndarray:
    return places[np.lexsort(np.round(places, 1).T)]


@pytest.mark.slow
def test_motors_are_asked_for_the_same_and_each_line_for_half(pairs: Kit) -> None:
    """Oracle: two equal cables beside each other share what one bore, at the same torque but for their stretch."""
    robot = starfish(CableSide.PAIRS)
    one, both = Demand.find(starfish(None)), Demand.find(sewn_robot(robot))
    np.testing.assert_allclose(both.tensions[:5], both.tensions[5:], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(both.torques, one.torques, rtol=0.03)


@pytest.mark.slow
def test_one_panel_is_warned_of_as_by_check(single: Kit, pairs: Kit) -> None:
    """Oracle: the warning of `hydrostat check --thorough`; without poses one without a length."""
    robot = single.robot
    commands = [solve_ik(Simulation(robot), pose, options=IKOptions(restarts=0)).pose for pose in robot.poses.values()]
    warning = solve_stuffed_motion(robot, [one.contractions for one in commands]).warning
    assert [words for words in single.warnings if "bend" in words] == [warning]
    assert not any("bend" in words for words in pairs.warnings)
    still = build_kit(replace(robot, poses={}))
    assert any(words.startswith("the cables are sewn on the front alone: they also bend") for words in still.warnings)


@pytest.mark.slow
def test_the_sheet_tells_of_pairs(pairs: Kit) -> None:
    words = read_words(pairs.files["assembly_sheet.pdf"])
    for told in (
        "10 cables in 5 pairs",
        "C1 C6",
        "Then the back panel, as its marks show: C6 to C10, each behind its twin",
        "Set the two cables of a pair (C1 with C6, and so on) equally tight",
        "the second behind it on the back",
    ):
        assert typeset(told) in words, told


def count(pattern: Pattern, panel: str, part: PatternPart) -> int:
    return sum(shape.part is part for shape in pattern.panel(panel).shapes)


@pytest.mark.parametrize(
    ("face", "front", "back"), [(None, 5, 0), (CableSide.FRONT, 5, 0), (CableSide.BACK, 0, 5), (CableSide.PAIRS, 5, 5)]
)
def test_holes_are_where_the_robot_says(face: CableSide | None, front: int, back: int) -> None:
    pattern = plush_pattern(replace(crossed(), face=face))
    assert [count(pattern, side, PatternPart.PINHOLE) for side in ("front", "back")] == [front, back]
    assert [count(pattern, side, PatternPart.STOPPER) for side in ("front", "back")] == [
        2 * bool(front),
        2 * bool(back),
    ]


def test_marks_of_the_back_are_those_of_the_front_mirrored() -> None:
    """Oracle: a point of the robot on either panel; numbers go on from those of the front."""
    robot = replace(crossed(), face=CableSide.PAIRS)
    pattern = plush_pattern(robot)
    for side in ("front", "back"):
        panel = pattern.panel(side)
        bars = [shape for shape in panel.shapes if shape.part is PatternPart.STOPPER]
        wanted = [panel.on_sheet(cable.points[-1]) for cable in robot.cables]
        away = [np.subtract(bar.geometry.centroid.coords[0], place) for bar, place in zip(bars, wanted, strict=True)]
        np.testing.assert_allclose(np.linalg.norm(away, axis=1), 2.5)
    assert [(sewn.cable, sewn.panel) for sewn in pattern.stitches] == [
        (1, "front"),
        (2, "front"),
        (3, "back"),
        (4, "back"),
    ]


def test_a_hole_that_is_missing_on_the_back_is_told() -> None:
    """Oracle: a drawing of one panel does for a robot of pairs on that panel only."""
    robot = replace(crossed(), face=CableSide.PAIRS)
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
    for face in (CableSide.FRONT, CableSide.PAIRS):
        pattern = plush_pattern(replace(plush_robot(drawn_body(wide), route), face=face))
        assert pattern.opening is not None
        found[face] = pattern.opening.slit.distance(LineString(route))
    assert found[CableSide.FRONT] == 0
    assert found[CableSide.PAIRS] > 4 - 1e-6


def test_the_middle_is_for_bodies_that_are_cast() -> None:
    robot = replace(crossed(), face=CableSide.MIDDLE)
    with pytest.raises(InputError, match="cables in the middle are held by nothing in loose filling"):
        plush_pattern(robot)
    told: Mapping[CableSide, tuple[str, ...]] = {
        face: build_kit(_foam(replace(robot, face=face)), options=KitOptions(method=Method.FOAM, force=True)).notes
        for face in (CableSide.MIDDLE, CableSide.PAIRS)
    }
    assert not any("cast body" in warning for warning in told[CableSide.MIDDLE])
    assert sum("in a cast body they run in the middle" in warning for warning in told[CableSide.PAIRS]) == 1


def _foam(robot: Robot) -> Robot:
    assert SQUARE in robot.body.content.decode()
    return replace(robot, body=replace(robot.body, material=get_material("flexfoam-it x")))
