"""Parts inside a body in space are drawn. Oracle: the circle that a ball covers for an orthographic camera."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot
from matplotlib.patches import PathPatch

from hydrostat.plot import draw_rest
from hydrostat.robot import BodyPart, Robot


def _part_sides(robot: Robot) -> list[np.ndarray]:
    """Width and height [mm] of each dashed outline in a figure."""
    patches = [patch for axes in draw_rest(robot).axes for patch in axes.findobj(PathPatch)]
    return [
        np.ptp(patch.get_path().vertices, axis=0) for patch in patches if patch.get_linestyle() not in ("-", "solid")
    ]


@pytest.mark.slow
def test_a_rigid_ball_in_a_body_is_outlined_in_its_size() -> None:
    robot = gallery_robot("trunk")
    ball = BodyPart(name="ball", shape="sphere", at=(0.0, 0.0, -0.09), radius=0.018, density=1240.0)
    drawn = _part_sides(replace(robot, body=robot.body.with_parts([ball])))
    assert not _part_sides(robot)
    assert drawn
    for sides in drawn:
        assert sides == pytest.approx(36.0, rel=0.45)
