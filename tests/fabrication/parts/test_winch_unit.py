"""Units of winches: true to the robot file, free of interference for every robot of the gallery."""

import math
from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot
from manifold3d import Manifold
from winch_robots import with_winches

from hydrostat.fabrication.checks.solid_checks import watertight_problems
from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.motor import MOTORS, Motor
from hydrostat.fabrication.parts.spool import capacity
from hydrostat.fabrication.parts.winch_unit import WinchUnit, find_crowded_units, winch_units
from hydrostat.fabrication.solids.assembly import PartAssembly, interferences
from hydrostat.robot import Cable, Mount, Robot, list_gallery

N20, XL330, POLOLU_25D = MOTORS


def units_of(robot: Robot, motor: Motor = N20, **options: float) -> tuple[WinchUnit, ...]:
    return winch_units(robot, PartOptions(**options), motor)


def thick(robot: Robot) -> Robot:
    """The same robot with a body of 120 mm, in which any unit has room."""
    return replace(robot, body=replace(robot.body, thickness=0.12))


def distinct(units: tuple[WinchUnit, ...]) -> list[WinchUnit]:
    """One unit of each kind."""
    return list({tuple(part.name for part in unit.printed): unit for unit in units}.values())


UNITS = [
    *((name, N20) for name in list_gallery()),
    *((name, motor) for motor in MOTORS[1:] for name in ("starfish", "puppy", "trunk", "caging_gripper")),
    ("squid", XL330),  # eight of a longer motor do not fit: see test_arrangement.py
]
"""Each robot with one motor; each other motor in flat bodies and at bases."""


@pytest.mark.parametrize(("name", "motor"), UNITS)
def test_units_of_the_gallery(name: str, motor: Motor, unchecked: None):
    """Oracle: boolean intersections, edges of the triangles in the files, closed form of what a spool takes."""
    robot = gallery_robot(name)
    units = units_of(robot, motor)
    assert [unit.winch for unit in units] == [winch.name for winch in robot.winches]
    assert [unit.problems for unit in units] == [()] * len(units)
    for unit in distinct(units):
        assert interferences(unit.assembly) == ()
        assert all(watertight_problems(part) == () for part in unit.printed)
    for unit in units:
        winch = robot.winch(unit.winch)
        for cable, groove in zip(unit.cables, unit.spool.grooves, strict=True):
            ratio = robot.spool_ratios[cable]
            spare = 2.0 * 2 * math.pi * groove.radius
            needed = 1e3 * ratio * (winch.travel + winch.release) + spare
            assert groove.radius == pytest.approx(1e3 * ratio * winch.spool_radius)
            assert groove.layers == 1
            assert capacity(groove.width, groove.radius, 0.4, 1) >= needed - 1e-9
    assert sorted(cable for unit in units for cable in unit.cables) == list(range(len(robot.cables)))


def test_a_spool_too_high_is_found():
    """The check of interference can fail: the spool half a millimeter higher."""
    (unit, *_) = units_of(gallery_robot("letter_s"))
    pieces = tuple(
        replace(piece, solid=piece.solid.translate((0, 0, 0.5 if piece.name.startswith("spool") else 0)))
        for piece in unit.assembly.pieces
    )
    assert {found.other for found in interferences(PartAssembly(name="high", pieces=pieces))} == {"housing_a"}


@pytest.mark.parametrize("motor", MOTORS, ids=lambda motor: motor.key)
@pytest.mark.parametrize("name", ["robot", "bear", "trunk"])
@pytest.mark.parametrize("back", [False, True], ids=["one way", "both ways"])
def test_exits_are_tangential_in_the_face_and_turn_as_they_are_wound(name: str, motor: Motor, back: bool):
    """Oracle: distance of a line from the axis, sign of the moment of each cable, a tube in its seat."""
    robot = gallery_robot(name)
    cables = [replace(cable, reverse=back and index % 2 == 1) for index, cable in enumerate(robot.cables)]
    for unit in units_of(robot.with_network(robot.winches, cables), motor):
        box = next(piece.solid for piece in unit.assembly.pieces if piece.name.startswith("housing"))
        for leaves, groove in zip(unit.exits, unit.spool.grooves, strict=True):
            (x, y, z), (u, v, w) = leaves.point, leaves.direction
            assert math.hypot(u, v, w) == pytest.approx(1.0)
            assert x * v - y * u == pytest.approx(-groove.radius if cables[leaves.cable].reverse else groove.radius)
            assert max(abs(x), abs(y)) == pytest.approx(unit.housing.half)
            assert x * u + y * v == pytest.approx(leaves.lead)
            tube = Manifold.cylinder(leaves.seat + 3, 1.0, -1, 24).translate((0, 0, -leaves.seat + 0.01))
            tube = tube.rotate((0, 90, math.degrees(math.atan2(v, u)))).translate((x, y, z))
            assert (box ^ tube).volume() < 1e-9


@pytest.mark.parametrize("motor", MOTORS, ids=lambda motor: motor.key)
def test_the_size_is_that_of_the_box_round_all_pieces(motor: Motor):
    """Oracle: boxes round the solids."""
    for name in ("starfish", "trunk"):
        for unit in units_of(gallery_robot(name), motor):
            boxes = np.array([piece.solid.bounding_box() for piece in unit.assembly.pieces])
            assert boxes[:, :3].min(axis=0) == pytest.approx(unit.room.low, abs=0.03)
            assert boxes[:, 3:].max(axis=0) == pytest.approx(unit.room.high, abs=0.03)
            assert unit.room.size == pytest.approx(np.subtract(unit.room.high, unit.room.low))


def test_a_radius_too_small_is_refused_with_the_least_there_is():
    robot = gallery_robot("letter_s")
    for motor, least in ((N20, 3.45), (XL330, 4.95), (POLOLU_25D, 3.95)):
        (unit,) = units_of(with_winches(robot, spool_radius=1e-3 * (least - 0.01)), motor)
        assert len(unit.problems) == len(unit.cables)
        assert f"has {least:.2f} mm, the minimum" in unit.problems[0]
        assert interferences(unit.assembly) == ()
        (unit,) = units_of(with_winches(robot, spool_radius=1e-3 * least), motor)
        assert unit.problems == ()
        assert interferences(unit.assembly) == ()


def test_long_travel_lies_in_layers_and_says_how_much_the_radius_grows():
    (unit,) = units_of(with_winches(gallery_robot("letter_s"), travel=0.8))
    layers = unit.spool.grooves[0].layers
    assert layers > 1
    grown = 100 * (layers - 1) * 0.4 / 6.0
    assert any(f"in {layers} layers" in text and f"{grown:.0f} % more" in text for text in unit.warnings)
    assert unit.problems == ()
    assert unit.spool.body <= 30.0
    spare = 2.0 * 2 * math.pi * 6
    for groove in unit.spool.grooves:
        assert capacity(groove.width, groove.radius, 0.4, layers) >= 800 + 10 + spare - 1e-9
    assert interferences(unit.assembly) == ()


@pytest.mark.parametrize(("travel", "widths", "layers"), [(22e-3, 3.0, 1), (35e-3, 3.35, 1), (40e-3, 2.0, 2)])
def test_grooves_are_narrower_where_that_saves_a_layer(travel: float, widths: float, layers: int) -> None:
    """Four pairs on one spool. Oracle: turns, two of them spare, at half a millimeter each, and four flanges."""
    robot = gallery_robot("starfish")
    (winch,) = with_winches(robot, travel=travel, release=0.0).winches[:1]
    pairs = [Cable(winch=winch.name, points=(winch.at, (0.005 * n, 0.02))) for n in (1, 2, 3, 4) for _ in "ab"]
    unit = units_of(thick(robot.with_network([winch], pairs)))[0]
    turns = 2 * (1e3 * travel / (2 * math.pi * 6.0) + 2.0)
    assert [groove.width for groove in unit.spool.grooves] == pytest.approx([widths] * 4)
    assert {groove.layers for groove in unit.spool.grooves} == {layers}
    assert widths * layers >= 0.5 * turns
    assert unit.spool.body <= 30.0
    assert bool(unit.warnings) == (layers > 1)
    assert interferences(unit.assembly) == ()


def test_a_thick_cable_lies_in_one_layer_on_a_longer_spool():
    options = PartOptions(cable=1.0, tube=4.0, bore=2.0, clearance=0.4, fit=0.25)
    robot = thick(gallery_robot("letter_s"))
    for motor in MOTORS:
        (unit,) = winch_units(robot, options, motor)
        assert unit.problems == ()
        assert {groove.layers for groove in unit.spool.grooves} == {1}
        assert interferences(unit.assembly) == ()


def test_more_than_a_spool_takes_is_refused():
    (unit,) = units_of(with_winches(gallery_robot("letter_e"), travel=20.0))
    assert any("do not fit on a spool" in text for text in unit.problems)


def test_a_shaft_too_short_for_thick_walls_is_refused():
    robot = thick(gallery_robot("letter_s"))
    (unit,) = units_of(with_winches(robot, spool_radius=0.012), wall=5.0)
    assert any("of the shaft" in text and "minimum 3.6 mm" in text for text in unit.problems)
    assert units_of(with_winches(robot, spool_radius=0.012), POLOLU_25D, wall=2.0)[0].problems == ()


def test_a_unit_stands_across_a_body_that_is_thick_enough_and_else_lies():
    robot = gallery_robot("starfish")
    assert [unit.across for unit in units_of(robot)] == [unit.room.size[2] <= 40.0 for unit in units_of(robot)]
    assert all(unit.place is not None and unit.place.across == unit.across for unit in units_of(robot))
    assert not any(unit.across for unit in units_of(robot, POLOLU_25D))


def test_cables_leave_an_upright_unit_as_they_go_on():
    """Oracle: angles between first segments, to the nearest quarter turn."""
    robot = gallery_robot("pig")
    (unit,) = units_of(robot)
    assert unit.across
    ends = [robot.cables[cable].points[:2] for cable in unit.cables]
    steps = [np.subtract(second, first) for first, second in ends]
    (x, y), (u, v) = steps
    turned = math.degrees(math.atan2(x * v - y * u, x * u + y * v))
    exits = math.degrees(math.atan2(*reversed(unit.exits[1].direction[:2]))) - 90
    assert abs((exits - turned + 180) % 360 - 180) <= 45 + 1e-6


def test_winches_too_close_are_named():
    units = units_of(gallery_robot("bear"))
    (text,) = find_crowded_units(gallery_robot("bear"), units)
    assert '"hug" and "nod" are 20.1 mm apart' in text
    assert find_crowded_units(gallery_robot("starfish"), units_of(gallery_robot("starfish"))) == ()
    assert find_crowded_units(gallery_robot("trunk"), units_of(gallery_robot("trunk"))) == ()


def test_screws_are_counted():
    (unit,) = units_of(gallery_robot("letter_s"), XL330)
    assert [count for _, count in unit.bought] == [4, 4, 4]
    outside = units_of(gallery_robot("trunk"), N20)[0]
    assert outside.mount is Mount.WORLD
    assert ("M2 nut", 4) in outside.bought
