"""Objects drawn with the body that holds them. Oracles: their distance fields, their volumes, what hides what."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_robot, gallery_robot, strip_robot

from hydrostat.plot import draw_portrait
from hydrostat.plot.open_sheet import open_sheet
from hydrostat.plot.pane import SpacePane, object_surface
from hydrostat.plot.picture_file import figure_pixels
from hydrostat.robot import Membrane, Obstacle, Robot, closed_mesh, get_material, rims
from hydrostat.simulation import with_obstacles

DENTED = """OFF
9 14 0
0 0 0
40 0 0
40 60 0
0 60 0
0 0 30
40 0 30
40 60 30
0 60 30
20 30 15
3 0 2 1\n3 0 3 2\n3 0 1 5\n3 0 5 4\n3 1 2 6\n3 1 6 5\n3 2 3 7\n3 2 7 6\n3 3 0 4\n3 3 4 7
3 4 5 8\n3 5 6 8\n3 6 7 8\n3 7 4 8
"""
"""A block whose top is dented to the middle: no hull of its points."""

AT, TO = (0.01, 0.02, 0.03), (0.05, 0.08, 0.06)
LONG = float(np.linalg.norm(np.subtract(TO, AT)))
VOLUMES = {
    "sphere": (Obstacle(name="a", shape="sphere", at=AT, radius=0.02), 4 / 3 * np.pi * 0.02**3),
    "capsule": (
        Obstacle(name="a", shape="capsule", at=AT, to=TO, radius=0.02),
        np.pi * 0.02**2 * LONG + 4 / 3 * np.pi * 0.02**3,
    ),
    "cylinder": (Obstacle(name="a", shape="cylinder", at=AT, to=TO, radius=0.02), np.pi * 0.02**2 * LONG),
    "box": (Obstacle(name="a", shape="box", at=AT, to=TO), 0.04 * 0.06 * 0.03),
    "mesh": (
        Obstacle(name="a", shape="mesh", at=AT, mesh=closed_mesh(DENTED.encode(), "dented.off")),
        0.04 * 0.06 * 0.03 * 5 / 6,
    ),
}


@pytest.mark.parametrize("shape", VOLUMES)
def test_a_surface_lies_on_the_thing_and_looks_outward(shape: str) -> None:
    obstacle, volume = VOLUMES[shape]
    places, triangles = object_surface(obstacle)
    used = places[np.unique(triangles)]
    assert np.abs(obstacle.field()(used).values).max() < 1e-4  # a capsule has corners on both balls, some a hair inside
    assert np.linalg.det(places[triangles]).sum() / 6 == pytest.approx(volume, rel=0.015)


def test_what_lies_behind_the_body_is_hidden_by_it() -> None:
    """A ball is seen whole in front of the body, in part or not at all behind it; by the pixels that it changes."""
    robot = box_robot()
    nodes = robot.body.mesh.nodes
    middle, size = nodes.mean(axis=0), np.ptp(nodes, axis=0)
    changed = []
    frame = np.concatenate([middle + 3 * size.max() * np.eye(3), middle - 3 * size.max() * np.eye(3)])
    bare = figure_pixels(draw_portrait(robot, nodes, frame=frame), dpi=80).astype(int)
    for sign in (-1.0, 1.0):
        at = middle + sign * np.array([0.0, 1.2 * size[1], 0.0])
        ball = Obstacle(name="ball", shape="sphere", at=tuple(at), radius=0.3 * float(size.min()))
        assert rims(ball, robot)
        drawn = figure_pixels(draw_portrait(robot, nodes, frame=frame, obstacles=[ball]), dpi=80).astype(int)
        changed.append(int((np.abs(drawn - bare).max(axis=2) > 40).sum()))
    assert changed[0] != changed[1]
    assert max(changed) > 20


@pytest.mark.parametrize("robot", [box_robot(), strip_robot(columns=8, rows=2)], ids=["space", "flat"])
def test_a_sheet_is_tinted_where_it_lies(robot: Robot) -> None:
    """About half of the body's pixels change, those on one side of it."""
    nodes = robot.body.mesh.nodes
    low, high = nodes.min(axis=0) - 0.01, nodes.max(axis=0) + 0.01
    middle = (*(low[:1] + high[:1]) / 2, *high[1:])
    half = {"shape": "box", "at": tuple(low.tolist()), "to": tuple(float(value) for value in middle)}
    cover = Membrane(name="glove", material=get_material("ecoflex 00-30"), thickness=1e-3, **half)
    views = [figure_pixels(draw_portrait(one, nodes), dpi=40) for one in (robot, replace(robot, sheets=(cover,)))]
    changed = np.abs(views[0].astype(int) - views[1]).max(axis=2) > 10
    body = views[0].min(axis=2) < 245
    places = [np.argwhere(mask) for mask in (changed, body & ~changed)]
    assert 0.1 < len(places[0]) / body.sum() < 0.6
    apart = np.linalg.norm(places[0].mean(axis=0) - places[1].mean(axis=0))
    assert apart > 0.2 * np.ptp(np.argwhere(body), axis=0).max()


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_thing_beside_a_hand_is_seen_before_it(side: float) -> None:
    robot = gallery_robot("cupping_hand")
    ball = Obstacle(name="ball", shape="sphere", at=(0.0, side * 0.12, 0.1), radius=0.02)
    _, panes = open_sheet(with_obstacles(robot, [ball]), [robot.body.mesh.nodes], ruled=False)
    assert isinstance(panes[0], SpacePane)
    middle, there = panes[0].camera.see(np.array([robot.body.mesh.nodes.mean(axis=0), ball.at]))
    assert there[2] > middle[2]
