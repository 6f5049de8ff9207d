"""Small pictures of robots. Oracle: colors at places that the drawing puts there."""

from dataclasses import replace
from io import BytesIO

import numpy as np
from PIL import Image

from hydrostat.drawing import Color
from hydrostat.robot import Robot, gallery_folder, load_robot
from hydrostat.studio.view.scene_items import rest_shape
from hydrostat.studio.view.thumbnail import draw_thumbnail


def test_a_thumbnail_shows_eyes_cables_and_winches() -> None:
    robot = load_robot(gallery_folder("starfish"))
    middle = robot.body.mesh.nodes.mean(axis=0)
    eye = middle + np.array([[-0.02, 0.02], [0.0, 0.02], [0.02, 0.02]])
    seen = replace(robot, body=replace(robot.body, marks=(eye,)))

    def count(robot: Robot, color: str) -> int:
        picture = Image.open(BytesIO(draw_thumbnail(robot, rest_shape(robot)))).convert("RGBA")
        wanted = [int(color[place : place + 2], 16) for place in (1, 3, 5)]
        return int((np.abs(np.asarray(picture, dtype=int)[..., :3] - wanted).max(axis=2) < 60).sum())

    assert count(seen, Color.INK) > count(robot, Color.INK) + 20
    for color in Color.of_winches(robot.winches).values():
        assert count(robot, color) > 60
