"""Pictures of a robot in a pose that its winches make."""

import numpy as np
from matplotlib.figure import Figure

from hydrostat.arrays import Nodes
from hydrostat.ik import ReachedPose
from hydrostat.plot.felt import draw_felt, draw_ghost
from hydrostat.plot.hardware import cable_dots, cable_runs, draw_cables, draw_numbers, draw_winches, name_winches
from hydrostat.plot.labels import Labels, shorten
from hydrostat.plot.places import Places
from hydrostat.plot.sheet import MILLIMETRES, WIDTH, Sheet, new_sheet
from hydrostat.plot.skin import Skin
from hydrostat.plot.targets import draw_crosses, draw_errors, draw_markers, target_points
from hydrostat.plot.tension_scale import TensionScale
from hydrostat.robot import Robot
from hydrostat.simulation import SolvedPose


def draw_pose(robot: Robot, pose: SolvedPose, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """A simulated pose over the ghost of the rest shape; cables coloured by tension, winches with their contraction.

    Args:
        robot: to draw.
        pose: its equilibrium.
        title: above the picture; the robot's name if left out, nothing if empty.
        width: of the picture [inch].

    Raises:
        InputError: a body in space.
    """
    head = shorten(robot.name) if title is None else title
    note = f"under the given contractions: {pose.result.reason}"
    sheet, labels = _in_pose(robot, pose, head, note, width, targets=np.empty((0, 2)))
    draw_markers(sheet, pose.markers)
    for name, place in pose.markers.items():
        labels.place(MILLIMETRES * place, shorten(name))
    return sheet.figure


def draw_reached(robot: Robot, reached: ReachedPose, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """What the winches reach of a pose: targets as crosses, each marker's error as a red line with its millimetres.

    Args:
        robot: to draw.
        reached: the pose found.
        title: above the picture; the pose's name if left out, nothing if empty.
        width: of the picture [inch].

    Raises:
        InputError: a body in space.
    """
    head = f"Reached: {shorten(reached.target.name)}" if title is None else title
    note = f"marker error {MILLIMETRES * reached.rms_error:.2f} mm rms"
    sheet, labels = _in_pose(robot, reached.pose, head, note, width, targets=target_points(reached.target))
    markers = {name: reached.pose.markers[name] for name in reached.target.targets}
    draw_errors(sheet, markers, reached.target)
    draw_crosses(sheet, reached.target)
    draw_markers(sheet, markers)
    for name, place in markers.items():
        labels.place(MILLIMETRES * place, f"{shorten(name)}\N{EN SPACE}{MILLIMETRES * reached.errors[name]:.1f} mm")
    return sheet.figure


def draw_portrait(robot: Robot, nodes: Nodes, *, frame: Places | None = None, width: float = WIDTH) -> Figure:
    """The robot alone, without grid or words, when its nodes are at `nodes` [m].

    Args:
        robot: to draw.
        nodes: positions of the nodes [m].
        frame: points that the picture must hold [m], so that several share one frame; the body if left out.
        width: of the picture [inch].

    Raises:
        InputError: a body in space.
    """
    skin = Skin.of(robot.body)
    points = MILLIMETRES * (skin.shape(nodes)[0] if frame is None else frame)
    sheet = new_sheet(points, width=width, ruled=False, room=0.04)
    draw_felt(sheet, skin, nodes)
    draw_cables(sheet, robot, cable_runs(robot, nodes))
    draw_winches(sheet, robot, nodes)
    return sheet.figure


def _in_pose(
    robot: Robot, pose: SolvedPose, title: str, subtitle: str, width: float, *, targets: Places
) -> tuple[Sheet, Labels]:
    """A sheet with ghost, posed felt, cables by tension and winches, and room for labels off the targets [mm]."""
    skin = Skin.of(robot.body)
    rings = [MILLIMETRES * ring for ring in skin.shape(pose.nodes)]
    ghost = MILLIMETRES * skin.shape(robot.body.mesh.nodes)[0]
    runs = cable_runs(robot, pose.nodes)
    seen = np.concatenate([rings[0], ghost, *runs, targets])
    sheet = new_sheet(seen, title=title, subtitle=subtitle, width=width, bar=bool(runs))
    draw_ghost(sheet, skin, robot.body.mesh.nodes)
    draw_felt(sheet, skin, pose.nodes, pale=0.35)
    markers = MILLIMETRES * np.array(list(pose.markers.values())).reshape(-1, 2)
    labels = Labels(sheet, rings=rings, avoid=np.concatenate([cable_dots(sheet, runs), markers, targets]))
    for place in (*markers, *targets):
        labels.reserve(place, 6)
    draw_winches(sheet, robot, pose.nodes)
    if runs:
        _draw_tensions(sheet, robot, pose, runs, labels)
    return sheet, labels


def _draw_tensions(sheet: Sheet, robot: Robot, pose: SolvedPose, runs: list[Places], labels: Labels) -> None:
    """Cables coloured by tension, each with its number and its newtons."""
    scale = TensionScale.of(pose.tensions)
    colours = [scale.colour(float(tension)) for tension in pose.tensions]
    draw_cables(sheet, robot, runs, colours=colours, width=2.6)
    scale.draw_bar(sheet, of="cable tension")
    beads = draw_numbers(sheet, runs, colours, labels)
    name_winches(labels, robot, pose.nodes, [_note(contraction) for contraction in pose.contractions])
    for bead, tension in zip(beads, pose.tensions, strict=True):
        labels.place(bead, f"{tension:.1f} N" if tension > 0 else "slack", size=6.5, weight="bold", outside=0.1)


def _note(contraction: float) -> str:
    """A contraction [m] in millimetres, with its sign."""
    number = f"{MILLIMETRES * contraction:+.1f}".replace("-", "\N{MINUS SIGN}")
    return "0 mm" if number[1:] == "0.0" else f"{number} mm"
