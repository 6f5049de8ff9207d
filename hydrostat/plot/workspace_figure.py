"""`draw_workspace`: all that each marker of a robot can be brought to, over the rest shape."""

from collections.abc import Sequence

import numpy as np
import shapely
from matplotlib.figure import Figure

from hydrostat.drawing import Color
from hydrostat.ik import MarkerWorkspace
from hydrostat.plot.labels import Labels, shorten
from hydrostat.plot.open_sheet import open_sheet
from hydrostat.plot.sheet import WIDTH, PictureSheet, Places
from hydrostat.plot.targets import draw_markers, rest_markers
from hydrostat.robot import Robot


def draw_workspace(
    robot: Robot, reaches: Sequence[MarkerWorkspace], *, title: str | None = None, width: float = WIDTH
) -> Figure:
    """The rest shape with what each marker reaches in a color of its own: a field where it is flat, else places.

    The title is the robot's name if left out, nothing if empty; width in inches.
    """
    nodes, flat = robot.body.mesh.nodes, robot.body.mesh.dim == 2
    points = [part.cells.reshape(-1, 2) if flat else part.places for part in reaches]
    head = shorten(robot.name) if title is None else title
    sheet, panes = open_sheet(robot, [nodes], points, title=head, subtitle="all that markers reach", width=width)
    for index, part in enumerate(reaches):
        color = Color.WINCHES[index % len(Color.WINCHES)]
        for pane in panes:
            if index == 0:
                pane.draw_body(sheet, nodes, pins=True, pale=0.35)
            if flat:
                _draw_fields(sheet, [pane.places(cell) for cell in part.cells], color)
            elif len(part.places):
                sheet.dots(pane.places(part.places), 2.6, color=color, zorder=12)
    rest = rest_markers(robot)
    for pane in panes:
        draw_markers(sheet, pane.locate_points(rest))
    labels = Labels(sheet, rings=panes[0].outline(sheet, nodes), avoid=np.empty((0, 2)))
    for name, place in panes[0].locate_points(rest).items():
        labels.place(place, shorten(name))
    return sheet.figure


def _draw_fields(sheet: PictureSheet, cells: Sequence[Places], color: str) -> None:
    """Draw the union of convex cells [mm]; a line where a marker only moves to and fro."""
    hulls = [shapely.buffer(shapely.convex_hull(shapely.MultiPoint(cell)), 0.6 * sheet.scale) for cell in cells]
    for field in shapely.get_parts(shapely.union_all(hulls)):
        rings = [field.exterior, *field.interiors]
        sheet.area([np.array(ring.coords) for ring in rings], facecolor=color, alpha=0.45, linewidth=0.0, zorder=12)
