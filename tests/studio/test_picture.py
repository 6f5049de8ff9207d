"""What screens are sent. The oracle is the robot's own mesh and anchors."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.drawing import Color
from hydrostat.fabrication import winch_marks_of
from hydrostat.geometry import locate
from hydrostat.robot import Robot
from hydrostat.studio.view.picture import Picture, packet, parse_message
from hydrostat.studio.view.robot_items import DETAIL, robot_items, target_items, winch_bars
from hydrostat.studio.view.scene_items import Area, Cloud, Dot, Ghost, Look, Stroke, rest_shape

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture(scope="module", params=["starfish", "tongue"])
def robot(request: pytest.FixtureRequest) -> Robot:
    return gallery_robot(request.param)


def test_a_packet_opens_to_what_was_put_in() -> None:
    rows = np.arange(12.0).reshape(4, 3)
    numbers = np.array([[1, 2]], dtype=np.uint32)
    head, arrays = parse_message(
        packet({"kind": "frame", "name": "Seestern é"}, {"a": rows, "b": numbers, "c": rows[:0]})
    )
    assert head == {"kind": "frame", "name": "Seestern é"}
    assert np.array_equal(arrays["a"], rows)
    assert np.array_equal(arrays["b"], numbers)
    assert arrays["c"].shape == (0, 3)


def test_the_scene_has_the_surface_of_the_body(robot: Robot) -> None:
    head, arrays = parse_message(Picture(robot, robot_items(robot), 7).scene())
    mesh = robot.body.mesh
    assert (head["serial"], head["dim"], head["name"]) == (7, mesh.dim, robot.name)
    faces = mesh.elements if mesh.dim == 2 else mesh.boundary
    there = arrays["rest"][arrays["faces"]][..., : mesh.dim]
    assert np.allclose(there, mesh.nodes[faces], atol=1e-6)
    if mesh.dim == 2:
        assert (arrays["rest"][:, 2] == 0).all()
        assert np.allclose(arrays["rest"][arrays["rim"]][..., :2], mesh.nodes[mesh.boundary], atol=1e-6)


def test_a_frame_moves_what_is_stuck_to_the_body(robot: Robot) -> None:
    mesh = robot.body.mesh
    items = robot_items(robot, vias=True)
    picture = Picture(robot, items, 1)
    moved = mesh.nodes * 1.1 + 0.01
    _, arrays = parse_message(picture.frame(moved, items, {}))
    head, _ = parse_message(picture.scene())
    style = next(style for style in head["items"] if style["kind"] == "dot" and style["look"] == "marker")
    marker = robot.markers[0]
    expected = locate(mesh, np.array([marker.at])).positions(moved)[0]
    assert np.allclose(arrays["points"][style["first"], : mesh.dim], expected, atol=1e-6)
    assert len(arrays["loads"]) == sum(style["kind"] == "line" for style in head["items"])


def test_places_in_the_world_and_loads_need_no_new_scene(robot: Robot) -> None:
    name, at = robot.markers[0].name, robot.markers[0].at
    away = tuple(value + 0.01 for value in at)

    def items(target: tuple[float, ...], tension: float) -> list:
        tensions = np.full(len(robot.cables), tension)
        return [*robot_items(robot, tensions=tensions), *target_items({name: target}, {name: at})]

    picture = Picture(robot, items(at, 0.0), 1)
    assert picture.fits(robot, items(away, 5.0))
    _, arrays = parse_message(picture.frame(robot.body.mesh.nodes, items(away, 5.0), {}))
    assert np.allclose(arrays["points"][-1, : len(away)], away, atol=1e-6)
    assert not picture.fits(robot, robot_items(robot))
    assert not picture.fits(robot, items(at, 0.0)[1:])


def test_what_is_stuck_elsewhere_needs_a_new_scene(robot: Robot) -> None:
    dot = Dot(at=robot.markers[0].at, look=Look.MARKER, color="#000000")
    other = Dot(at=tuple(value + 0.001 for value in dot.at), look=Look.MARKER, color="#000000")
    assert not Picture(robot, [dot], 1).fits(robot, [other])


def test_ghosts_clouds_and_areas_come_along(robot: Robot) -> None:
    mesh = robot.body.mesh
    cloud = Cloud(name="reach", points=mesh.nodes[:5] + 1.0, color="#0b5fa5")
    ghost = Ghost(name="rest", nodes=mesh.nodes, color="#b4afbc")
    area = Area(key="zone:0", color="#c8243f", at=tuple(mesh.nodes[0].tolist()), radius=0.01)
    items = [area, ghost, cloud]
    picture = Picture(robot, items, 1)
    head, arrays = parse_message(picture.scene())
    assert [style["kind"] for style in head["items"]] == ["area", "ghost", "cloud"]
    assert np.allclose(arrays["cloud:reach"][:, : mesh.dim], mesh.nodes[:5] + 1.0, atol=1e-6)
    assert arrays["ghost:rest"].shape == arrays["rest"].shape
    assert picture.fits(robot, items)
    assert not picture.fits(robot, [area, ghost, Cloud(name="reach", points=mesh.nodes[:6], color="#0b5fa5")])


def test_corners_beside_the_body_go_along_with_the_nearest_place(robot: Robot) -> None:
    mesh = robot.body.mesh
    inside = mesh.nodes[mesh.elements[0]].mean(axis=0)
    outside = mesh.nodes.max(axis=0) + 0.02
    third = np.where(np.arange(mesh.dim) == 0, outside, inside)
    corners = np.array([inside, outside, third])
    area = Area(key="zone:0", color="#c8243f", outline=tuple(tuple(corner.tolist()) for corner in corners))
    picture = Picture(robot, [area], 1)
    _, arrays = parse_message(picture.frame(mesh.nodes, [area], {}))
    assert np.allclose(arrays["points"][:, : mesh.dim], corners, atol=1e-6)
    shift = np.arange(1, mesh.dim + 1) * 0.01
    _, arrays = parse_message(picture.frame(mesh.nodes + shift, [area], {}))
    assert np.allclose(arrays["points"][:, : mesh.dim], corners + shift, atol=1e-6)


def test_values_are_those_of_the_shown_nodes(robot: Robot) -> None:
    mesh = robot.body.mesh
    values = np.linspace(0.0, 1.0, len(mesh.nodes))
    picture = Picture(robot, [], 1)
    _, arrays = parse_message(picture.frame(mesh.nodes, [], {}, values=values))
    shown = np.arange(len(mesh.nodes)) if mesh.dim == 2 else np.unique(mesh.boundary)
    assert np.allclose(arrays["values"][:, 0], values[shown], atol=1e-6)


def test_winches_have_the_marks_of_the_kit() -> None:
    """The sheet's own marks in the view and in the bars of Pose (finding 34); a color each, up to sixteen."""
    robot = gallery_robot("starfish")
    marks = winch_marks_of(robot)
    dots = [item for item in robot_items(robot) if isinstance(item, Dot) and item.key.startswith("winch:")]
    assert {dot.label: dot.short for dot in dots} == marks
    assert {bar.winch: bar.mark for bar in winch_bars(robot, rest_shape(robot), 20.0)} == marks
    many = [replace(robot.winches[0], name=f"winch_{number}") for number in range(16)]
    assert len(set(Color.of_winches(many).values())) == 16


def test_eyes_are_shown_and_go_along_with_the_body() -> None:
    """Oracle: a body that is moved as a whole."""
    robot = gallery_robot("starfish")
    eye = 0.01 * np.stack([np.cos(np.linspace(0, 6, 5000)), np.sin(np.linspace(0, 6, 5000))], axis=1)
    robot = replace(robot, body=replace(robot.body, marks=(eye,)))
    items = robot_items(robot)
    picture = Picture(robot, items, 1)
    head, _ = parse_message(picture.scene())
    (drawn,) = [item for item in head["items"] if item.get("stroke") == Stroke.DRAWN]
    assert drawn["count"] <= 2 * DETAIL, "no drawing makes each frame heavy"
    by = np.array([0.02, -0.01])
    _, arrays = parse_message(picture.frame(robot.body.mesh.nodes + by, items, {}))
    points = arrays["points"][drawn["first"] : drawn["first"] + drawn["count"], :2]
    assert np.linalg.norm(points - by, axis=1) == pytest.approx(0.01, abs=1e-6)
    assert np.allclose(points[[0, -1]], eye[[0, -1]] + by, atol=1e-6)
