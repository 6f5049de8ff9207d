"""Pictures of a robot at rest: its parts, its targets, its network."""

import numpy as np
from matplotlib.figure import Figure

from hydrostat.plot.felt import draw_felt, draw_mesh, draw_pins
from hydrostat.plot.hardware import cable_dots, cable_runs, draw_cables, draw_numbers, draw_winches, name_winches
from hydrostat.plot.labels import Labels, shorten
from hydrostat.plot.palette import winch_colours
from hydrostat.plot.places import Places
from hydrostat.plot.sheet import MILLIMETRES, WIDTH, Sheet, new_sheet
from hydrostat.plot.skin import Skin
from hydrostat.plot.targets import draw_arrows, draw_crosses, draw_markers, rest_markers, target_points
from hydrostat.robot import Pose, Robot
from hydrostat.units import counted


def draw_rest(robot: Robot, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """The robot as it is made: mesh, pins, winches, cables and markers, on a millimetre grid.

    Args:
        robot: to draw.
        title: above the picture; the robot's name if left out, nothing if empty.
        width: of the picture [inch].

    Raises:
        InputError: a body in space.
    """
    body = robot.body
    count = f"{len(body.mesh.nodes)} nodes, {len(body.mesh.elements)} elements"
    sheet, rings, runs = _at_rest(robot, shorten(robot.name) if title is None else title, count, width, mesh=True)
    draw_cables(sheet, robot, runs)
    draw_winches(sheet, robot, body.mesh.nodes)
    draw_markers(sheet, rest_markers(robot))
    labels = _labels(sheet, robot, rings, runs)
    name_winches(labels, robot, body.mesh.nodes)
    for marker in robot.markers:
        labels.place(MILLIMETRES * np.array(marker.at), shorten(marker.name))
    return sheet.figure


def draw_target(robot: Robot, pose: Pose, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """The rest shape with an arrow from each marker to its target.

    Args:
        robot: to draw.
        pose: the targets.
        title: above the picture; the pose's name if left out, nothing if empty.
        width: of the picture [inch].

    Raises:
        InputError: a body in space.
    """
    head = f"Target: {shorten(pose.name)}" if title is None else title
    sheet, rings, _ = _at_rest(robot, head, "how far each marker has to go", width, also=target_points(pose))
    markers = {name: place for name, place in rest_markers(robot).items() if name in pose.targets}
    draw_arrows(sheet, markers, pose)
    draw_crosses(sheet, pose)
    draw_markers(sheet, markers)
    ways = [np.linspace(markers[name], np.array(target), 9) for name, target in pose.targets.items()]
    labels = Labels(sheet, rings=rings, avoid=MILLIMETRES * np.concatenate(ways))
    for name, target in pose.targets.items():
        way = float(MILLIMETRES * np.linalg.norm(markers[name] - np.array(target)))
        words = f"{way:.0f} mm" if way >= 0.5 else "stays"
        labels.place(MILLIMETRES * np.array(target), f"{shorten(name)}\N{EN SPACE}{words}")
    return sheet.figure


def draw_network(robot: Robot, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """Where the winches sit and where the cables run, numbered as in the tables.

    Args:
        robot: to draw.
        title: above the picture; a count of winches and cables if left out, nothing if empty.
        width: of the picture [inch].

    Raises:
        InputError: a body in space.
    """
    count = f"{counted(len(robot.winches), 'winch')}, {counted(len(robot.cables), 'cable')}"
    head = shorten(robot.name) if title is None else title
    sheet, rings, runs = _at_rest(robot, head, count, width)
    colours = winch_colours(robot)
    draw_cables(sheet, robot, runs, width=2.4)
    draw_winches(sheet, robot, robot.body.mesh.nodes)
    labels = _labels(sheet, robot, rings, runs)
    draw_numbers(sheet, runs, [colours[cable.winch] for cable in robot.cables], labels)
    name_winches(labels, robot, robot.body.mesh.nodes)
    draw_markers(sheet, rest_markers(robot), size=4.0)
    return sheet.figure


def _at_rest(
    robot: Robot, title: str, subtitle: str, width: float, *, mesh: bool = False, also: Places | None = None
) -> tuple[Sheet, list[Places], list[Places]]:
    """A sheet with the felt body and its pins, the body's rings and the runs of its cables [mm]."""
    skin, nodes = Skin.of(robot.body), robot.body.mesh.nodes
    rings = [MILLIMETRES * ring for ring in skin.shape(nodes)]
    runs = cable_runs(robot, nodes)
    extra = [] if also is None else [also]
    winches = [MILLIMETRES * np.array([winch.at]) for winch in robot.winches]
    sheet = new_sheet(np.concatenate([rings[0], *runs, *winches, *extra]), title=title, subtitle=subtitle, width=width)
    draw_felt(sheet, skin, nodes)
    if mesh:
        draw_mesh(sheet, robot, nodes)
    draw_pins(sheet, robot, rings)
    return sheet, rings, runs


def _labels(sheet: Sheet, robot: Robot, rings: list[Places], runs: list[Places]) -> Labels:
    """Labels that keep off cables and markers."""
    markers = MILLIMETRES * np.array([marker.at for marker in robot.markers]).reshape(-1, 2)
    labels = Labels(sheet, rings=rings, avoid=np.concatenate([markers, cable_dots(sheet, runs)]))
    for marker in markers:
        labels.reserve(marker, 6)
    return labels
