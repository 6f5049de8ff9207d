"""The open robot with undo. The oracle is the list of states that were made."""

from dataclasses import replace
from pathlib import Path

import pytest

from hydrostat.control import Key, Timeline
from hydrostat.errors import InputError
from hydrostat.project import Wishes, Work
from hydrostat.robot import Robot
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.document import MAX_STEPS, Document


def named(robot: Robot, name: str) -> Robot:
    return replace(robot, name=name)


def test_nothing_is_open_at_first() -> None:
    empty = Document(Bell())
    assert not empty.is_open
    assert empty.is_saved
    assert not empty.undo()
    with pytest.raises(InputError, match="no robot is open"):
        _ = empty.robot


def test_every_change_is_undone_and_done_again_in_order(document: Document, starfish: Robot) -> None:
    names = ["one", "two", "three"]
    for name in names:
        document.change(name, robot=named(starfish, name))
    for name in reversed(names):
        assert document.robot.name == name
        assert document.undo_label == name
        assert document.undo()
    assert document.robot is starfish
    assert document.undo_label == ""
    assert not document.undo()
    for name in names:
        assert document.redo_label == name
        assert document.redo()
        assert document.robot.name == name
    assert not document.redo()


def test_a_change_after_undo_forgets_what_was_undone(document: Document, starfish: Robot) -> None:
    document.change("one", robot=named(starfish, "one"))
    document.undo()
    document.change("two", robot=named(starfish, "two"))
    assert not document.redo()
    assert document.robot.name == "two"


def test_changes_of_one_drag_are_one(document: Document, starfish: Robot) -> None:
    for step in range(5):
        document.change("move", robot=named(starfish, f"at_{step}"), merge="marker:tip")
    document.seal()
    document.change("move", robot=named(starfish, "again"), merge="marker:tip")
    assert document.undo()
    assert document.robot.name == "at_4"
    assert document.undo()
    assert document.robot is starfish


def test_a_first_drag_does_not_swallow_the_beginning(document: Document, starfish: Robot) -> None:
    document.change("move", robot=named(starfish, "a"), merge="x")
    assert document.undo()
    assert document.robot is starfish


def test_timeline_and_wishes_are_undone_too(document: Document) -> None:
    document.change("add key", timeline=Timeline(keys=(Key(time=1.0, contractions={"left": 0.01}),)))
    document.change("ask for three winches", wishes=Wishes(winches=3))
    document.undo()
    assert document.work.wishes == Wishes()
    assert len(document.work.timeline.keys) == 1
    document.undo()
    assert document.work.timeline == Timeline()


def test_saved_follows_undo(document: Document, starfish: Robot) -> None:
    assert document.is_saved
    document.change("one", robot=named(starfish, "one"))
    assert not document.is_saved
    document.undo()
    assert document.is_saved


def test_the_physics_is_shared_by_changes_that_leave_the_robot_as_it_is(document: Document, starfish: Robot) -> None:
    before = document.simulation
    document.change("wish", wishes=Wishes(cables=4))
    assert document.simulation is before
    document.change("rename", robot=named(starfish, "other"))
    assert document.simulation is not before
    document.undo()
    assert document.simulation is before


def test_another_network_keeps_the_physics_of_the_body(document: Document, starfish: Robot) -> None:
    body = document.simulation.body
    document.change("cut", robot=starfish.with_network(starfish.winches, starfish.cables[1:]))
    assert document.simulation.body is body
    assert document.simulation_of(starfish).body is body
    document.change("float", robot=replace(starfish, gravity=(0.0, -1.0)))
    assert document.simulation.body is not body


@pytest.mark.slow
def test_the_past_does_not_grow_without_end(document: Document, starfish: Robot) -> None:
    for step in range(MAX_STEPS + 50):
        document.change(f"{step}", robot=named(starfish, f"n_{step}"))
    undone = 0
    while document.undo():
        undone += 1
        assert document.robot.name == f"n_{MAX_STEPS + 49 - undone}"
    assert undone == MAX_STEPS


def test_only_the_last_states_keep_their_physics(document: Document, starfish: Robot) -> None:
    made = []
    for step in range(6):
        document.change(f"{step}", robot=named(starfish, f"n_{step}"))
        made.append(document.simulation)
    document.undo()
    assert document.simulation is made[-2]
    for _ in range(4):
        document.undo()
    assert document.robot.name == "n_0"
    assert document.simulation is not made[0]


def test_what_changes_while_it_is_written_is_not_saved(document: Document, starfish: Robot, tmp_path: Path) -> None:
    document.change("one", robot=named(starfish, "one"))
    written = document.work
    document.change("two", robot=named(starfish, "two"))
    document.mark_saved(tmp_path, written)
    assert not document.is_saved
    document.undo()
    assert document.is_saved
    document.open(Work(robot=named(starfish, "other")), saved=False)
    document.mark_saved(tmp_path, written)
    assert document.folder is None
    assert not document.is_saved


def test_the_bell_rings_for_every_change(document: Document, starfish: Robot) -> None:
    heard: list[Topic] = []
    leave = document.bell.listen(heard.append)
    document.change("one", robot=named(starfish, "one"))
    assert Topic.ROBOT in heard
    leave()
    heard.clear()
    document.undo()
    assert not heard


@pytest.mark.parametrize("time", [-1.0, float("nan"), 1e9])
def test_keys_out_of_time_are_refused(time: float) -> None:
    with pytest.raises(InputError, match="keyframe"):
        Key(time=time, contractions={})


def test_a_timeline_is_in_order() -> None:
    keys = (Key(time=2.0, contractions={}), Key(time=1.0, contractions={}))
    with pytest.raises(InputError, match="order"):
        Timeline(keys=keys)
    sorted_keys = Timeline().with_key(keys[0]).with_key(keys[1])
    assert [key.time for key in sorted_keys.keys] == [1.0, 2.0]
    assert sorted_keys.with_key(Key(time=2.001, contractions={"left": 0.1})).keys[-1].contractions == {"left": 0.1}
