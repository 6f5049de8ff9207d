"""The stage "pose" without a screen. Oracles: distances measured on the shape itself, `Simulation.solve`, undo."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from hydrostat.errors import InputError
from hydrostat.geometry import locate
from hydrostat.given import Point
from hydrostat.ik import solve_ik
from hydrostat.project import Wishes
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.posing.pose_state import Mode
from hydrostat.studio.posing.poser import READY, Poser
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.scene_items import Dot


@pytest.fixture
def poser(document: Document) -> Iterator[Poser]:
    jobs = Jobs(document.bell)
    yield Poser(document, jobs)
    jobs.close()


def settle(poser: Poser, most: int = 500) -> int:
    """Steps until there is no more to do."""
    for count in range(most):
        if not poser.step(0.01 * count):
            return count
    raise AssertionError(f"no end after {most} steps")


def place(robot: Robot, poser: Poser, at: Point) -> np.ndarray:
    """Where a point of the rest shape is now."""
    return locate(robot.body.mesh, np.array([at])).positions(poser.shape().nodes)[0]


def at_of(robot: Robot, name: str) -> Point:
    return next(marker.at for marker in robot.markers if marker.name == name)


def farthest(robot: Robot) -> tuple[str, Point]:
    """The marker that goes farthest in the pose "wave", and where it goes."""
    targets = robot.poses["wave"].targets
    name = max(targets, key=lambda own: float(np.linalg.norm(np.subtract(targets[own], at_of(robot, own)))))
    return name, targets[name]


def drag_marker(robot: Robot, poser: Poser, name: str, target: Point, moves: int = 10) -> None:
    """As a pointer would: from where the marker is to the target, a step of the poser for each move."""
    start = place(robot, poser, at_of(robot, name))
    assert poser.grab(Hit(key=f"marker:{name}", world=tuple(start.tolist())))
    for share in np.linspace(0, 1, moves + 1)[1:]:
        poser.drag(Hit(world=tuple((start + share * (np.array(target) - start)).tolist())))
        poser.step(0.0)
    poser.release()


@pytest.mark.parametrize("mode", list(Mode))
@pytest.mark.slow
def test_a_marker_that_is_dragged_ends_on_its_target(starfish: Robot, poser: Poser, mode: Mode) -> None:
    poser.set_mode(mode)
    name, target = farthest(starfish)
    drag_marker(starfish, poser, name, target)
    settle(poser)
    miss = np.linalg.norm(place(starfish, poser, at_of(starfish, name)) - target)
    best = 0.0 if mode is Mode.MUSCLES else solve_ik(Simulation(starfish), {name: target}).errors[name]
    assert miss < best + 1e-3
    assert poser.shape().errors[name] == pytest.approx(miss, abs=1e-9)


def test_cables_pull_as_simulation_says(starfish: Robot, poser: Poser) -> None:
    name, target = farthest(starfish)
    drag_marker(starfish, poser, name, target)
    settle(poser)
    shape = poser.shape()
    solved = Simulation(starfish).solve(shape.contractions)
    assert np.abs(shape.nodes - solved.nodes).max() < 1e-6
    assert shape.tensions == pytest.approx(solved.tensions, abs=1e-4)
    assert shape.tensions.max() > 0.1


@pytest.mark.parametrize("mode", list(Mode))
def test_any_point_of_the_body_can_be_dragged_and_stays_held(starfish: Robot, poser: Poser, mode: Mode) -> None:
    poser.set_mode(mode)
    at = tuple((0.9 * np.array(at_of(starfish, starfish.markers[0].name))).tolist())
    assert poser.grab(Hit(key="body", rest=at, world=at))
    assert not poser.held_points, "a grab alone holds nothing"
    target = (at[0] + 0.02, at[1] - 0.005)
    poser.drag(Hit(key="body", world=target))
    poser.release()
    settle(poser)
    (name,) = poser.held_points
    assert name == "point_1"
    miss = np.linalg.norm(place(starfish, poser, at) - target)
    assert poser.shape().errors == {"point_1": pytest.approx(miss, abs=1e-9)}
    if mode is Mode.MUSCLES:
        assert miss < 2e-4
    keys = {item.key for item in poser.scene_items() if isinstance(item, Dot)}
    assert {"point:point_1", "target:point_1"} <= keys


@pytest.mark.parametrize("by", [(-0.0107, 0.015), (-0.02, 0.028)])
def test_an_arm_dragged_out_of_reach_yanks_no_other(starfish: Robot, poser: Poser, by: Point) -> None:
    """Oracle: the left arm would go 68 mm aside, at the limit of its tension, for the last 2.6 mm of the right one."""
    at = at_of(starfish, "right")
    drag_marker(starfish, poser, "right", (at[0] + by[0], at[1] + by[1]))
    settle(poser)
    left = at_of(starfish, "left")
    assert np.linalg.norm(place(starfish, poser, left) - left) < 0.012
    assert poser.shape().errors["right"] < 0.65 * np.linalg.norm(by), "what its own winch can do is done"


@pytest.mark.parametrize("mode", list(Mode))
def test_a_target_out_of_reach_wrecks_nothing(starfish: Robot, poser: Poser, mode: Mode) -> None:
    poser.set_mode(mode)
    name = starfish.markers[0].name
    drag_marker(starfish, poser, name, (90.0, -90.0))
    settle(poser)
    shape = poser.shape()
    assert np.isfinite(shape.nodes).all()
    assert shape.errors[name] > 0.05
    assert shape.notes
    poser.rest()
    settle(poser)
    assert np.abs(poser.shape().nodes - starfish.body.mesh.nodes).max() < 1e-6


def test_the_tension_limit_holds(starfish: Robot, document: Document, poser: Poser) -> None:
    document.change("limit", wishes=Wishes.of(tension=2.0))
    name, target = farthest(starfish)
    drag_marker(starfish, poser, name, target)
    settle(poser)
    assert poser.shape().tensions.max() <= 2.0 * (1 + 2e-3)
    assert any("at maximum tension" in note for note in poser.shape().notes)
    assert max(bar.tension for bar in poser.bars()) == pytest.approx(poser.shape().tensions.max())


def test_the_first_step_only_says_that_it_may_take_a_while(starfish: Robot, poser: Poser) -> None:
    assert poser.step(0.0)
    assert poser.shape().notes == (READY,)
    assert np.array_equal(poser.shape().nodes, starfish.body.mesh.nodes)
    settle(poser)
    assert READY not in poser.shape().notes


def test_at_rest_there_is_nothing_to_do(poser: Poser) -> None:
    settle(poser)
    before = poser.shape()
    assert not poser.step(1.0)
    assert poser.shape() is before


def test_storing_makes_markers_of_plain_points_in_one_undo_step(
    starfish: Robot, document: Document, poser: Poser
) -> None:
    poser.set_mode(Mode.MUSCLES)
    at = starfish.body.mesh.nodes[starfish.body.mesh.boundary_nodes[0]]
    poser.grab(Hit(key="body", rest=tuple(at.tolist()), world=tuple(at.tolist())))
    poser.drag(Hit(world=tuple((at + 0.01).tolist())))
    poser.release()
    settle(poser)
    poser.store("held")
    robot = document.robot
    assert robot.markers[-1].name == "point_1"
    assert robot.markers[-1].at == pytest.approx(tuple(at), abs=1e-6)
    assert robot.poses["held"].targets["point_1"] == pytest.approx(tuple(at + 0.01), abs=1e-6)
    shape = poser.shape()
    assert poser.step(0.0) in (True, False)
    assert np.abs(poser.shape().nodes - shape.nodes).max() < 1e-4, "the body stays where it was"
    assert document.undo()
    assert document.robot is starfish
    assert set(poser.held_points) == {"point_1"}


def test_poses_are_chosen_renamed_and_deleted(starfish: Robot, document: Document, poser: Poser) -> None:
    poser.show_pose("wave")
    settle(poser)
    assert {name: held.target for name, held in poser.held_points.items()} == dict(starfish.poses["wave"].targets)
    assert set(poser.shape().errors) == set(starfish.poses["wave"].targets)
    order = list(starfish.poses)
    poser.rename_pose("wave", "hello")
    assert list(document.robot.poses) == ["hello" if name == "wave" else name for name in order]
    poser.delete_pose("hello")
    assert "hello" not in document.robot.poses
    assert document.undo()
    assert document.undo()
    assert document.robot is starfish
    with pytest.raises(InputError, match="unknown pose"):
        poser.show_pose("hello")
    with pytest.raises(InputError, match="already"):
        poser.rename_pose(order[0], order[1])
    with pytest.raises(InputError, match="pose name missing"):
        poser.rename_pose(order[0], "  ")


def test_nothing_held_is_no_pose(poser: Poser) -> None:
    with pytest.raises(InputError, match="no targets yet"):
        poser.store("empty")


def test_a_robot_without_cables_begins_with_muscles(starfish: Robot, document: Document, poser: Poser) -> None:
    assert poser.mode is Mode.CABLES
    document.change("no cables", robot=starfish.with_network((), ()))
    assert poser.mode is Mode.MUSCLES
    with pytest.raises(InputError, match="no cables yet"):
        poser.set_mode(Mode.CABLES)
    name, target = farthest(starfish)
    drag_marker(starfish, poser, name, target)
    settle(poser)
    assert poser.shape().errors[name] < 1e-3


def test_an_edited_robot_keeps_its_pose(starfish: Robot, document: Document, poser: Poser) -> None:
    poser.show_pose("wave")
    settle(poser)
    before = poser.shape()
    winches = tuple(replace(winch, travel=winch.travel + 0.001) for winch in starfish.winches)
    document.change("travel", robot=replace(starfish, winches=winches))
    assert np.array_equal(poser.shape().nodes, before.nodes)
    settle(poser)
    assert np.abs(poser.shape().nodes - before.nodes).max() < 1e-3


@pytest.mark.slow
def test_rubbing_cables_are_posed_as_they_rub_and_the_band_is_told(
    starfish: Robot, document: Document, poser: Poser
) -> None:
    """Oracles: inverse kinematics of the robot with friction, and `friction_hysteresis`, which is empty without it."""
    cables = tuple(replace(cable, friction=0.2) for cable in starfish.cables)
    document.change("friction", robot=replace(starfish, cables=cables))
    poser.show_pose("wave")
    settle(poser)
    simulation = Simulation(document.robot)
    best = solve_ik(simulation, starfish.poses["wave"])
    assert max(poser.shape().errors.values()) < max(best.errors.values()) + 1e-3
    smooth = Simulation(starfish).solve(poser.shape().contractions).nodes
    assert np.abs(poser.shape().nodes - smooth).max() > 1e-4, "without friction the body would be elsewhere"
    (note,) = [note for note in poser.shape().notes if note.startswith("friction hysteresis: ")]
    assert float(note.split("up to ")[1].split(" mm")[0]) == pytest.approx(
        1e3 * max(best.friction_hysteresis.values()), rel=0.3
    )
    document.change("none", robot=starfish)
    poser.show_pose("wave")
    settle(poser)
    assert not any("friction" in note for note in poser.shape().notes)


def test_keys(starfish: Robot, poser: Poser) -> None:
    marker = starfish.markers[0]
    poser.click(Hit(key=f"marker:{marker.name}", world=marker.at))
    assert poser.chosen_name == marker.name
    assert poser.key("g")
    target = tuple((np.array(marker.at) + 0.01).tolist())
    poser.click(Hit(world=target))
    assert poser.held_points[marker.name].target == pytest.approx(target)
    assert poser.key("delete")
    assert not poser.held_points
    poser.show_pose("wave")
    assert poser.key("r")
    assert not poser.held_points
    assert poser.key("escape")
    assert not poser.key("space")


def test_a_pointer_beside_the_body_holds_nothing(poser: Poser) -> None:
    assert not poser.grab(Hit(world=(1.0, 1.0)))
    poser.drag(Hit(world=(0.0, 0.0)))
    assert not poser.held_points


def test_drags_are_undone_between_the_changes_of_the_robot(starfish: Robot, document: Document, poser: Poser) -> None:
    """Oracle: what was held at each moment."""
    tip = starfish.markers[0].name
    drag_marker(starfish, poser, tip, (0.1, 0.02), moves=3)
    first = dict(poser.held_points)
    assert poser.undo_label == f"drag {tip}"
    poser.store("wave")
    assert not poser.undo_label, "the stored pose has to be undone first"
    drag_marker(starfish, poser, tip, (0.08, 0.04), moves=3)
    second = dict(poser.held_points)
    poser.undo()
    assert (poser.held_points, poser.undo_label, poser.redo_label) == (first, "", f"drag {tip}")
    poser.redo()
    assert poser.held_points == second
    poser.undo()
    assert document.undo()
    poser.undo()
    assert poser.held_points == {}
    settle(poser)
    assert np.abs(poser.shape().nodes - starfish.body.mesh.nodes).max() < 1e-6
    poser.redo()
    assert poser.held_points == first
    poser.rest()
    assert poser.undo_label == "rest"
    poser.undo()
    assert poser.held_points == first


def test_arrows_move_the_chosen_target_in_one_step_to_undo(poser: Poser, starfish: Robot) -> None:
    assert not poser.key("arrowup")  # nothing is chosen
    poser.choose("right")
    for name in ("arrowup", "arrowup", "shift arrowleft"):
        assert poser.key(name)
    at = at_of(starfish, "right")
    assert np.allclose(poser.held_points["right"].target, (at[0] - 0.010, at[1] + 0.002))
    assert poser.undo_label == "nudge right"
    poser.undo()
    assert not poser.held_points
    poser.redo()
    assert set(poser.held_points) == {"right"}
    poser.grab(Hit(key="marker:top", world=at_of(starfish, "top")))
    poser.drag(Hit(key="marker:top", world=(0.0, 0.2)))
    poser.release()
    poser.undo()
    poser.choose("right")
    poser.key("arrowup")
    assert poser.redo_label == "", "what was undone is on another line"


def test_arrows_leave_a_point_that_is_grabbed_but_not_held(poser: Poser, starfish: Robot) -> None:
    place = tuple(starfish.body.mesh.nodes.mean(axis=0))
    assert poser.grab(Hit(key="body", rest=place, world=place))
    assert poser.chosen_name
    assert not poser.held_points
    assert not poser.key("arrowup")
