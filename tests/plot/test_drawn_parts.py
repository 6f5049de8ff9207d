"""Parts inside a body are drawn and named. Oracle: the extents of their own nodes in the mesh."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot
from matplotlib.patches import PathPatch

from hydrostat.plot import draw_rest
from hydrostat.robot import BodyPart, Membrane, Obstacle, Robot, Rod, get_material

SILICONE = get_material("dragon skin 30")


def _part_sides(robot: Robot) -> list[np.ndarray]:
    """Width and height [mm] of each dashed outline in a figure."""
    patches = [patch for axes in draw_rest(robot).axes for patch in axes.findobj(PathPatch)]
    return [
        np.ptp(patch.get_path().vertices, axis=0) for patch in patches if patch.get_linestyle() not in ("-", "solid")
    ]


@pytest.mark.slow
def test_a_rigid_ball_in_a_body_is_outlined_in_its_size() -> None:
    """Two views: the second one along an axis, so that sides are extents, the first one no wider than any two nodes."""
    robot = gallery_robot("trunk")
    ball = BodyPart(name="ball", shape="sphere", at=(0.0, 0.0, -0.09), radius=0.018, density=1240.0)
    body, pixel = robot.body.with_parts([ball]), 0.5
    nodes = 1e3 * body.mesh.nodes[np.unique(body.mesh.elements[body.element_materials == 1])]
    turned, along = _part_sides(replace(robot, body=body))
    assert not _part_sides(robot)
    sides = np.ptp(nodes, axis=0)
    assert along == pytest.approx(sides[[1, 2]], abs=2 * pixel)
    assert turned.max() < np.linalg.norm(nodes[:, None] - nodes, axis=2).max() + 2 * pixel


def _shown(robot: Robot) -> tuple[set[str], np.ndarray]:
    """Texts in a figure at rest, and the limits of its axes [mm]."""
    (axes,) = draw_rest(robot).axes
    return {text.get_text() for text in axes.texts}, np.array([axes.get_xlim(), axes.get_ylim()])


def test_parts_are_named_and_near_obstacles_whole() -> None:
    """Oracle: the extents of a disc below the body, and of one that is farther away than half the body."""
    robot = gallery_robot("starfish")
    bone = BodyPart(name="bone", shape="sphere", at=(0.0, 0.0), radius=0.016, density=1240.0)
    core = BodyPart(name="core", shape="box", at=(-0.012, 0.03), to=(0.012, 0.055), material=SILICONE)
    felt = Membrane(
        name="felt",
        shape="box",
        at=(-0.09, -0.09),
        to=(-0.03, -0.02),
        thickness=8e-4,
        material=SILICONE,
    )
    near = Obstacle(name="ball", shape="sphere", at=(0.0, -0.2), radius=0.022)
    robot = replace(
        robot,
        body=robot.body.with_parts([bone, core]),
        sheets=(felt,),
        rods=(Rod(name="spine", points=((0.0, -0.05), (0.0, 0.1)), diameter=1e-3, young=2e9),),
        obstacles=(near, replace(near, name="far", at=(0.0, -0.5))),
    )
    words, limits = _shown(robot)
    assert {"bone: rigid", "core: dragon skin 30", "felt: sheet", "spine: rod", "ball"} <= words
    assert "far" not in words
    assert -400 < limits[1].min() < -222
