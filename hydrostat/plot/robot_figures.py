"""Pictures of a robot: at rest, with its network and loads, in poses, and targets reached."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from shapely import Polygon, maximum_inscribed_circle

from hydrostat.arrays import Float, Nodes, Vector
from hydrostat.drawing import Color
from hydrostat.geometry import Outline, Ring
from hydrostat.given import check_positive, check_type
from hydrostat.ik import IKResult, IKStatus
from hydrostat.plot.drawn_body import DrawnBody
from hydrostat.plot.drawn_parts import draw_loads, draw_rods, load_reach, name_loads, name_parts, obstacle_reach
from hydrostat.plot.frame import Attachments
from hydrostat.plot.hardware import DrawnRobot, draw_hardware, draw_numbers, name_winches
from hydrostat.plot.labels import Labels, shorten
from hydrostat.plot.open_sheet import open_sheet
from hydrostat.plot.pane import Pane
from hydrostat.plot.sheet import WIDTH, PictureSheet, Places, Spread, new_sheet
from hydrostat.plot.skin import outer_points
from hydrostat.plot.targets import (
    draw_arrows,
    draw_crosses,
    draw_markers,
    draw_misses,
    rest_markers,
    target_places,
    target_points,
)
from hydrostat.plot.tension_scale import TensionScale
from hydrostat.robot import Obstacle, PoseTarget, Robot
from hydrostat.simulation import Equilibrium, check_pose, obstacles_in_pose
from hydrostat.units import MILLIMETERS, plural


def draw_rest(robot: Robot, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """Draw the robot at rest: mesh, pins, winches, cables and markers, on a millimeter grid.

    The default title is the robot's name; an empty one omits it. Width in inches.
    """
    _check(robot, width)
    body = robot.body
    count = body.mesh.describe()
    head = shorten(robot.name) if title is None else title
    sheet, panes, bodies = _at_rest(robot, head, count, width, mesh=True)
    drawn, labels = _draw_parts(sheet, robot, panes, bodies)
    name_winches(labels, robot, drawn.winches)
    name_parts(labels, panes[0], robot, robot.body.mesh.nodes)
    for name, place in drawn.pane.locate_points(rest_markers(robot)).items():
        labels.place(place, shorten(name))
    return sheet.figure


def draw_target(robot: Robot, pose: PoseTarget, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """The rest shape with an arrow from each marker to its target.

    The title is the pose's name if left out, nothing if empty; width in inches.
    """
    head = f"Target: {shorten(pose.name)}" if title is None else title
    sheet, panes, bodies = _at_rest(robot, head, "how far each marker has to go", width, also=target_points(pose))
    goals = target_places(pose)
    tracked = {name: place for name, place in rest_markers(robot).items() if name in goals}
    for pane in panes:
        markers, targets = pane.locate_points(tracked), pane.locate_points(goals)
        draw_arrows(sheet, markers, targets)
        draw_crosses(sheet, targets)
        draw_markers(sheet, markers)
    markers, targets = panes[0].locate_points(tracked), panes[0].locate_points(goals)
    ways = [np.linspace(markers[name], target, 9) for name, target in targets.items()]
    labels = Labels(sheet, rings=bodies[0].rings, avoid=np.concatenate(ways))
    for name, target in targets.items():
        way = float(MILLIMETERS * np.linalg.norm(tracked[name] - goals[name]))
        words = f"{way:.0f} mm" if way >= 0.5 else "stays"
        labels.place(target, f"{shorten(name)}\N{EN SPACE}{words}")
    return sheet.figure


def draw_network(robot: Robot, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """Draw winches and cables at their positions, numbered as in the tables.

    The default title gives the numbers of winches and cables; an empty one omits it. Width in inches.
    """
    _check(robot, width)
    count = f"{plural(len(robot.winches), 'winch')}, {plural(len(robot.cables), 'cable')}"
    head = shorten(robot.name) if title is None else title
    sheet, panes, bodies = _at_rest(robot, head, count, width)
    drawn, labels = _draw_parts(sheet, robot, panes, bodies, width=2.4, size=4.0)
    colors = Color.of_winches(robot.winches)
    draw_numbers(sheet, drawn.runs, [colors[cable.winch] for cable in robot.cables], labels)
    name_winches(labels, robot, drawn.winches)
    name_parts(labels, panes[0], robot, robot.body.mesh.nodes)
    return sheet.figure


def _check(robot: Robot, width: float) -> None:
    """Refuse what cannot be drawn (InputError)."""
    check_type(robot, Robot, "a picture is drawn of a Robot, such as load_robot gives")
    check_positive("width", width, "inches")


def _at_rest(
    robot: Robot, title: str, subtitle: str, width: float, *, mesh: bool = False, also: Spread | None = None
) -> tuple[PictureSheet, list[Pane], list[DrawnBody]]:
    """A sheet with the body and its pins in each of its panes, and room for cables and winches."""
    nodes = robot.body.mesh.nodes
    extra = [] if also is None else [also]
    fixed = np.array([winch.at for winch in robot.winches], dtype=float).reshape(-1, nodes.shape[1])
    points = [*Attachments(robot).cables(nodes), fixed, load_reach(robot, nodes), obstacle_reach(robot), *extra]
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
    carried, rest, drawn, arrows = Attachments(robot), rest_markers(robot), [], []
    for pane, body in zip(panes, bodies, strict=True):
        drawn.append(draw_hardware(sheet, pane, body, carried, robot.body.mesh.nodes, width=width))
        draw_markers(sheet, pane.locate_points(rest), size=size)
        draw_rods(sheet, pane, robot, robot.body.mesh.nodes)
        arrows.append(draw_loads(sheet, pane, robot, robot.body.mesh.nodes))
    labels = drawn[0].labels(sheet, np.array(list(panes[0].locate_points(rest).values())).reshape(-1, 2))
    labels.avoid([np.linspace(start, end, 12) for start, end in arrows[0].values()])
    name_loads(labels, robot, arrows[0])
    return drawn[0], labels


SMALL_WIDTH = 2.7  # width of such a picture [inch]


def draw_stage(robot: Robot, *, like: Robot, frame: Spread) -> Figure:
    """A network on the rest shape, each cable in the color of its winch, without words.

    All are seen from the best side of the robot `like`, in a picture that holds the points of `stage_frame` [m].
    """
    nodes = robot.body.mesh.nodes
    sheet, (pane, *_) = open_sheet(like, [], [frame], width=SMALL_WIDTH, ruled=False)
    draw_hardware(sheet, pane, pane.draw_body(sheet, nodes, pins=True), Attachments(robot), nodes, width=1.8)
    draw_markers(sheet, pane.locate_points(rest_markers(robot)), size=3.4)
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


def draw_pose(
    robot: Robot, pose: Equilibrium, *, title: str | None = None, note: str | None = None, width: float = WIDTH
) -> Figure:
    """Draw a simulated pose over a ghost of the rest shape: cables colored by tension, winches with contraction.

    The default title is the robot's name; an empty one omits it. The default note below gives the state of equilibrium.
    Width in inches.
    """
    _check(robot, width)
    check_pose(pose, robot.body.mesh.nodes.shape, robot.num_controls, what="the pose")
    head = shorten(robot.name) if title is None else title
    line = _rests(pose) if note is None else note
    sheet, panes, labels = _in_pose(robot, pose, head, line, width, targets={})
    for pane in panes:
        draw_markers(sheet, pane.locate_points(pose.markers))
    for name, place in panes[0].locate_points(pose.markers).items():
        labels.place(place, shorten(name))
    return sheet.figure


def reached_title(reached: IKResult, name: str | None = None) -> str:
    """Title of an answer: "Reached: wave", or "Closest to wave" where a target is missed."""
    named = shorten(name or ("" if reached.target is None else reached.target.name))
    if reached.status is IKStatus.REACHED or (reached.errors and reached.is_close):
        return f"Reached: {named}" if named else "Reached"
    return f"Closest to {named}" if named else "Closest"


def draw_reached(
    robot: Robot,
    reached: IKResult,
    *,
    title: str | None = None,
    outline: Outline | None = None,
    width: float = WIDTH,
) -> Figure:
    """Draw the inverse-kinematics result of a pose: targets as crosses, marker errors as red lines labeled in mm.

    The default title is the pose's name; an empty one omits it. The outline is the target shape of a flat body, dashed.
    Width in inches.
    """
    _check(robot, width)
    check_type(reached, IKResult, "what is reached must be what solve_ik gives")
    check_pose(reached.pose, robot.body.mesh.nodes.shape, robot.num_controls, what="the pose")
    head = reached_title(reached) if title is None else title
    goals = {} if reached.target is None else target_places(reached.target)
    rings = [] if outline is None else list(outline.rings)
    note = _reached_note(reached, list(goals))
    sheet, panes, labels = _in_pose(robot, reached.pose, head, note, width, targets=goals, rings=rings)
    tracked = {name: reached.pose.markers[name] for name in goals}
    for ring in rings:
        _draw_wanted(sheet, MILLIMETERS * ring)
    draw_misses(sheet, panes, tracked, goals)
    for name, place in panes[0].locate_points(tracked).items():
        labels.place(place, f"{shorten(name)}\N{EN SPACE}{MILLIMETERS * reached.errors[name]:.1f} mm")
    return sheet.figure


def _reached_note(reached: IKResult, names: list[str]) -> str:
    """Errors of the markers together and of each other goal by its name, then the value of each drive."""
    markers = [reached.errors[name] for name in names]
    parts = [f"marker error {MILLIMETERS * float(np.sqrt(np.mean(np.square(markers)))):.2f} mm rms"] if markers else []
    others = {name: error for name, error in reached.errors.items() if name not in names}
    parts += [f"{shorten(name)} error {MILLIMETERS * error:.2f} mm" for name, error in others.items()]
    drives = zip(reached.pose.robot.drives, reached.pose.drives, strict=True)
    parts += [f"{shorten(drive.name)} {drive.format_value(value)}" for drive, value in drives]
    return ", ".join(parts) or reached.outcome


def _draw_wanted(sheet: PictureSheet, ring: Places) -> None:
    """A ring of the shape that is wanted [mm], dashed."""
    closed = np.concatenate([ring, ring[:1]])
    sheet.curve(closed, color=Color.LIGHT, linewidth=2.6, zorder=14)
    sheet.curve(closed, color=Color.ERROR, linewidth=1.2, linestyle=(0, (3.5, 2.0)), zorder=14.1)


def draw_portrait(
    robot: Robot,
    nodes: Nodes,
    *,
    frame: Spread | None = None,
    obstacles: Sequence[Obstacle] = (),
    width: float = WIDTH,
) -> Figure:
    """The robot alone, without grid or words, its nodes at `nodes` [m]; the picture holds all points of `frame` [m].

    Things are drawn with it, such as what it holds.
    """
    carried = Attachments(robot)
    beside = [*carried.cables(nodes), carried.winches(nodes)] if nodes.shape[1] == 3 else []
    shapes, points = ([nodes], beside) if frame is None else ([], [frame])
    sheet, panes = open_sheet(robot, shapes, points, width=width, ruled=False)
    draw_hardware(sheet, panes[0], panes[0].draw_body(sheet, nodes, obstacles=obstacles), carried, nodes)
    return sheet.figure


def _in_pose(
    robot: Robot,
    pose: Equilibrium,
    title: str,
    subtitle: str,
    width: float,
    *,
    targets: Mapping[str, Vector],
    rings: Sequence[Ring] = (),
) -> tuple[PictureSheet, list[Pane], Labels]:
    """A sheet with ghost, posed body, cables by tension and winches, room for rings and for labels off targets [m]."""
    robot = obstacles_in_pose(robot, pose.carried)
    rest, carried = robot.body.mesh.nodes, Attachments(robot)
    goals = np.array(list(targets.values())).reshape(-1, robot.body.mesh.dim)
    sheet, panes = open_sheet(
        robot,
        [pose.nodes, rest],
        [*carried.cables(pose.nodes), goals, *rings, load_reach(robot, pose.nodes), obstacle_reach(robot)],
        title=title,
        subtitle=subtitle,
        width=width,
        bar=bool(robot.cables),
    )
    scale = TensionScale.of(pose.tensions)
    colors = [scale.color(float(tension)) for tension in pose.tensions]
    drawn, arrows = [], []
    for pane in panes:
        pane.draw_ghost(sheet)
        body = pane.draw_body(sheet, pose.nodes, pale=0.35, pins=rest.shape[1] == 3)
        drawn.append(draw_hardware(sheet, pane, body, carried, pose.nodes, colors=colors, width=2.6))
        draw_rods(sheet, pane, robot, pose.nodes)
        arrows.append(draw_loads(sheet, pane, robot, pose.nodes))
    points = [*pose.markers.values(), *goals]
    labels = drawn[0].labels(sheet, panes[0].places(np.array(points)) if points else np.empty((0, 2)))
    labels.avoid([np.linspace(start, end, 12) for start, end in arrows[0].values()])
    name_loads(labels, robot, arrows[0])
    if robot.cables:
        scale.draw_bar(sheet, of="cable tension")
        beads = draw_numbers(sheet, drawn[0].runs, colors, labels)
        name_winches(labels, robot, drawn[0].winches, [_note(contraction) for contraction in pose.contractions])
        for bead, tension in zip(beads, pose.tensions, strict=True):
            words = f"{tension:.1f} N" if tension > 0 else "slack"
            labels.place(bead, words, size=6.5, weight="bold", outside=0.1)
    name_parts(labels, panes[0], robot, pose.nodes)
    return sheet, panes, labels


def _rests(pose: Equilibrium) -> str:
    """Equilibrium state of a pose, in words."""
    robot = pose.robot
    causes = [*(["contractions"] if robot.winches or not robot.loads else []), *(["loads"] if robot.loads else [])]
    under = f"under the given {' and '.join(causes)}"
    if not pose.result.converged:
        return f"not at rest {under}: {pose.result.status}"
    return f"at rest {under}" + ("" if pose.result.stable else ", on a saddle")


def _note(contraction: float) -> str:
    """A contraction [m] in millimeters, with its sign."""
    number = f"{MILLIMETERS * contraction:+.1f}".replace("-", "\N{MINUS SIGN}")
    return "0 mm" if number[1:] == "0.0" else f"{number} mm"


def draw_parts(parts: Mapping[int, Float[np.ndarray, "_ 2"]], *, title: str = "", width: float = WIDTH) -> Figure:
    """Draw closed shapes with their numbers, on a millimeter grid.

    Args:
        parts: corners of each shape by its number, (corners, 2) [m].
        title: title; none if empty.
        width: width of the figure [inch].
    """
    rings = {number: MILLIMETERS * np.asarray(ring) for number, ring in parts.items()}
    corners = np.concatenate(list(rings.values()))
    sheet = new_sheet(np.array([corners.min(axis=0), corners.max(axis=0)]), title=title, width=width)
    for number, ring in rings.items():
        sheet.area([ring], facecolor=Color.FELT_LIGHT, edgecolor=Color.SEAM, linewidth=1.0, zorder=5)
        x, y = maximum_inscribed_circle(Polygon(ring).buffer(0)).coords[0]
        sheet.text((x, y), str(number), ha="center", va="center", fontsize=18, color=Color.INK, zorder=8)
    return sheet.figure
