"""What is up in a picture: against gravity. Oracle: the same robot and gravity, turned as one, look the same."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_mesh, box_robot
from matplotlib.text import Text
from scipy.spatial.transform import Rotation

from hydrostat import plot
from hydrostat.drawing import Camera
from hydrostat.geometry import Mesh
from hydrostat.plot.open_sheet import open_sheet, way_up
from hydrostat.robot import Load, PoseTarget, Robot

WAYS = ([0.0, 0, 1], [0, 1, 0], [1, 0, 0], [0, 0, -1], [0, -1, 0], [-1, 0, 0], [0.3, -0.5, 0.8], [1e-9, 0, -1])


def turned(robot: Robot, turn: Rotation) -> Robot:
    """A robot, its gravity too, turned about the origin; pins are spheres, which turning leaves alike."""
    from hydrostat.robot import Pin

    def move(point: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(float(value) for value in turn.apply(np.array(point)))

    mesh = robot.body.mesh
    return replace(
        robot,
        body=replace(robot.body, mesh=Mesh(turn.apply(mesh.nodes.copy()), mesh.elements)),
        pins=(Pin(at=move((0.0, 0.02, 0.02)), radius=0.035),),
        winches=tuple(replace(winch, at=move(winch.at)) for winch in robot.winches),
        cables=tuple(replace(cable, points=tuple(move(point) for point in cable.points)) for cable in robot.cables),
        markers=tuple(replace(marker, at=move(marker.at)) for marker in robot.markers),
        gravity=None if robot.gravity is None else move(robot.gravity),
    )


@pytest.mark.parametrize("way", WAYS)
def test_the_way_up_is_upright_in_both_views(way: list[float]) -> None:
    """Oracle: what is up has no share to the right and a share upwards; along an axis, the nearest axis has all."""
    up = np.array(way, dtype=float) / np.linalg.norm(way)
    nodes = box_mesh((4, 3, 2), size=(0.1, 0.05, 0.03)).nodes
    camera = Camera.three_quarter(nodes, np.empty((0, 3)), up)
    right, high, near = camera.axes @ up
    assert right == pytest.approx(0, abs=1e-9)
    assert high > 0.5
    assert near > 0
    assert camera.sky == pytest.approx([right, high, near], abs=1e-8)
    side = Camera.along_an_axis(nodes, np.empty((0, 3)), np.zeros_like(nodes), up)
    assert np.sort(np.abs(side.axes), axis=1) == pytest.approx(np.tile([0, 0, 1], (3, 1)), abs=1e-12)
    nearest = np.zeros(3)
    nearest[np.argmax(np.abs(up))] = np.sign(up[np.argmax(np.abs(up))])
    assert side.axes[1] @ nearest == pytest.approx(1) or side.axes[2] @ nearest == pytest.approx(1)


@pytest.mark.parametrize("way", WAYS)
def test_the_turn_upright_is_a_turn(way: list[float]) -> None:
    """Oracle: an orthogonal matrix of determinant 1 that takes the way to z."""
    turn = Camera.upright(np.array(way, dtype=float))
    assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-8)
    assert np.linalg.det(turn) == pytest.approx(1)
    assert turn @ np.array(way) == pytest.approx([0, 0, np.linalg.norm(way)], abs=1e-8)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
@pytest.mark.parametrize("angle", [90, 180, 270])
def test_a_robot_turned_with_its_gravity_looks_the_same(axis: str, angle: int) -> None:
    """Oracle: places of all nodes on the sheet, but for which of two views as good as each other was chosen."""
    robot = turned(replace(box_robot(), gravity=(0.0, 0.0, -9.81)), Rotation.identity())
    turn = Rotation.from_euler(axis, angle, degrees=True)
    other = turned(robot, turn)
    one, two = (open_sheet(each, [each.body.mesh.nodes], ruled=False)[1][0] for each in (robot, other))
    spread = [np.ptp(pane.places(each.body.mesh.nodes), axis=0) for pane, each in ((one, robot), (two, other))]
    assert spread[0] == pytest.approx(spread[1], rel=1e-6)
    assert one.camera.sky == pytest.approx(two.camera.sky, abs=1e-9)  # pyright: ignore[reportAttributeAccessIssue]


def test_a_mirrored_body_is_seen_from_the_mirrored_side() -> None:
    """Oracle: the cameras of a body and of its mirror image in y, whose eyes mirror each other."""
    nodes = box_mesh((4, 3, 2), size=(0.1, 0.05, 0.03)).nodes - np.array([0.05, 0.025, 0.015])
    shown = np.array([[0.02, 0.02, 0.01], [0.03, 0.02, 0.0]])
    mirror = np.array([1.0, -1.0, 1.0])
    one, two = (Camera.three_quarter(nodes * side, shown * side) for side in (np.ones(3), mirror))
    assert one.axes[2] * mirror == pytest.approx(two.axes[2], abs=1e-9)
    assert one.axes[1] * mirror == pytest.approx(two.axes[1], abs=1e-9)
    assert one.axes[0] * mirror == pytest.approx(-two.axes[0], abs=1e-9)


def test_the_eye_sees_markers_come() -> None:
    """Oracle: where nothing else decides, the eye is on the side that the points move to."""
    nodes = box_mesh((4, 3, 2), size=(0.1, 0.05, 0.03)).nodes
    for way in (0.03, -0.03):
        camera = Camera.three_quarter(nodes, np.empty((0, 3)), None, np.array([[0.0, way, 0.0]]))
        assert np.sign(camera.axes[2, 1]) == np.sign(way)


def test_robots_say_what_is_up() -> None:
    robot = box_robot()
    assert way_up(robot).tolist() == [0, 0, 1]
    assert way_up(replace(robot, gravity=(0.0, 0.0, 0.0))).tolist() == [0, 0, 1]
    assert way_up(replace(robot, gravity=(0.0, -9.81, 0.0))).tolist() == [0, 1, 0]


def test_a_heavy_box_sags_downwards_in_its_picture() -> None:
    """Oracle: gravity; the tip's place on the sheet, lower than the rest pose's, whichever way gravity goes."""
    from hydrostat.simulation import Simulation

    for gravity in ((0.0, -9.81, 0.0), (0.0, 0.0, 9.81)):
        robot = replace(box_robot(), gravity=gravity)
        pose = Simulation(robot).solve({})
        panes = open_sheet(robot, [pose.nodes, robot.body.mesh.nodes])[1]
        for pane in panes:
            sunk = pane.places(pose.nodes) - pane.places(robot.body.mesh.nodes)
            assert sunk[:, 1].mean() < 0
            assert abs(sunk[:, 0].mean()) < 0.3 * abs(sunk[:, 1].mean())


@pytest.mark.slow
def test_what_a_picture_says_of_a_pose() -> None:
    """Oracle: how the solver ended; of a motion, what the caller says, and never that it converged."""
    from hydrostat.mechanics import NewtonStatus
    from hydrostat.simulation import Simulation

    robot = box_robot()
    pose = Simulation(robot).solve(np.array([0.005, 0.0]))
    loaded = replace(robot, loads=(Load(name="push", marker=robot.markers[0].name, force=(0.0, 0.0, -2.5)),))
    failed = replace(pose, result=replace(pose.result, status=NewtonStatus.ITERATION_LIMIT))
    for drawn, words in (
        (plot.draw_pose(robot, pose, width=3.2), "at rest under the given contractions"),
        (plot.draw_pose(robot, failed, width=3.2), "not at rest under the given contractions: iteration limit reached"),
        (plot.draw_pose(robot, pose, note="after 2 s of motion", width=3.2), "after 2 s of motion"),
        (
            plot.draw_pose(loaded, replace(pose, robot=loaded), width=3.2),
            "at rest under the given contractions and loads",
        ),
        (plot.draw_pose(loaded, replace(pose, robot=loaded), width=3.2), "2.5 N"),
        (plot.draw_pose(robot, replace(pose, tensions=np.array([123.4, 0.0])), width=3.2), "120 N"),
    ):
        assert words in {text.get_text() for text in drawn.findobj(Text)}


def test_targets_of_poses_decide_where_the_eye_is() -> None:
    robot = replace(box_robot(), winches=(), cables=())
    eyes = []
    for way in (0.3, -0.3):
        pose = PoseTarget(name="away", targets={"tip": (0.12, 0.02 + way, 0.02)})
        posed = replace(robot, poses={"away": pose})
        (pane,) = open_sheet(posed, [posed.body.mesh.nodes], ruled=False)[1]
        eyes.append(pane.camera.axes[2, 1])  # pyright: ignore[reportAttributeAccessIssue]
    assert eyes[0] > 0 > eyes[1]


def test_a_camera_looks_from_where_it_is_told() -> None:
    eye = np.array([0.2, 0.5, -0.3])
    camera = Camera.towards(eye, up=np.array([1.0, 0, 0]))
    assert camera.axes[2] == pytest.approx(eye / np.linalg.norm(eye))
    assert camera.axes[0] @ [1, 0, 0] == pytest.approx(0, abs=1e-12)
