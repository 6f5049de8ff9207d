"""`draw_stage`: one of several networks of the same body, small, all from the same side and in the same frame."""

from collections.abc import Iterable

import numpy as np
from matplotlib.figure import Figure

from hydrostat.plot.hardware import cable_points, draw_cables, draw_winches, winch_points
from hydrostat.plot.open_sheet import open_sheet
from hydrostat.plot.places import Spread
from hydrostat.plot.skin import Skin
from hydrostat.plot.targets import draw_markers, rest_markers
from hydrostat.robot import Robot

SMALL = 2.7
"""Width of such a picture [inch]."""


def draw_stage(robot: Robot, *, like: Robot, frame: Spread, width: float = SMALL) -> Figure:
    """A network on the rest shape, each cable in the colour of its winch, without words.

    Args:
        robot: with the network.
        like: the robot from whose best side all of them are seen.
        frame: points that the picture must hold [m], see `stage_frame`.
        width: of the picture [inch].
    """
    nodes = robot.body.mesh.nodes
    sheet, (pane, *_) = open_sheet(like, [], [frame], width=width, ruled=False)
    surface = pane.draw_body(sheet, nodes, pins=True)
    draw_cables(sheet, robot, [surface.run(points) for points in cable_points(robot, nodes)], width=1.8)
    winches = winch_points(robot, nodes)
    draw_winches(sheet, robot, pane.places(winches), surface.fades(winches))
    draw_markers(sheet, pane.named(rest_markers(robot)), size=3.4)
    return sheet.figure


def stage_frame(robots: Iterable[Robot]) -> Spread:
    """Points that hold the rest shape and all networks of robots of one body [m]."""
    robots = list(robots)
    body = robots[0].body
    shape = body.mesh.nodes[body.mesh.boundary_nodes]
    if body.mesh.dim == 2:
        shape = Skin.of(body).shape(body.mesh.nodes)[0]
    points = [point for robot in robots for cable in robot.cables for point in cable.points]
    points += [winch.at for robot in robots for winch in robot.winches]
    return np.concatenate([shape, np.array(points, dtype=float).reshape(-1, body.mesh.dim)])
