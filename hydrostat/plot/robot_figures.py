"""Pictures of a robot at rest: its parts, its targets, its network, several networks of one body."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from hydrostat.arrays import Vector
from hydrostat.drawing.palette import winch_colours
from hydrostat.plot.attachments import Attachments
from hydrostat.plot.drawn_body import DrawnBody, DrawnCable
from hydrostat.plot.hardware import (
    cable_dots,
    draw_cables,
    draw_numbers,
    draw_winches,
    name_winches,
)
from hydrostat.plot.labels import Labels, shorten
from hydrostat.plot.open_sheet import open_sheet
from hydrostat.plot.pane import Pane
from hydrostat.plot.sheet import MILLIMETRES, WIDTH, PictureSheet, Places, Spread
from hydrostat.plot.skin import outer_points
from hydrostat.plot.targets import draw_arrows, draw_crosses, draw_markers, rest_markers, target_places, target_points
from hydrostat.robot import Pose, Robot
from hydrostat.units import counted


def draw_rest(robot: Robot, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """The robot as it is made: mesh, pins, winches, cables and markers, on a millimetre grid.

    Args:
        robot: to draw.
        title: above the picture; the robot's name if left out, nothing if empty.
        width: of the picture [inch].
    """
    body = robot.body
    count = f"{len(body.mesh.nodes)} nodes, {len(body.mesh.elements)} elements"
    head = shorten(robot.name) if title is None else title
    sheet, views = _at_rest(robot, head, count, width, mesh=True, cables=True)
    for view in views:
        draw_cables(sheet, robot, view.runs)
        draw_winches(sheet, robot, view.winches, view.fades)
        draw_markers(sheet, view.pane.named(rest_markers(robot)))
    labels = _labels(sheet, robot, views[0])
    name_winches(labels, robot, views[0].winches)
    for name, place in views[0].pane.named(rest_markers(robot)).items():
        labels.place(place, shorten(name))
    return sheet.figure


def draw_target(robot: Robot, pose: Pose, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """The rest shape with an arrow from each marker to its target.

    Args:
        robot: to draw.
        pose: the targets.
        title: above the picture; the pose's name if left out, nothing if empty.
        width: of the picture [inch].
    """
    head = f"Target: {shorten(pose.name)}" if title is None else title
    sheet, views = _at_rest(robot, head, "how far each marker has to go", width, also=target_points(pose))
    goals = target_places(pose)
    tracked = {name: place for name, place in rest_markers(robot).items() if name in goals}
    for view in views:
        markers, targets = view.pane.named(tracked), view.pane.named(goals)
        draw_arrows(sheet, markers, targets)
        draw_crosses(sheet, targets)
        draw_markers(sheet, markers)
    markers, targets = views[0].pane.named(tracked), views[0].pane.named(goals)
    ways = [np.linspace(markers[name], target, 9) for name, target in targets.items()]
    labels = Labels(sheet, rings=views[0].surface.rings, avoid=np.concatenate(ways))
    for name, target in targets.items():
        way = float(MILLIMETRES * np.linalg.norm(tracked[name] - goals[name]))
        words = f"{way:.0f} mm" if way >= 0.5 else "stays"
        labels.place(target, f"{shorten(name)}\N{EN SPACE}{words}")
    return sheet.figure


def draw_network(robot: Robot, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """Draw the winches where they sit and the cables where they run, numbered as in the tables.

    Args:
        robot: to draw.
        title: above the picture; a count of winches and cables if left out, nothing if empty.
        width: of the picture [inch].
    """
    count = f"{counted(len(robot.winches), 'winch')}, {counted(len(robot.cables), 'cable')}"
    head = shorten(robot.name) if title is None else title
    sheet, views = _at_rest(robot, head, count, width, cables=True)
    colours = winch_colours(robot.winches)
    for view in views:
        draw_cables(sheet, robot, view.runs, width=2.4)
        draw_winches(sheet, robot, view.winches, view.fades)
        draw_markers(sheet, view.pane.named(rest_markers(robot)), size=4.0)
    labels = _labels(sheet, robot, views[0])
    places = [run.points for run in views[0].runs]
    draw_numbers(sheet, places, [colours[cable.winch] for cable in robot.cables], labels)
    name_winches(labels, robot, views[0].winches)
    return sheet.figure


@dataclass(frozen=True, eq=False)
class _View:
    """One pane with the body at rest: where its cables run, where its winches are [mm] and how far these fade."""

    pane: Pane
    surface: DrawnBody
    runs: list[DrawnCable]
    winches: Places
    fades: Vector


def _at_rest(
    robot: Robot,
    title: str,
    subtitle: str,
    width: float,
    *,
    mesh: bool = False,
    cables: bool = False,
    also: Spread | None = None,
) -> tuple[PictureSheet, list[_View]]:
    """A sheet with the body and its pins, and where `cables` run in each of its panes."""
    nodes = robot.body.mesh.nodes
    carried = Attachments(robot)
    lines, winches = carried.cables(nodes), carried.winches(nodes)
    extra = [] if also is None else [also]
    fixed = np.array([winch.at for winch in robot.winches], dtype=float).reshape(-1, nodes.shape[1])
    sheet, panes = open_sheet(robot, [nodes], [*lines, fixed, *extra], title=title, subtitle=subtitle, width=width)
    views = []
    for pane in panes:
        surface = pane.draw_body(sheet, nodes, mesh=mesh, pins=True)
        runs = [surface.run(points) for points in lines] if cables else []
        views.append(_View(pane, surface, runs, pane.places(winches), surface.fades(winches)))
    return sheet, views


def _labels(sheet: PictureSheet, robot: Robot, view: _View) -> Labels:
    """Labels that keep off cables and markers."""
    markers = np.array(list(view.pane.named(rest_markers(robot)).values())).reshape(-1, 2)
    dots = cable_dots(sheet, [run.points for run in view.runs])
    labels = Labels(sheet, rings=view.surface.rings, avoid=np.concatenate([markers, dots]))
    for marker in markers:
        labels.reserve(marker, 6)
    return labels


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
    nodes, carried = robot.body.mesh.nodes, Attachments(robot)
    sheet, (pane, *_) = open_sheet(like, [], [frame], width=width, ruled=False)
    surface = pane.draw_body(sheet, nodes, pins=True)
    draw_cables(sheet, robot, [surface.run(points) for points in carried.cables(nodes)], width=1.8)
    winches = carried.winches(nodes)
    draw_winches(sheet, robot, pane.places(winches), surface.fades(winches))
    draw_markers(sheet, pane.named(rest_markers(robot)), size=3.4)
    return sheet.figure


def stage_frame(robots: Iterable[Robot]) -> Spread:
    """Points that hold the rest shape and all networks of robots of one body [m]."""
    robots = list(robots)
    body = robots[0].body
    points = [point for robot in robots for cable in robot.cables for point in cable.points]
    points += [winch.at for robot in robots for winch in robot.winches]
    return np.concatenate(
        [*outer_points(body, [body.mesh.nodes]), np.array(points, dtype=float).reshape(-1, body.mesh.dim)]
    )
