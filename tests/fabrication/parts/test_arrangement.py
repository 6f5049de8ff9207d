"""How units lie in flat bodies: within the seam, clear of each other, no thicker than stuffing gives."""

import math
import time
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from builders import gallery_robot, gallery_texts
from plush_robots import SQUARE, drawn_body, plush_robot
from shapely import Polygon, box, transform
from winch_robots import with_winches

from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.arrangement import LaidUnit, _arrange_units, arrange_units
from hydrostat.fabrication.parts.motor import MOTORS, Motor
from hydrostat.fabrication.parts.places import COMPRESSION_SHARE, OVERLAP_TOLERANCE, UnitBox, seam_of
from hydrostat.fabrication.parts.winch_unit import WinchUnit, winch_units
from hydrostat.robot import Cable, Robot, Winch

N20, XL330, POLOLU_25D = MOTORS
FLAT = [
    name
    for name, text in gallery_texts().items()
    if "thickness" in text["body"] and not any(winch.get("mount") == "world" for winch in text["winch"])
]


def units_of(robot: Robot, motor: Motor = N20) -> tuple[WinchUnit, ...]:
    return winch_units(robot, PartOptions(), motor)


def brick(winch: str, x: float, y: float, *, deep: float = 20.0, along: float = 0.0) -> UnitBox:
    """A unit of 20 x 20 mm round its shaft, as long below the face of its motor as told, 10 mm above."""
    return UnitBox(winch=winch, at=(x, y), low=(-10.0, -10.0, -deep), high=(10.0, 10.0, 10.0), along=along)


def problems(laid: tuple[LaidUnit, ...]) -> list[str]:
    return [text for each in laid for text in each.problems]


def notes(laid: tuple[LaidUnit, ...]) -> list[str]:
    return [text for each in laid for text in each.notes]


@pytest.mark.parametrize("motor", [N20, XL330], ids=lambda motor: motor.key)
@pytest.mark.parametrize("name", FLAT)
def test_flat_robots_of_the_gallery_have_room(name: str, motor: Motor, unchecked: None):
    """Oracle: shapely on the seam as drawn; units that meet are together no thicker than the body gives."""
    robot = gallery_robot(name)
    assert robot.body.outline is not None
    seam = transform(robot.body.outline.polygon, lambda points: 1e3 * points)
    units = units_of(robot, motor)
    assert [text for unit in units for text in unit.problems] == []
    places = [unit.place for unit in units if unit.place is not None]
    assert len(places) == len(robot.winches)
    room = (1 + COMPRESSION_SHARE) * 1e3 * float(robot.body.thickness or 0)
    for place in places:
        assert place.footprint.difference(seam).area <= OVERLAP_TOLERANCE
        assert place.depth <= room
        assert math.dist(place.footprint.centroid.coords[0], place.box.at) < max(place.box.size)
    for one, other in combinations(places, 2):
        assert one.footprint.intersection(other.footprint).area <= OVERLAP_TOLERANCE or one.depth + other.depth <= room
    for place in places:
        assert (place.slid == (0.0, 0.0)) is ("shifted" not in place.instruction)


@pytest.mark.parametrize("motor", MOTORS, ids=lambda motor: motor.key)
def test_footprints_have_the_sides_of_the_unit(motor: Motor):
    """Oracle: sides of the rectangle, measured; the depth is the third side."""
    for unit in (*units_of(gallery_robot("pig"), motor), *units_of(gallery_robot("starfish"), motor)):
        assert unit.place is not None
        corners = np.array(unit.place.footprint.exterior.coords)
        sides = sorted({round(float(side), 6) for side in np.linalg.norm(np.diff(corners, axis=0), axis=1)})
        flat = unit.room.size[:2] if unit.across else unit.room.size[1:]
        assert sides == pytest.approx(sorted({round(side, 6) for side in flat}))
        assert unit.place.depth == pytest.approx(unit.room.size[2] if unit.across else unit.room.size[0])


def test_a_body_thinner_than_stuffing_gives_is_refused_and_a_little_thinner_is_told():
    """Oracle: the thinnest side of a unit, against the body with and without what it gives."""
    robot = gallery_robot("starfish")

    def of(thickness: float) -> tuple[WinchUnit, ...]:
        return units_of(replace(robot, body=replace(robot.body, thickness=1e-3 * thickness)))

    thinnest = min(of(40.0)[0].room.size)
    for unit in (*of(4.0), *of(thinnest / (1 + COMPRESSION_SHARE) - 0.1)):
        assert any(f'winch "{unit.winch}"' in text and "hoose a smaller motor" in text for text in unit.problems)
    for unit in of(thinnest / (1 + COMPRESSION_SHARE) + 0.1):
        assert unit.problems == ()
        assert any("which will bulge by" in text for text in unit.notes)
    assert any("will bulge by 1 mm" in text for unit in of(thinnest - 0.6) for text in unit.notes)
    assert not any("bulge" in text for unit in of(thinnest - 0.4) for text in unit.notes)


def test_a_motor_longer_than_the_body_is_refused():
    """Oracle: a square of 59 mm has a diagonal of 83 mm, the unit is longer than that; 60 mm are not enough either."""
    for side in (59, 60):
        small = plush_robot(drawn_body(f"M0 0H{side}V{side}H0Z"), [(0, 0), (10, 12)], marker=(5, 5))
        (unit,) = units_of(small, POLOLU_25D)
        assert max(unit.room.size) > 59 * math.sqrt(2)
        assert any("does not fit within the seam" in text or "mm in a body" in text for text in unit.problems)
        assert units_of(small, N20)[0].problems == ()
    large = plush_robot(drawn_body("M0 0H200V200H0Z"), [(0, 0), (10, 12)])
    assert units_of(large, POLOLU_25D)[0].problems == ()


def test_a_mesh_has_its_boundary_for_a_seam():
    """Oracle: area and corners of the square that was drawn."""
    body = drawn_body(SQUARE)
    meshed = seam_of(replace(body, outline=None))
    assert meshed.symmetric_difference(seam_of(body)).area < 1e-6 * 100 * 100
    assert seam_of(body).bounds == pytest.approx((-50, -50, 50, 50))


def test_one_unit_is_turned_and_slid_until_it_is_inside():
    """Oracle: a strip 22 mm wide takes a unit of 20 x 20 x 40 mm in a thin body along it only."""
    strip = box(-60, -11, 60, 11)
    (laid,) = arrange_units([brick("a", 0, 0, deep=30.0, along=0.0)], strip, 21.0)
    assert laid.problems == ()
    assert not laid.place.across
    assert laid.place.footprint.bounds[2] - laid.place.footprint.bounds[0] == pytest.approx(40)
    (slid,) = arrange_units([brick("a", 0, 5.0, deep=30.0)], strip, 21.0)
    assert slid.problems == ()
    assert math.hypot(*slid.place.slid) == pytest.approx(6)
    assert "shifted 6 mm toward 6 o'clock" in slid.place.instruction
    assert "does not fit within the seam" in problems(arrange_units([brick("a", 0, 9.0, deep=30.0)], strip, 21.0))[0]


def test_neighbors_turn_away_from_each_other():
    """Oracle: across they would meet, slid too; face to face, with 5 mm of housing each, not."""
    wide = box(-200, -200, 200, 200)
    near = arrange_units([brick("a", -3, 0), brick("b", 3, 0)], wide, 31.0)
    assert problems(near) == []
    assert near[0].place.footprint.intersection(near[1].place.footprint).area <= OVERLAP_TOLERANCE
    assert notes(near) == []
    assert all(each.place.instruction.startswith("flat, motor toward") for each in near)
    apart = arrange_units([brick("a", -40, 0), brick("b", 40, 0)], wide, 31.0)
    assert all(each.place.instruction.startswith("across the body, channel") for each in apart)


def test_two_in_one_place_lie_above_each_other_or_are_refused():
    """Oracle: 2 x 20 mm in bodies of 40, 33 and 31 mm that give a quarter; three are one too many."""
    narrow = box(-15, -15, 15, 15)
    pair = [brick("a", 0, 0, deep=10.0), brick("b", 0, 0, deep=10.0)]
    assert problems(arrange_units(pair, narrow, 40.0)) == []
    (enough,) = (text for text in notes(arrange_units(pair, narrow, 40.0)) if "one above the other" in text)
    assert "40 mm in a body of 40 mm" in enough
    assert "bulge" not in enough
    assert any("bulges by 7 mm" in text for text in notes(arrange_units(pair, narrow, 33.0)))
    (refused,) = problems(arrange_units(pair, narrow, 31.0))
    assert '"a" and "b"' in refused
    assert "40 mm in a body of 31 mm" in refused
    assert "20 x 20 x " in refused, "how large they are"
    assert " mm each, 0 mm apart)" in refused, "how far apart the robot has them"
    (refused,) = problems(arrange_units([pair[0], brick("b", 3, 4, deep=12.0)], narrow, 31.0))
    assert refused.count("20 x 20 x ") == 2, "of two sizes both"
    assert " mm, 5 mm apart)" in refused
    (three,) = problems(arrange_units([*pair, brick("c", 0, 0, deep=10.0)], narrow, 40.0))
    assert '"a", "b" and "c"' in three
    assert "60 mm in a body of 40 mm" in three


def test_two_winches_in_one_place_of_a_robot():
    """Oracle: two units of 25 mm: refused in 30 mm, above each other in 45 mm; one alone has room in 30 mm."""
    one = plush_robot(drawn_body(SQUARE), [(0, 0), (10, 12)])
    twice = replace(
        one,
        winches=(*one.winches, Winch(name="again", at=(0.0, 0.0))),
        cables=(*one.cables, Cable(winch="again", points=((0.0, 0.0), (-0.02, 0.012)))),
    )
    assert [text for unit in units_of(one) for text in unit.problems] == []
    (refused,) = (text for unit in units_of(twice) for text in unit.problems)
    assert '"pull" and "again"' in refused
    thick = replace(twice, body=replace(twice.body, thickness=0.045))
    assert [text for unit in units_of(thick) for text in unit.problems] == []
    told = [text for unit in units_of(thick) for text in unit.notes]
    assert any('"pull" and "again"' in text and "one above the other" in text for text in told)


@pytest.mark.slow
def test_eight_long_motors_do_not_fit_into_a_squid():
    assert any(
        "Move the winches apart" in text
        for unit in units_of(gallery_robot("squid"), POLOLU_25D)
        for text in unit.problems
    )


@pytest.mark.slow
def test_channels_follow_the_cables_of_a_turned_unit():
    """Oracle: angle between the way out of the housing, in the body's plane, and the way in which the cable goes."""
    for name in FLAT:
        robot = gallery_robot(name)
        for unit in units_of(robot, XL330):
            assert unit.place is not None
            for leaves in unit.exits:
                (x, y), (u, v) = robot.cables[leaves.cable].points[:2]
                way = math.degrees(math.atan2(v - y, u - x))
                azimuth = math.degrees(math.atan2(leaves.direction[1], leaves.direction[0]))
                out = unit.place.turn - 90 + azimuth
                assert abs((out - way + 180) % 360 - 180) <= (45 if unit.across else 90) + 1e-6


@pytest.mark.slow
def test_it_takes_little_time_and_is_the_same_again(unchecked: None):
    robot = with_winches(gallery_robot("squid"))
    begin = time.process_time()
    first = units_of(robot, XL330)
    _arrange_units.cache_clear()
    second = units_of(robot, XL330)
    assert time.process_time() - begin < 6.0
    for one, other in zip(first, second, strict=True):
        assert one.place is not None
        assert other.place is not None
        assert one.place.instruction == other.place.instruction
        assert Polygon(one.place.footprint).equals(other.place.footprint)
