"""Pictures of a robot at rest: its parts, its targets, its network, several networks of one body."""

from collections.abc import Iterable

import numpy as np
from matplotlib.figure import Figure

from hydrostat.drawing.palette import winch_colours
from hydrostat.plot.attachments import Attachments
from hydrostat.plot.drawn_body import DrawnBody
from hydrostat.plot.hardware import DrawnRobot, draw_hardware, draw_numbers, name_winches
from hydrostat.plot.labels import Labels, shorten
from hydrostat.plot.open_sheet import open_sheet
from hydrostat.plot.pane import Pane
from hydrostat.plot.sheet import MILLIMETRES, WIDTH, PictureSheet, Spread
from hydrostat.plot.skin import outer_points
from hydrostat.plot.targets import draw_arrows, draw_crosses, draw_markers, rest_markers, target_places, target_points
from hydrostat.robot import Pose, Robot
from hydrostat.units import counted


def draw_rest(robot: Robot, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """The robot as it is made: mesh, pins, winches, cables and markers, on a millimetre grid.

    The title is the robot's name if left out, nothing if empty; width in inches.
    """
    body = robot.body
    count = f"{len(body.mesh.nodes)} nodes, {len(body.mesh.elements)} elements"
    head = shorten(robot.name) if title is None else title
    sheet, panes, bodies = _at_rest(robot, head, count, width, mesh=True)
    drawn, labels = _draw_parts(sheet, robot, panes, bodies)
    name_winches(labels, robot, drawn.winches)
    for name, place in drawn.pane.named(rest_markers(robot)).items():
        labels.place(place, shorten(name))
    return sheet.figure


def draw_target(robot: Robot, pose: Pose, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """The rest shape with an arrow from each marker to its target.

    The title is the pose's name if left out, nothing if empty; width in inches.
    """
    head = f"Target: {shorten(pose.name)}" if title is None else title
    sheet, panes, bodies = _at_rest(robot, head, "how far each marker has to go", width, also=target_points(pose))
    goals = target_places(pose)
    tracked = {name: place for name, place in rest_markers(robot).items() if name in goals}
    for pane in panes:
        markers, targets = pane.named(tracked), pane.named(goals)
        draw_arrows(sheet, markers, targets)
        draw_crosses(sheet, targets)
        draw_markers(sheet, markers)
    markers, targets = panes[0].named(tracked), panes[0].named(goals)
    ways = [np.linspace(markers[name], target, 9) for name, target in targets.items()]
    labels = Labels(sheet, rings=bodies[0].rings, avoid=np.concatenate(ways))
    for name, target in targets.items():
        way = float(MILLIMETRES * np.linalg.norm(tracked[name] - goals[name]))
        words = f"{way:.0f} mm" if way >= 0.5 else "stays"
        labels.place(target, f"{shorten(name)}\N{EN SPACE}{words}")
    return sheet.figure


def draw_network(robot: Robot, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """Draw the winches where they sit and the cables where they run, numbered as in the tables.

    The title counts winches and cables if left out, nothing if empty; width in inches.
    """
    count = f"{counted(len(robot.winches), 'winch')}, {counted(len(robot.cables), 'cable')}"
    head = shorten(robot.name) if title is None else title
    sheet, panes, bodies = _at_rest(robot, head, count, width)
    drawn, labels = _draw_parts(sheet, robot, panes, bodies, width=2.4, size=4.0)
    colours = winch_colours(robot.winches)
    draw_numbers(sheet, drawn.runs, [colours[cable.winch] for cable in robot.cables], labels)
    name_winches(labels, robot, drawn.winches)
    return sheet.figure


def _at_rest(
    robot: Robot, title: str, subtitle: str, width: float, *, mesh: bool = False, also: Spread | None = None
) -> tuple[PictureSheet, list[Pane], list[DrawnBody]]:
    """A sheet with the body and its pins in each of its panes, and room for cables and winches."""
    nodes = robot.body.mesh.nodes
    extra = [] if also is None else [also]
    fixed = np.array([winch.at for winch in robot.winches], dtype=float).reshape(-1, nodes.shape[1])
    points = [*Attachments(robot).cables(nodes), fixed, *extra]
    sheet, panes = open_sheet(robot, [nodes], points, title=title, subtitle=subtitle, width=width)
    return sheet, panes, [pane.draw_body(sheet, nodes, mesh=mesh, pins=True) for pane in panes]


def _draw_parts(
    sheet: PictureSheet,
    robot: Robot,
    panes: list[Pane],
    bodies: list[DrawnBody],
    *,
    width: float = 2.0,
    size: float = 6.0,
) -> tuple[DrawnRobot, Labels]:
    """Cables of a width, winches and markers of a size [pt] at rest; what the first pane shows, and labels for it."""
    carried, rest, drawn = Attachments(robot), rest_markers(robot), []
    for pane, body in zip(panes, bodies, strict=True):
        drawn.append(draw_hardware(sheet, pane, body, carried, robot.body.mesh.nodes, width=width))
        draw_markers(sheet, pane.named(rest), size=size)
    return drawn[0], drawn[0].labels(sheet, np.array(list(panes[0].named(rest).values())).reshape(-1, 2))


SMALL = 2.7  # width of such a picture [inch]


def draw_stage(robot: Robot, *, like: Robot, frame: Spread, width: float = SMALL) -> Figure:
    """A network on the rest shape, each cable in the colour of its winch, without words.

    All are seen from the best side of the robot `like`, in a picture that holds the points of `stage_frame` [m].
    """
    nodes = robot.body.mesh.nodes
    sheet, (pane, *_) = open_sheet(like, [], [frame], width=width, ruled=False)
    draw_hardware(sheet, pane, pane.draw_body(sheet, nodes, pins=True), Attachments(robot), nodes, width=1.8)
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
