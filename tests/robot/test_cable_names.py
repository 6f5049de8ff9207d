"""Cables have names: their own, or made up of their winch's."""

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from robot_files import GOOD, edit, load, refusal

from hydrostat.errors import InputError
from hydrostat.given import check_name
from hydrostat.robot import Cable, Robot, load_robot, robot_hash, robot_text, save_robot
from hydrostat.robot.cable import given_names, name_cables
from hydrostat.robot.merge import merged_text
from hydrostat.robot.read import RobotReader

TWO = edit(GOOD, "[[marker]]", '[[cable]]\nwinch = "left"\npoints = [[-20, 5], [10, 5]]\n\n[[marker]]')
"""Three cables: left, right, left."""

WINCHES = ["a", "a 1", "b" * 60, "b" * 59 + "c"]
NAMES = ["", "a 1", "a 2", "a 1 1", "thumb", "b" * 58 + " 1"]


def cables(names: list[tuple[str, str]]) -> tuple[Cable, ...]:
    return tuple(Cable(winch=winch, name=name, points=((0.0, 0.0), (1.0, 0.0))) for winch, name in names)


NAMED = st.lists(
    st.tuples(st.sampled_from(WINCHES), st.just("") | st.sampled_from(NAMES)),
    max_size=9,
    unique_by=lambda entry: entry[1] or object(),
)


@settings(deadline=None)  # computers may be busy
@given(entries=NAMED)
def test_names_are_unique_and_lasting(entries: list[tuple[str, str]]) -> None:
    """Oracle: what names are for: no two alike, given ones stay, and dropping the usual ones changes nothing."""
    before = cables(entries)
    after = name_cables(before)
    names = [cable.name for cable in after]
    assert len(set(names)) == len(names)
    assert all(old.name in ("", new.name) for old, new in zip(before, after, strict=True))
    assert [replace(cable, name="") for cable in after] == [replace(cable, name="") for cable in before]
    assert name_cables(after) == after
    bare = tuple(replace(cable, name=name) for cable, name in zip(after, given_names(after), strict=True))
    assert name_cables(bare) == after
    for old, new in zip(before, after, strict=True):
        assert old.name or check_name(new.name) == new.name


@settings(deadline=None)
@given(winches=st.lists(st.sampled_from(["left", "right"]), max_size=9))
def test_made_up(winches: list[str]) -> None:
    """Oracle: counted by hand: a winch and which of its cables it is; none of them counts as given."""
    named = name_cables(cables([(winch, "") for winch in winches]))
    assert [cable.name for cable in named] == [
        f"{winch} {winches[: number + 1].count(winch)}" for number, winch in enumerate(winches)
    ]
    assert set(given_names(named)) <= {""}


def test_taken() -> None:
    """Oracle: by hand."""
    named = name_cables(cables([("a", ""), ("a", "a 1"), ("a", ""), ("a", "")]))
    assert [cable.name for cable in named] == ["a 2", "a 1", "a 3", "a 4"]
    assert given_names(named) == ("a 2", "a 1", "", "")


def test_of_a_robot(tmp_path: Path) -> None:
    """Oracle: the names in the file, and those made up; a robot finds its cables by them."""
    robot = load(tmp_path, edit(TWO, 'winch = "right"', 'winch = "right"\nname = "thumb"'))
    assert [cable.name for cable in robot.cables] == ["left 1", "thumb", "left 2"]
    assert robot.cable("thumb") is robot.cables[1]
    assert robot.cable("left 2").points[1] == (0.01, 0.005)
    with pytest.raises(InputError, match=r'unknown cable "left"\. Available: left 1, thumb, left 2'):
        robot.cable("left")
    assert 'name = "thumb"' in robot_text(robot)
    assert "left 1" not in robot_text(robot)


def test_kept(tmp_path: Path) -> None:
    """Oracle: the second cable is still the second one when the first is gone, also when read again."""
    robot = load(tmp_path / "here", TWO)
    fewer = robot.with_network(robot.winches, robot.cables[1:])
    assert [cable.name for cable in fewer.cables] == ["right 1", "left 2"]
    again = load_robot(save_robot(fewer, tmp_path / "there"))
    assert again == fewer
    assert robot_hash(again) == robot_hash(fewer)


def test_refused(tmp_path: Path) -> None:
    """Oracle: one line that says where and why."""
    twice = edit(
        edit(TWO, 'winch = "right"', 'winch = "right"\nname = "a"'), 'winch = "left"', 'winch = "left"\nname = "a"'
    )
    assert refusal(tmp_path, twice).endswith('cable[1].name: there are two of the name "a"; names must be unique')
    for name, words in {"": "must not be empty", "a/b": "has letters", "-a": "begins with a letter"}.items():
        assert words in refusal(tmp_path, edit(TWO, 'winch = "right"', f'winch = "right"\nname = "{name}"'))
    robot = load(tmp_path, TWO)
    with pytest.raises(InputError, match='"a/b" has "/" in it'):
        replace(robot.cables[0], name="a/b")


@pytest.fixture(scope="module")
def three(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    return load(tmp_path_factory.mktemp("three"), TWO)


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(names=st.permutations(["", "", "left 1", "left 2", "right 2", "thumb", "世 2"]).map(lambda names: names[:3]))
@pytest.mark.slow
def test_written_and_read(names: list[str], three: Robot) -> None:
    """Oracle: the robot itself, read from its own text and from one merged into another's."""
    robot = three.with_network(
        three.winches, [replace(cable, name=name) for cable, name in zip(three.cables, names, strict=True)]
    )
    text = robot_text(robot)
    reader = RobotReader(Path("robot.toml"), text)
    assert name_cables(reader.records("cable", reader._cable)) == robot.cables
    merged = merged_text(TWO, robot)
    assert merged.startswith("# A robot that is good")
    reader = RobotReader(Path("robot.toml"), merged)
    assert name_cables(reader.records("cable", reader._cable)) == robot.cables
    assert merged_text(merged, three).count("name") == TWO.count("name")


def test_comments_stay_with_names(three: Robot) -> None:
    """Oracle: each remark stands above the cable of its name, although all have changed places and points."""
    names = ["index", "thumb", "heel"]
    text = TWO
    for name, winch in zip(names, ["left", "right", "left"], strict=True):
        text = text.replace(
            f'[[cable]]\nwinch = "{winch}"', f'# of the {name}\n[[cable]]\nname = "{name}"\nwinch = "{winch}"', 1
        )
    named = three.with_network(
        three.winches, [replace(cable, name=name) for cable, name in zip(three.cables, names, strict=True)]
    )
    assert merged_text(text, named) == text
    moved = [
        replace(cable, points=(cable.points[0], (0.0, -0.001 * number))) for number, cable in enumerate(named.cables)
    ]
    turned = merged_text(text, named.with_network(named.winches, moved[::-1])).split("[[cable]]")
    for name, before, own in zip(names[::-1], turned, turned[1:], strict=False):
        assert before.rstrip().endswith(f"# of the {name}")
        assert f'name = "{name}"' in own
