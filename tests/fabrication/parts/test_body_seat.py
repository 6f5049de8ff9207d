"""The seat of a body: as deep as its pin, tubes where cables begin, nothing in another's way."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot
from manifold3d import Manifold

from hydrostat.fabrication.checks.solid_checks import watertight_problems
from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.body_seat import BodySeat, body_seat
from hydrostat.fabrication.solids.assembly import interferences
from hydrostat.robot import Pin, Robot

BED = (220.0, 220.0, 250.0)
ROUND = 0.05  # of lengths along a mesh that has a corner there [mm]


def placed(seat: BodySeat, name: str) -> Manifold:
    assert seat.assembly is not None
    return next(piece.solid for piece in seat.assembly.pieces if piece.name == name)


def seat_of(robot: Robot) -> BodySeat:
    return body_seat(robot, PartOptions(), BED)


@pytest.fixture(scope="module")
def tail() -> Robot:
    """It is held within 12 mm of x = 0, and its two cables begin at x = -45, y = -23.8 and 23.8 mm."""
    return gallery_robot("fish_tail")


@pytest.fixture(scope="module")
def seat(tail: Robot) -> BodySeat:
    return seat_of(tail)


def test_the_cup_is_as_deep_as_the_pin(seat: BodySeat) -> None:
    """Oracle: the pin of the robot file, 12 mm; the floor is below z = 0, where the body ends."""
    low, high = placed(seat, "seat_cup").bounding_box()[2::3]
    assert (low, high) == pytest.approx((-4.0, 12.0), abs=ROUND)
    assert placed(seat, "body").bounding_box()[2] == pytest.approx(0.0, abs=ROUND)


def test_tubes_pass_the_plate_where_cables_begin(seat: BodySeat) -> None:
    """Oracle: places of the robot file; a rod as thick as the tube is free there, and is not 2 mm beside it."""
    plate = placed(seat, "seat_plate")
    high = plate.bounding_box()[5]
    assert high == pytest.approx(-45.0 + 1.5, abs=ROUND)
    rod = Manifold.cylinder(20, 1.0, circular_segments=32).translate((0, 0, high - 15))
    assert seat.held == (0, 1)
    for side in (-23.8, 23.8):
        assert (plate ^ rod.translate((side, 0, 0))).volume() == pytest.approx(0.0, abs=1e-6)
        assert (plate ^ rod.translate((side + 2, 0, 0))).volume() > 5.0


def test_lines_pass_the_floor_of_the_cup(tail: Robot, seat: BodySeat) -> None:
    """Oracle: balls of the tube's radius along each cable up to the body, turned by hand: x up, y and z across."""
    cup = placed(seat, "seat_cup")
    for cable in tail.cables:
        begin, enters = (1e3 * np.array(point)[[1, 2, 0]] for point in cable.points[:2])
        for share in np.linspace(0.6, 1.0, 9):
            ball = Manifold.sphere(1.0, 24).translate(tuple(begin + share * (enters - begin)))
            assert (cup ^ ball).volume() == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("name", ["fish_tail", "cupping_hand", "trunk"])
def test_nothing_is_in_the_way_of_anything(name: str) -> None:
    """Oracle: booleans of all pieces, the end of the body among them."""
    seat = seat_of(gallery_robot(name))
    assert seat.assembly is not None
    assert interferences(seat.assembly) == ()
    assert [problem for part in seat.printed for problem in watertight_problems(part)] == []
    assert seat.problems == seat.warnings == ()


@pytest.mark.parametrize(
    ("pins", "why"),
    [
        ((Pin(at=(0.0, 0.0, 0.0), radius=0.01), Pin(at=(0.1, 0.0, 0.0), radius=0.01)), "it has 2 pins"),
        ((Pin(at=(0.15, 0.0, 0.0), radius=0.02),), "not pinned at the end where its cables begin"),
    ],
)
def test_where_none_can_be_made_it_says_why(tail: Robot, pins: tuple[Pin, ...], why: str) -> None:
    seat = seat_of(replace(tail, pins=pins))
    assert seat.printed == ()
    assert why in seat.warnings[0]


def test_a_part_too_large_for_the_bed_is_told(tail: Robot) -> None:
    assert "seat_plate is 111 x 141 x 8 mm" in body_seat(tail, PartOptions(), (100.0, 120.0, 100.0)).problems[0]


def test_none_for_winches_in_the_body() -> None:
    seat = seat_of(gallery_robot("starfish"))
    assert seat.printed == seat.warnings == ()
