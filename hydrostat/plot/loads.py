"""`draw_loads`, `draw_rods`: forces on a body and rods in it."""

import numpy as np
from matplotlib.patches import FancyArrowPatch

from hydrostat.arrays import Nodes
from hydrostat.drawing import Color
from hydrostat.geometry import locate
from hydrostat.plot.pane import Pane
from hydrostat.plot.sheet import PictureSheet
from hydrostat.robot import Robot


def draw_rods(sheet: PictureSheet, pane: Pane, robot: Robot, nodes: Nodes) -> None:
    """A line along each rod of a body with its nodes at `nodes` [m]."""
    for rod in robot.rods:
        corners = np.array(rod.points)
        shares = np.linspace(0, len(corners) - 1, 100 * (len(corners) - 1) + 1)
        line = np.stack([np.interp(shares, np.arange(len(corners)), column) for column in corners.T], axis=1)
        places = pane.places(locate(robot.body.mesh, line).positions(nodes))
        for color, width, order in ((Color.LIGHT, 3.4, 8), (Color.MUTED, 2.0, 8.1)):
            sheet.curve(places, color=color, linewidth=width, zorder=order)


def draw_loads(sheet: PictureSheet, pane: Pane, robot: Robot, nodes: Nodes) -> None:
    """An arrow along the force of each load, with newtons at its end, on a body with its nodes at `nodes` [m]."""
    if not robot.loads:
        return
    places, forces = locate(robot.body.mesh, robot.load_points()).positions(nodes), robot.load_forces()
    largest = max(float(np.linalg.norm(forces, axis=1).max()), 1e-300)
    for at, force in zip(places, forces, strict=True):
        size = float(np.linalg.norm(force))
        if size == 0.0:
            continue
        length = 1e-3 * sheet.scale * (18 + 20 * size / largest)  # [m], as points on the picture
        start, end = pane.places(np.array([at, at + length * force / size]))
        arrow = FancyArrowPatch(
            tuple(start), tuple(end), arrowstyle="-|>,head_length=5,head_width=2.5", shrinkA=0, shrinkB=0,
            color=Color.ERROR, linewidth=1.8, zorder=17.5, clip_on=False,
        )  # fmt: skip
        sheet.axes.add_patch(arrow)
        beside = end + 4 * sheet.scale * (end - start) / max(float(np.linalg.norm(end - start)), 1e-300)
        style = {"color": Color.ERROR, "fontsize": 7, "weight": "bold", "ha": "center", "va": "center", "zorder": 18}
        sheet.text((float(beside[0]), float(beside[1])), f"{size:.3g} N", **style)
