"""Lines that show the parts of a body in space. Oracle: the sphere that a part fills."""

from dataclasses import replace

import numpy as np
from builders import gallery_robot

from hydrostat.drawing import Color
from hydrostat.robot import BodyPart, Robot
from hydrostat.studio.view.part_lines import find_part_lines
from hydrostat.studio.view.robot_items import robot_items
from hydrostat.studio.view.scene_items import Strand, Stroke

MIDDLE, RADIUS = np.array([0.0, 0.0, -0.09]), 0.018


def robot_with_ball() -> Robot:
    robot = gallery_robot("trunk")
    ball = BodyPart(name="ball", shape="sphere", at=tuple(MIDDLE), radius=RADIUS, density=1240.0)
    return replace(robot, body=robot.body.with_parts([ball]))


def test_a_rigid_ball_in_a_body_is_shown_by_a_closed_line_across_each_axis() -> None:
    robot = robot_with_ball()
    lines = find_part_lines(robot.body)
    assert len(lines) >= 3
    for line in lines:
        assert (line[0] == line[-1]).all()
        assert np.ptp(line, axis=0).min() < 1e-12
        away = np.linalg.norm(line - MIDDLE, axis=1)
        assert (away > 0.3 * RADIUS).all()
        assert (away < 2.0 * RADIUS).all()
    shown = [item for item in robot_items(robot) if isinstance(item, Strand) and item.stroke is Stroke.DRAWN]
    assert len(shown) == len(lines)
    assert {item.color for item in shown} == {Color.MUTED}
    assert find_part_lines(gallery_robot("trunk").body) == ()
