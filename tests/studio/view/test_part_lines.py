"""Lines that show the parts of a body in space. Oracles: the edges of a part's border, and the sphere that it fills."""

from dataclasses import replace

import numpy as np
from builders import gallery_robot

from hydrostat.drawing import Color
from hydrostat.robot import BodyPart, Robot, find_part_facets
from hydrostat.studio.view.robot_items import find_part_lines, robot_items
from hydrostat.studio.view.scene_items import Strand, Stroke

MIDDLE, RADIUS = np.array([0.0, 0.0, -0.09]), 0.018


def robot_with_ball() -> Robot:
    robot = gallery_robot("trunk")
    ball = BodyPart(name="ball", shape="sphere", at=tuple(MIDDLE), radius=RADIUS, density=1240.0)
    return replace(robot, body=robot.body.with_parts([ball]))


def test_a_rigid_ball_in_a_body_is_shown_by_a_closed_line_across_each_axis() -> None:
    """Each corner of a line is on an edge of the border. The middle of a regular element is 0.61 edges off its corners,
    so the border of the elements whose middles are in the ball is at most so far off the ball."""
    robot = robot_with_ball()
    lines = find_part_lines(robot.body)
    mesh, (facets,) = robot.body.mesh, find_part_facets(robot.body.mesh, robot.body.element_materials, 1)
    starts, ends = (mesh.nodes[np.roll(facets, turn, axis=1)].reshape(-1, 3) for turn in (0, 1))
    off = 0.612 * (robot.body.element_size or 0.0)
    assert len(lines) >= 3
    for line in lines:
        assert (line[0] == line[-1]).all()
        assert np.ptp(line, axis=0).min() < 1e-12
        away = np.linalg.norm(line - MIDDLE, axis=1)
        assert (np.abs(away - RADIUS) < off).all()
        shares = ((line[:, None] - starts) * (ends - starts)).sum(axis=2) / ((ends - starts) ** 2).sum(axis=1)
        feet = starts + np.clip(shares, 0.0, 1.0)[..., None] * (ends - starts)
        assert np.linalg.norm(line[:, None] - feet, axis=2).min(axis=1).max() < 1e-12
    shown = [item for item in robot_items(robot) if isinstance(item, Strand) and item.stroke is Stroke.DRAWN]
    assert len(shown) == len(lines)
    assert {item.color for item in shown} == {Color.MUTED}
    assert find_part_lines(gallery_robot("trunk").body) == ()
