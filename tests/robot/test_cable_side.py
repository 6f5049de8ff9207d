"""Where the cables of a flat robot run. Oracles: lengths and counts by hand, the text as typed, the old hash."""

from dataclasses import replace
from pathlib import Path

import pytest
from robot_files import GOOD, edit, load

from hydrostat.errors import InputError
from hydrostat.given import MAX_NAME
from hydrostat.robot import (
    CableSide,
    Robot,
    describe_cable_side,
    gallery_folder,
    load_robot,
    robot_hash,
    robot_text,
    sewn_robot,
)
from hydrostat.robot.merge import merged_text


@pytest.mark.parametrize("face", list(CableSide))
def test_a_file_says_it_and_reads_back(face: CableSide, tmp_path: Path) -> None:
    robot = load(tmp_path, edit(GOOD, "format = 1", f'format = 1\nface = "{face}"'))
    assert robot.face is face
    assert f'face = "{face}"' in robot_text(robot).splitlines()
    assert load(tmp_path, robot_text(robot)) == robot
    assert robot_hash(robot) != robot_hash(replace(robot, face=None))


def test_an_old_file_says_nothing_and_keeps_its_comments_when_it_learns_to(tmp_path: Path) -> None:
    robot = load(tmp_path)
    assert robot.face is None
    assert "face" not in robot_text(robot)
    text = merged_text(GOOD, replace(robot, face=CableSide.PAIRS))
    assert text.startswith("# A robot that is good in every line.")
    assert load(tmp_path, text).face is CableSide.PAIRS


def test_the_motor_of_a_file_reads_back(tmp_path: Path) -> None:
    """Oracle: the line of the file; a robot without one has none, and keeps its hash."""
    robot = load(tmp_path, edit(GOOD, "format = 1", 'format = 1\nmotor = "sts3215"'))
    assert robot.motor == "sts3215"
    assert 'motor = "sts3215"' in robot_text(robot).splitlines()
    assert "motor" not in robot_text(replace(robot, motor="auto"))
    assert load(tmp_path, merged_text(GOOD, robot)).motor == "sts3215"


def test_limits_of_a_file_read_back(tmp_path: Path) -> None:
    """Oracle: the lines of the file, in SI."""
    lines = 'max_tension = "4.075 N"\nmax_torque = "60 N mm"'
    robot = load(tmp_path, edit(GOOD, "format = 1", f"format = 1\n{lines}"))
    assert (robot.max_tension, robot.max_torque) == (4.075, 0.06)
    again = load(tmp_path, merged_text(GOOD, robot))
    assert (again.max_tension, again.max_torque) == (4.075, 0.06)
    assert "max_t" not in robot_text(replace(robot, max_tension=None, max_torque=None))
    with pytest.raises(InputError, match=r"line 3: max_torque must be finite and above 0, not -1 N m"):
        load(tmp_path, edit(GOOD, "format = 1", 'format = 1\nmax_torque = "-1 N m"'))


def test_what_is_no_face_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r'face.*"table" is not known; allowed are: front, back, pairs or middle'):
        load(tmp_path, edit(GOOD, "format = 1", 'format = 1\nface = "table"'))
    with pytest.raises(InputError, match=r"face stands at the top|stands at the top of the file"):
        load(tmp_path, edit(GOOD, "[body]", '[body]\nface = "pairs"'))
    with pytest.raises(InputError, match="face is only for flat bodies"):
        replace(load_robot(gallery_folder("trunk")), face=CableSide.PAIRS)


@pytest.fixture(scope="module")
def starfish() -> Robot:
    return load_robot(gallery_folder("starfish"))


def test_pairs_are_sewn_twice(starfish: Robot) -> None:
    """Oracle: twice the cables, twice the length on each winch, the same points; C1 and C6 are a pair of five."""
    sewn = sewn_robot(replace(starfish, face=CableSide.PAIRS))
    assert len(sewn.cables) == 2 * len(starfish.cables)
    assert [cable.name for cable in sewn.cables[:1] + sewn.cables[5:6]] == ["right 1 front", "right 1 back"]
    assert all(one.points == other.points for one, other in zip(sewn.cables[:5], sewn.cables[5:], strict=True))
    for winch in starfish.winches:
        lengths = [
            sum(cable.length for cable in robot.cables if cable.winch == winch.name) for robot in (sewn, starfish)
        ]
        assert lengths[0] == pytest.approx(2 * lengths[1])
    for face in (None, CableSide.FRONT, CableSide.BACK, CableSide.MIDDLE):
        alone = replace(starfish, face=face)
        assert sewn_robot(alone) is alone


def test_a_long_name_gets_no_side(starfish: Robot) -> None:
    long = replace(starfish.cables[0], name="c" * MAX_NAME)
    names = [cable.name for cable in sewn_robot(replace(starfish, cables=(long,), face=CableSide.PAIRS)).cables]
    assert names == ["right 1", "right 2"]


def test_it_is_told_in_words(starfish: Robot) -> None:
    assert describe_cable_side(replace(starfish, face=CableSide.PAIRS)) == "on both faces, in pairs"
    assert describe_cable_side(starfish).startswith("side not set: a plush kit uses the front panel")
    assert (
        describe_cable_side(starfish.with_network((), ()))
        == describe_cable_side(load_robot(gallery_folder("trunk")))
        == ""
    )
