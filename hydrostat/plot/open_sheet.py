"""`open_sheet`: an empty sheet with a pane for each view of a robot, a compass and rules."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.drawing import Camera, Color
from hydrostat.plot.pane import FlatPane, Pane, SpacePane
from hydrostat.plot.sheet import TALLEST, WIDTH, PictureSheet, Place, Spread, new_sheet, round_step
from hydrostat.plot.skin import FlatSkin
from hydrostat.robot import ObstacleShape, Robot
from hydrostat.units import MILLIMETERS


def open_sheet(
    robot: Robot,
    shapes: Sequence[Spread],
    points: Sequence[Spread] = (),
    *,
    title: str = "",
    subtitle: str = "",
    width: float = WIDTH,
    bar: bool = False,
    ruled: bool = True,
) -> tuple[PictureSheet, list[Pane]]:
    """A sheet that shows a robot, and its panes.

    A flat body has one pane; a body in space has a three-quarter view and, beside or below it, a view along the axis
    that shows most. All shapes and points [m] are seen. The subtitle is left out with the title; the bar is room for
    one of colors; without millimeters (`ruled`) one pane is all there is; width in inches.
    """
    if robot.body.mesh.dim == 2:
        skin = FlatSkin.of(robot.body)
        seen = [*(skin.shape(nodes)[0] for nodes in shapes), *points]
        room = 0.09 if ruled else 0.04
        places = MILLIMETERS * np.concatenate(seen)
        sheet = new_sheet(places, title=title, subtitle=subtitle, width=width, bar=bar, ruled=ruled, room=room)
        return sheet, [FlatPane(robot, skin)]
    cameras = _cameras(robot, shapes)[: 2 if ruled else 1]
    skins = [nodes[robot.body.mesh.boundary_nodes] for nodes in shapes]
    seen = np.concatenate([*skins, *points])
    views = [camera.see(MILLIMETERS * seen)[:, :2] for camera in cameras]
    layout = _lay_out([np.ptp(view, axis=0) for view in views], 72 * (width - 0.1))
    corners = np.array([np.zeros(2), layout.whole])
    sheet = new_sheet(corners, title=title, subtitle=subtitle, width=width, bar=bar, ruled=False, room=0.0)
    shifts = [low - view.min(axis=0) for low, view in zip(layout.lows, views, strict=True)]
    if len(cameras) > 1:
        side = layout.lows[1], layout.lows[1] + np.ptp(views[1], axis=0)
        draw_rules(sheet, cameras[1], *side, views[1].min(axis=0))
        draw_compass(sheet, cameras[0], layout.corner)
        kept = [(layout.corner, layout.corner + SIDES * sheet.scale), side]
        boxes = tuple((*map(float, low), *map(float, high)) for low, high in kept)
        inset = 4 * sheet.scale
        sheet = replace(sheet, low=sheet.low + inset, high=sheet.high - inset, kept=boxes)
    return sheet, [SpacePane(robot, camera, shift) for camera, shift in zip(cameras, shifts, strict=True)]


def _cameras(robot: Robot, shapes: Sequence[Spread]) -> list[Camera]:
    mesh = robot.body.mesh
    outer = mesh.boundary_nodes
    shown = [point for cable in robot.cables for point in cable.points]
    shown = np.array([*shown, *(part.at for part in (*robot.winches, *robot.markers))], dtype=float).reshape(-1, 3)
    corners = np.concatenate([mesh.nodes[outer], *(nodes[outer] for nodes in shapes)])
    ways = corners - np.tile(mesh.nodes[outer], (1 + len(shapes), 1))
    up = way_up(robot)
    return [
        Camera.three_quarter(mesh.nodes[outer], shown, up, _pose_offsets(robot)),
        Camera.along_an_axis(corners, shown, ways, up),
    ]


def _pose_offsets(robot: Robot) -> Spread:
    """Displacements of markers to their targets in the poses of a robot [m], or offsets of obstacles next to it."""
    nodes = robot.body.mesh.nodes
    beside = [obstacle.frame()[0] for obstacle in robot.obstacles if obstacle.shape is not ObstacleShape.PLANE]
    if beside:
        return np.array(beside) - 0.5 * (nodes.min(axis=0) + nodes.max(axis=0))
    rest = {marker.name: np.array(marker.at) for marker in robot.markers}
    asked = [np.array(target) - rest[name] for pose in robot.poses.values() for name, target in pose.targets.items()]
    return np.array(asked, dtype=float).reshape(-1, 3)


def way_up(robot: Robot) -> Vector:
    """Upward unit vector for a robot in space: against gravity; z where there is none."""
    if robot.gravity is None or not any(robot.gravity):
        return np.array([0.0, 0.0, 1.0])
    return -np.array(robot.gravity) / np.linalg.norm(robot.gravity)


@dataclass(frozen=True, eq=False)
class _ViewLayout:
    """Places of views on a sheet."""

    whole: Place  # size of the sheet [mm]
    lows: list[Place]  # lower left corner of each view [mm]
    corner: Place  # lower left corner of what belongs to the first view, its border too [mm]


def _lay_out(sides: Sequence[Place], paper: float) -> _ViewLayout:
    """Views of these sizes [mm] on paper of a width [pt], all to one scale.

    Side by side or one below the other, whichever shows the body larger; side by side if that makes little difference.
    """
    # free border around a view that stands alone [pt]: half a winch on its plate, that stands at the edge
    bare = 12.0
    if len(sides) == 1:
        scale = max(sides[0][0] / (paper - 2 * bare), sides[0][1] / (TALLEST * paper - 2 * bare))
        whole = np.array([paper * scale, sides[0][1] + 2 * bare * scale])
        return _ViewLayout(whole, [(whole - sides[0]) / 2], np.zeros(2))
    # left, right, lower, upper border of the three-quarter view [pt]: words; compass below
    room = (34.0, 34.0, 40.0, 20.0)
    rules = (28.0, 12.0, 20.0, 14.0)  # that of the view along an axis [pt]: there are numbers
    borders = [_around(room), _around(rules)]
    scales = []
    for beside in (True, False):
        need, free = _joint_size(sides[0], sides[1], beside), _joint_size(borders[0], borders[1], beside)
        scales.append(max(need[0] / (paper - free[0]), need[1] / (TALLEST * paper - free[1])))
    beside = bool(scales[0] <= 1.4 * scales[1])
    scale = scales[0] if beside else scales[1]
    first, second = (side + border * scale for side, border in zip(sides, borders, strict=True))
    whole = _joint_size(first, second, beside)
    spare = max(paper * scale - whole[0], 0.0)
    whole[0] += spare
    if beside:
        first[0] += spare / 2
        boxes = [np.zeros(2), np.array([first[0], (whole[1] - second[1]) / 2])]
        first[1] = whole[1]
    else:
        first[0] = whole[0]
        boxes = [np.array([0.0, second[1]]), np.array([(whole[0] - second[0]) / 2, 0.0])]
    lows = []
    for box, border, whole_side, side in zip(boxes, (room, rules), (first, second), sides, strict=True):
        free = whole_side - side - _around(border) * scale
        lows.append(box + np.array([border[0], border[2]]) * scale + free / 2)
    return _ViewLayout(whole, lows, boxes[0])


def _around(border: tuple[float, float, float, float]) -> Place:
    """Size that a border of left, right, lower and upper width adds to a box."""
    return np.array([border[0] + border[1], border[2] + border[3]])


def _joint_size(first: Place, second: Place, beside: bool) -> Place:
    """Size of two boxes beside each other, or one below the other."""
    along = 0 if beside else 1
    size = np.maximum(first, second)
    size[along] = first[along] + second[along]
    return size


SIDES = np.array([112.0, 38.0])  # room that compass and bar take [pt]


def draw_compass(sheet: PictureSheet, camera: Camera, low: Place) -> None:
    """x, y and z as arrows, and beside them a bar of round length; `low` is the lower left corner of both [mm]."""
    point = sheet.scale
    arm = 15.0  # length of an axis of the compass [pt]
    ways = camera.axes[:2].T * arm * point
    middle = low + np.array([9.0, 9.0]) * point - np.minimum(ways.min(axis=0), 0.0)
    for way, name in zip(ways, "xyz", strict=True):
        if np.linalg.norm(way) > 3 * point:
            end = middle + way
            sheet.curve(np.array([middle, end]), color=Color.MUTED, linewidth=1.0, zorder=12)
            letter = end + way / np.linalg.norm(way) * 5 * point
            sheet.text((letter[0], letter[1]), name, fontsize=7, color=Color.MUTED, ha="center", va="center", zorder=12)
    length = round_step(4 * 55 * point)
    left = low + np.array([24.0 + 2 * arm, 8.0]) * point
    bar = np.array([left, left + np.array([length, 0.0])])
    sheet.curve(bar, color=Color.INK, linewidth=1.6, solid_capstyle="butt", zorder=12)
    words = left + np.array([length / 2, 4 * point])
    sheet.text((words[0], words[1]), f"{length:g} mm", fontsize=7, color=Color.INK, ha="center", va="bottom", zorder=12)


def draw_rules(sheet: PictureSheet, camera: Camera, low: Place, high: Place, origin: Place) -> None:
    """Grid lines at round millimeters behind a view along an axis, numbered on its left and lower side.

    The view goes from the corner `low` to the corner `high` of the sheet [mm]; the camera sees the origin at the first
    [mm].
    """
    step = max(round_step(float((high - low).max())), round_step(4 * 24 * sheet.scale))
    for side in range(2):
        axis = int(np.argmax(np.abs(camera.axes[side])))
        sign = float(np.sign(camera.axes[side, axis]))
        ends = np.array([origin[side], origin[side] + high[side] - low[side]])
        for mark in np.arange(np.ceil(ends[0] / step), np.floor(ends[1] / step) + 1) * step:
            start = np.array([low[0] - 3 * sheet.scale, low[1] - 3 * sheet.scale])
            start[side] = low[side] + mark - origin[side]
            end = high + 3 * sheet.scale
            end[side] = start[side]
            sheet.curve(np.array([start, end]), color=Color.GRID, linewidth=0.6, zorder=1)
            words = f"{sign * mark + 0.0:.10g}".replace("-", "\N{MINUS SIGN}")
            look = {"ha": "center", "va": "top"} if side == 0 else {"ha": "right", "va": "center"}
            spot = start - np.array([0.0, 2.0] if side == 0 else [2.0, 0.0]) * sheet.scale
            sheet.text((spot[0], spot[1]), words, fontsize=6.5, color=Color.MUTED, **look)
        name = f"{'xyz'[axis]} [mm]"
        corner = np.array([high[0], low[1] - 11 * sheet.scale]) if side == 0 else np.array([low[0], high[1]])
        corner += np.array([0.0, 0.0] if side == 0 else [-8.0, 4.0]) * sheet.scale  # off a winch in the corner
        sheet.text(
            (corner[0], corner[1]), name, fontsize=6.5, color=Color.MUTED, ha="right",
            va="top" if side == 0 else "bottom",
        )  # fmt: skip
