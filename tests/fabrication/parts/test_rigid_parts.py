"""All rigid parts of a robot: counts, names, time, the same on every run."""

import time
from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_options import PartOptions
from hydrostat.fabrication.parts.rigid_parts import RigidParts, rigid_parts
from hydrostat.robot import list_gallery

BED = (220.0, 220.0, 250.0)


def parts_of(name: str, motor: str = "n20") -> RigidParts:
    robot = gallery_robot(name)
    return rigid_parts(robot, motor=motor, options=PartOptions(), bed=BED, holes=12, hole=3.0)


@pytest.mark.parametrize("name", [name for name in list_gallery() if name != "emio"])  # it has no winches
@pytest.mark.slow
def test_parts_of_the_gallery(name: str, unchecked: None):
    """Oracle: counts of winches, cables and holes of the robot; names once each, with those of all pieces."""
    robot, parts = gallery_robot(name), parts_of(name)
    count = {part.name: part.count for part in parts.printed}
    assert len(count) == len(parts.printed)
    for kind in ("spool_", "housing_", "motor_plate_"):
        assert sum(number for part, number in count.items() if part.startswith(kind)) == len(robot.winches)
    assert count["stopper"] == len(robot.cables)
    assert count["grommet"] == 12
    assert all(part.name.replace("_", "a").isalnum() for part in parts.printed)
    pieces = {piece.name.split(" ")[0] for made in parts.assemblies for piece in made.pieces if piece.printed}
    assert pieces == set(count) - {"grommet"}
    assert parts.problems == ()
    assert dict(parts.bought)[parts.motor.title] == len(robot.winches)
    assert parts.screws == {title: number for title, number in parts.bought if title != parts.motor.title}
    assert set(parts.leads) == set(parts.seats) == set(range(len(robot.cables)))


def test_pieces_on_the_base_are_as_many_as_are_printed():
    parts = parts_of("trunk", "xl330")
    assert parts.base is not None
    on_base: dict[str, int] = {}
    for piece in parts.base.assembly.pieces:
        if piece.printed:
            name = piece.name.split(" ")[0]
            on_base[name] = on_base.get(name, 0) + 1
    printed = {part.name: part.count for part in parts.printed}
    assert on_base == {name: printed[name] for name in on_base}


def test_equal_winches_share_a_file_that_names_them():
    parts = parts_of("starfish").printed
    titles = {part.name: (part.title, part.count) for part in parts}
    assert {part.winches for part in parts if part.kind == "Spool"} == {("right",), ("left", "feet")}
    assert not any(part.winches or part.kind for part in parts if "winch" not in part.title)
    assert titles["spool_a"] == ("Spool of winch right", 1)
    assert titles["spool_b"] == ("Spool of winches left, feet", 2)
    assert titles["motor_plate_a"] == ("Motor plate of every winch", 3)


def test_an_unknown_motor_is_refused():
    with pytest.raises(InputError, match="unknown motor"):
        parts_of("letter_s", "stepper")


@pytest.mark.slow
def test_the_same_on_every_run():
    for one, other in zip(parts_of("squid").printed, parts_of("squid").printed, strict=True):
        assert (one.name, one.title, one.count, one.note) == (other.name, other.title, other.count, other.note)
        assert np.array_equal(one.mesh[0], other.mesh[0])
        assert np.array_equal(one.mesh[1], other.mesh[1])


@pytest.mark.parametrize("name", ["cupping_hand", "squid"])
@pytest.mark.slow
def test_it_takes_little_time(name: str, unchecked: None):
    robot = gallery_robot(name)
    begin = time.process_time()
    made = rigid_parts(robot, motor="xl330", options=PartOptions(), bed=BED)
    assert sum(part.volume for part in made.printed) > 0
    assert time.process_time() - begin < 2.0


def test_what_to_mind_of_the_base_is_told():
    """Oracle: a cable that is bare from its beginning, with a seat for its tube and without."""
    seated = gallery_robot("fish_tail")
    robot = replace(seated, cables=(seated.cables[0], replace(seated.cables[1], sheathed=())))
    bare = replace(robot, pins=robot.pins * 2)
    told = [rigid_parts(each, motor="n20", options=PartOptions(), bed=BED).warnings for each in (robot, bare)]
    assert not any("Clamp the end of its tube" in text for text in told[0])
    assert [text for text in told[1] if "Clamp the end of its tube" in text and "C2" in text]
