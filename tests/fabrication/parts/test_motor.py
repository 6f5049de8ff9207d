"""Motors: the table is consistent, the choice is the first that carries the load, screws do not go too deep."""

import re

import pytest
from manifold3d import Manifold

from hydrostat.errors import InputError
from hydrostat.fabrication.parts.motor import ALL_MOTORS, MOTORS, FaceScrew, Motor
from hydrostat.fabrication.solids.construct import solid_of


@pytest.mark.parametrize("motor", ALL_MOTORS, ids=lambda motor: motor.key)
def test_the_outline_is_that_of_the_body(motor: Motor):
    """Oracle: the box round the solid."""
    low_x, low_y, low_z, high_x, high_y, high_z = solid_of(motor.body).bounding_box()
    xs, ys = zip(*motor.outline, strict=True)
    assert (low_x, low_y, high_x, high_y) == pytest.approx((min(xs), min(ys), max(xs), max(ys)), abs=0.02)
    assert (low_z, high_z) == pytest.approx((-motor.depth, 0.0))


@pytest.mark.parametrize("motor", ALL_MOTORS, ids=lambda motor: motor.key)
def test_what_turns_stands_on_the_face(motor: Motor):
    top = solid_of(motor.envelope).bounding_box()[5]
    assert top == pytest.approx(motor.horn.height + motor.horn.hub_height if motor.horn else motor.shaft.length)


def test_the_flat_of_a_shaft_is_where_it_is_said():
    """Oracle: the box round the solid, and the area of a circular segment."""
    shaft = MOTORS[0].shaft
    low, _, _, high, _, top = solid_of(shaft.shape(4.0, 0.1)).bounding_box()
    assert (low, high, top) == pytest.approx((-1.6, 2.5 - 1.5 + 0.1, 4.0), abs=0.02)


def test_every_motor_is_stronger_than_the_one_before_and_says_where_its_figures_are_from():
    rated = [motor.rated_torque for motor in MOTORS]
    assert rated == sorted(rated)
    for motor in ALL_MOTORS:
        assert motor.rated_torque < motor.stall_torque / 3
        assert "check yours" in motor.source
        assert motor.price > 0
        assert "no source" not in motor.price_source
        assert motor.price_source
        assert re.fullmatch(r"20\d\d-[01]\d", motor.price_month)
        assert (motor.bus != "") == (motor.horn is not None)


def test_a_motor_that_was_named_is_taken():
    assert Motor.choose("n20") is MOTORS[0]


def test_an_unknown_motor_is_refused_with_those_there_are():
    with pytest.raises(InputError, match=r'unknown motor "nema"\. Available: auto, n20, xl330, .*, st3020, scs0009'):
        Motor.choose("nema")


@pytest.mark.parametrize("wall", [0.8, 1.2, 1.6, 2.0, 3.1])
def test_screws_reach_into_the_motor_and_not_too_deep(wall: float):
    """Oracle: length minus floor."""
    for screw in (*(motor.screw for motor in ALL_MOTORS), *(motor.horn.screw for motor in ALL_MOTORS if motor.horn)):
        into = screw.length(wall) - screw.floor(wall)
        assert screw.floor(wall) >= wall
        assert 0.6 * screw.depth <= into <= screw.depth


def test_a_screw_that_may_not_go_deep_makes_the_floor_thicker():
    assert FaceScrew(size="M2", hole=2.4, head=4, head_height=1.6, depth=1.0).floor(1.6) == pytest.approx(2.0)


def test_a_thicker_shaft_is_thicker_all_round():
    """Oracle: the least gap between the two."""
    shaft = MOTORS[-1].shaft
    room: Manifold = Manifold.cube((20, 20, 4)).translate((-10, -10, 2)) - solid_of(shaft.shape(10, 0.2))
    assert solid_of(shaft.shape(10)).min_gap(room, 1.0) == pytest.approx(0.2, abs=0.02)
