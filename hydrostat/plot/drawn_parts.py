"""Rods, loads and near obstacles of a robot on a picture, and the names of its parts."""

from collections.abc import Mapping

import numpy as np
from matplotlib.patches import FancyArrowPatch

from hydrostat.arrays import Nodes
from hydrostat.drawing import Color
from hydrostat.geometry import locate
from hydrostat.plot.labels import HALO, Labels, shorten
from hydrostat.plot.pane import Pane
from hydrostat.plot.sheet import PictureSheet, Place, Spread
from hydrostat.robot import Load, Obstacle, ObstacleShape, Robot, rims


def name_parts(labels: Labels, pane: Pane, robot: Robot, nodes: Nodes) -> None:
    """Write the name and kind next to each part, rod, sheet and obstacle of a body with its nodes at `nodes` [m]."""
    body, places = robot.body, dict[str, np.ndarray]()
    for index, part in enumerate(body.parts, start=1):
        kind = "rigid" if part.material is None else part.material.name or "soft"
        own = body.mesh.elements[body.element_materials == index]
        if not part.winch and len(own):
            places[f"{shorten(part.name)}: {kind}"] = nodes[np.unique(own)].mean(axis=0)
    for rod in robot.rods:
        middle = 0.5 * np.sum(rod.points[(len(rod.points) - 1) // 2 :][:2], axis=0)
        places[f"{shorten(rod.name)}: rod"] = locate(body.mesh, middle[None]).positions(nodes)[0]
    for cover in robot.sheets:
        own = np.unique(np.concatenate([facets.ravel() for facets in cover.find_facets(body.mesh)]))
        places[f"{shorten(cover.name)}: sheet"] = nodes[own].mean(axis=0)
    for obstacle in _near_obstacles(robot):
        places[shorten(obstacle.name)] = obstacle.frame()[0]
    for words, place in list(places.items())[:_MAX_NAMES]:
        labels.place(pane.places(place[None])[0], words, size=7, outside=0.0, color=Color.INK)


_MAX_NAMES = 8  # names of parts in a picture, which more would cover


def obstacle_reach(robot: Robot) -> Spread:
    """Points of obstacles near the body, which a picture must hold [m], (points, dim); far ones may be cut."""
    lines = [line for obstacle in _near_obstacles(robot) for line in rims(obstacle, robot)]
    return np.concatenate([robot.body.mesh.nodes[:0], *lines])


def _near_obstacles(robot: Robot) -> list[Obstacle]:
    nodes, reach = robot.body.mesh.nodes, _OBSTACLE_DISTANCE * robot.body.mesh.size
    low, high = nodes.min(axis=0) - reach, nodes.max(axis=0) + reach
    ended = [one for one in robot.obstacles if one.shape is not ObstacleShape.PLANE]
    points = [np.concatenate(rims(one, robot)) for one in ended]
    return [one for one, each in zip(ended, points, strict=True) if (each >= low).all() and (each <= high).all()]


_OBSTACLE_DISTANCE = 0.5  # share of the body's size within which an obstacle is shown whole


def draw_rods(sheet: PictureSheet, pane: Pane, robot: Robot, nodes: Nodes) -> None:
    """A line along each rod of a body with its nodes at `nodes` [m]."""
    for rod in robot.rods:
        corners = np.array(rod.points)
        shares = np.linspace(0, len(corners) - 1, 100 * (len(corners) - 1) + 1)
        line = np.stack([np.interp(shares, np.arange(len(corners)), column) for column in corners.T], axis=1)
        places = pane.places(locate(robot.body.mesh, line).positions(nodes))
        for color, width, order in ((Color.LIGHT, 3.4, 8), (Color.MUTED, 2.0, 8.1)):
            sheet.curve(places, color=color, linewidth=width, zorder=order)


def load_reach(robot: Robot, nodes: Nodes) -> Spread:
    """Points behind the arrows of loads, which a picture must hold [m], (loads, dim)."""
    if not robot.loads:
        return nodes[:0]
    forces = robot.load_forces()
    sizes = np.linalg.norm(forces, axis=1, keepdims=True)
    along = forces / np.maximum(sizes, 1e-300)
    reach = 0.15  # share of the body's size that an arrow and its label take
    return locate(robot.body.mesh, robot.load_points()).positions(nodes) + reach * robot.body.mesh.size * along


def draw_loads(sheet: PictureSheet, pane: Pane, robot: Robot, nodes: Nodes) -> dict[str, tuple[Place, Place]]:
    """Draw an arrow along the force of each load on a body with its nodes at `nodes` [m]; return its ends by name."""
    drawn: dict[str, tuple[Place, Place]] = {}
    if not robot.loads:
        return drawn
    places, forces = locate(robot.body.mesh, robot.load_points()).positions(nodes), robot.load_forces()
    largest = max(float(np.linalg.norm(forces, axis=1).max()), 1e-300)
    for load, at, force in zip(robot.loads, places, forces, strict=True):
        if load.pressure is not None:
            _draw_pressure(sheet, pane, robot, nodes, load)
        if load.moment is not None:
            drawn[load.name] = _draw_moment(sheet, pane.places(at[None])[0], load)
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
        drawn[load.name] = (start, end)
    return drawn


def _draw_pressure(sheet: PictureSheet, pane: Pane, robot: Robot, nodes: Nodes, load: Load) -> None:
    """Write a pressure in the middle of its cavity."""
    facets = robot.body.mesh.cavity(np.array(load.at))
    x, y = pane.places(nodes[np.unique(facets)].mean(axis=0)[None])[0]
    words = f"{1e-3 * (load.pressure or 0.0):.3g} kPa"
    style = {"fontsize": 7, "color": Color.ERROR, "weight": "bold", "ha": "center", "va": "center", "gid": HALO}
    sheet.text((float(x), float(y)), words, zorder=30, **style)


def _draw_moment(sheet: PictureSheet, at: Place, load: Load) -> tuple[Place, Place]:
    """Draw an arrow around a place, counterclockwise if the moment turns from x to y; return the place and its top."""
    ahead, reach = (load.moment or (0.0,))[-1] >= 0, 14 * sheet.scale
    angles = np.radians(np.linspace(-140, 110, 41) * (1 if ahead else -1) + (0 if ahead else 180))
    line = np.array(at) + reach * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    sheet.curve(line[:-3], color=Color.ERROR, linewidth=1.8, zorder=17.5)
    arrow = FancyArrowPatch(
        tuple(line[-5]), tuple(line[-1]), arrowstyle="-|>,head_length=5,head_width=2.5", shrinkA=0, shrinkB=0,
        color=Color.ERROR, linewidth=0.5, zorder=17.5, clip_on=False,
    )  # fmt: skip
    sheet.axes.add_patch(arrow)
    return at, np.array(at) + 0.7 * reach


def name_loads(labels: Labels, robot: Robot, arrows: Mapping[str, tuple[Place, Place]]) -> None:
    """Write the size of each force and moment next to its arrow."""
    forces = zip(robot.loads, np.linalg.norm(robot.load_forces(), axis=1), strict=True)
    sizes = {
        load.name: f"{force:.3g} N" if load.moment is None else f"{np.linalg.norm(load.moment):.3g} N m"
        for load, force in forces
    }
    for name, (_, end) in arrows.items():
        labels.place(end, sizes[name], size=7, weight="bold", outside=0.1, color=Color.ERROR)
