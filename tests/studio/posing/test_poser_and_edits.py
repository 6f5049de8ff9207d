"""The stage "pose" while the robot is edited elsewhere. Oracles: the document, undo, names that `save` allows."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.errors import InputError
from hydrostat.project import Wishes, Work
from hydrostat.robot import Robot, load_robot, save_robot
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.posing.pose_state import HeldPoint, Mode, with_pose
from hydrostat.studio.posing.poser import Poser
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.scene_items import Dot


@pytest.fixture
def poser(document: Document) -> Iterator[Poser]:
    jobs = Jobs(document.bell)
    made = Poser(document, jobs)
    made.set_mode(Mode.MUSCLES)
    yield made
    jobs.close()


def named(robot: Robot, old: str, new: str) -> Robot:
    """The robot with another name for a marker, without poses."""
    markers = tuple(replace(marker, name=new) if marker.name == old else marker for marker in robot.markers)
    return replace(robot, markers=markers, poses={})


def without(robot: Robot, name: str) -> Robot:
    """The robot without a marker, and without poses."""
    return replace(robot, markers=tuple(own for own in robot.markers if own.name != name), poses={})


def hold(poser: Poser, key: str, at: tuple[float, ...]) -> None:
    """Drag something a centimeter to the right."""
    assert poser.grab(Hit(key=key, rest=at, world=at))
    poser.drag(Hit(world=(at[0] + 0.01, *at[1:])))
    poser.release()


@pytest.mark.parametrize("name", ["wave!", 'a" onclick="b', "../up", "-x", "x" * 61, " "])
def test_a_pose_has_a_name_that_a_file_allows(
    starfish: Robot, document: Document, poser: Poser, tmp_path: Path, name: str
) -> None:
    hold(poser, "body", starfish.markers[0].at)
    with pytest.raises(InputError, match="name"):
        poser.store(name)
    with pytest.raises(InputError, match="name"):
        poser.rename_pose("wave", name)
    assert document.robot is starfish
    poser.store("wave 2.b_c-d")
    save_robot(document.robot, tmp_path / "robot")
    assert "wave 2.b_c-d" in load_robot(tmp_path / "robot").poses


def test_wishes_follow_the_names_of_poses(starfish: Robot, document: Document, poser: Poser) -> None:
    first, second = list(with_pose(starfish, "other", poser_held(starfish)).poses)[-2:]
    document.change("more", robot=with_pose(starfish, "other", poser_held(starfish)))
    document.change("wish", wishes=Wishes(poses=(first, second)))
    poser.rename_pose(first, "hello")
    assert document.work.wishes.poses == ("hello", second)
    poser.delete_pose("hello")
    assert document.work.wishes.poses == (second,)
    document.undo()
    assert document.work.wishes.poses == ("hello", second)
    document.undo()
    assert document.work.wishes.poses == (first, second)
    assert first in document.robot.poses


def poser_held(robot: Robot) -> dict[str, HeldPoint]:
    """What holds one marker where it is."""
    marker = robot.markers[0]
    return {marker.name: HeldPoint(at=marker.at, target=marker.at)}


@pytest.mark.parametrize("change", [without, lambda robot, name: named(robot, name, "other")])
def test_what_was_chosen_may_be_gone_when_it_should_move(
    starfish: Robot, document: Document, poser: Poser, change: object
) -> None:
    marker = starfish.markers[0]
    poser.click(Hit(key=f"marker:{marker.name}", world=marker.at))
    poser.key("g")
    assert poser.is_armed
    document.change("edit", robot=change(starfish, marker.name))  # type: ignore[operator]
    poser.click(Hit(world=(0.5, 0.5)))
    assert marker.name not in poser.held_points
    assert poser.chosen_name in ("", "other")


@pytest.mark.parametrize("way", ["clear", "show", "stale"])
def test_a_click_after_g_never_fails(starfish: Robot, poser: Poser, way: str) -> None:
    hold(poser, "body", tuple((0.8 * np.array(starfish.markers[0].at)).tolist()))
    assert poser.chosen_name == "point_1"
    if way == "stale":
        poser.click(Hit(key="marker:gone", world=(0.0, 0.0)))
    poser.key("g")
    if way == "clear":
        poser.clear("point_1")
    if way == "show":
        poser.show_pose("wave")
    poser.click(Hit(world=(0.5, 0.5)))
    poser.grab(Hit(world=(0.5, 0.5)))
    assert set(poser.held_points) <= {"point_1", *starfish.poses["wave"].targets}


def test_a_held_marker_that_is_gone_is_held_no_more(starfish: Robot, document: Document, poser: Poser) -> None:
    marker, other = starfish.markers[:2]
    hold(poser, f"marker:{marker.name}", marker.at)
    hold(poser, f"marker:{other.name}", other.at)
    document.change("remove", robot=without(starfish, marker.name))
    assert set(poser.held_points) == {other.name}
    poser.store("left")
    assert {own.name for own in document.robot.markers} == {own.name for own in starfish.markers} - {marker.name}


def test_a_held_marker_keeps_its_target_under_its_new_name(starfish: Robot, document: Document, poser: Poser) -> None:
    marker = starfish.markers[0]
    hold(poser, f"marker:{marker.name}", marker.at)
    target = poser.held_points[marker.name].target
    document.change("rename", robot=named(starfish, marker.name, "other"))
    assert {name: held.target for name, held in poser.held_points.items()} == {"other": target}
    assert poser.chosen_name == "other"
    poser.store("kept")
    assert len(document.robot.markers) == len(starfish.markers), "no second marker at the same place"


def test_a_stored_point_follows_its_marker_and_outlives_it(starfish: Robot, document: Document, poser: Poser) -> None:
    hold(poser, "body", tuple((0.8 * np.array(starfish.markers[0].at)).tolist()))
    poser.store("stored")
    document.change("rename", robot=named(document.robot, "point_1", "knuckle"))
    assert set(poser.held_points) == {"knuckle"}
    document.undo()
    assert set(poser.held_points) == {"point_1"}
    document.undo()
    assert document.robot is starfish
    assert set(poser.held_points) == {"point_1"}


def test_a_drag_goes_on_under_the_new_name_or_ends(starfish: Robot, document: Document, poser: Poser) -> None:
    marker = starfish.markers[0]
    assert poser.grab(Hit(key=f"marker:{marker.name}", rest=marker.at, world=marker.at))
    document.change("remove", robot=without(starfish, marker.name))
    poser.drag(Hit(world=(0.0, 0.0)))
    assert not poser.held_points


def test_a_cable_over_the_body_is_the_body(starfish: Robot, poser: Poser) -> None:
    middle = tuple(np.mean(starfish.cables[0].points[:2], axis=0).tolist())
    assert poser.grab(Hit(key="cable:0", rest=middle, world=middle))
    poser.drag(Hit(world=(middle[0] + 0.01, *middle[1:])))
    assert poser.held_points["point_1"].at == pytest.approx(middle, abs=1e-6)
    assert poser.held_points["point_1"].target == pytest.approx((middle[0] + 0.01, *middle[1:]))
    poser.rest()
    assert not poser.grab(Hit(key="cable:0", rest=None, world=middle)), "beside the body there is nothing to hold"


@pytest.mark.slow
def test_what_is_shown_is_of_one_robot(starfish: Robot, document: Document, monkeypatch: pytest.MonkeyPatch) -> None:
    """While one thread meets a new body, another one that draws sees the old one whole, or the new one whole."""
    from hydrostat.studio.posing import poser as module

    tail = gallery_robot("fish_tail")
    jobs = Jobs(document.bell)
    poser = Poser(document, jobs)
    poser.show_pose("wave")
    seen: list[tuple[int, set[str]]] = []

    class Watching(module.Anchored):
        """Draws at the moment when a new body is met."""

        def __init__(self, mesh: object) -> None:
            super().__init__(mesh)  # type: ignore[arg-type]
            fast = poser._now
            assert fast is not None
            seen.append((len(fast.shape.nodes), set(fast.targets.held)))

    monkeypatch.setattr(module, "Anchored", Watching)
    document.open(Work(robot=tail), folder=None)
    items = poser.scene_items()
    assert seen == [(len(starfish.body.mesh.nodes), set(starfish.poses["wave"].targets))]
    assert {item.key for item in items if isinstance(item, Dot)} >= {f"marker:{own.name}" for own in tail.markers}
    assert not poser.held_points
    jobs.close()
