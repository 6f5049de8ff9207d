"""Markers, where they should go, and how far from there they are."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.patches import FancyArrowPatch

from hydrostat.arrays import Points, Vector
from hydrostat.drawing import Color
from hydrostat.plot.pane import Pane
from hydrostat.plot.sheet import PictureSheet, Place
from hydrostat.robot import PoseTarget, Robot


def rest_markers(robot: Robot) -> dict[str, Vector]:
    """Each marker in the rest pose [m]."""
    return {marker.name: np.array(marker.at) for marker in robot.markers}


def draw_markers(sheet: PictureSheet, places: Mapping[str, Place], *, size: float = 6.0) -> None:
    """A white dot with a dark rim for each marker [mm]."""
    if places:
        points = np.array(list(places.values()))
        sheet.dots(points, size, color=Color.LIGHT, markeredgecolor=Color.DARK, markeredgewidth=1.3, zorder=16)


def draw_crosses(sheet: PictureSheet, targets: Mapping[str, Place]) -> None:
    """A cross at each target [mm]."""
    cross = 3.2 * sheet.scale * np.array([[(-1, -1), (1, 1)], [(-1, 1), (1, -1)]])
    for target in targets.values():
        strokes = cross + target
        sheet.segments(strokes, color=Color.LIGHT, linewidth=3.6, zorder=17)
        sheet.segments(strokes, color=Color.DARK, linewidth=1.5, zorder=17.1)


def draw_arrows(sheet: PictureSheet, places: Mapping[str, Place], targets: Mapping[str, Place]) -> None:
    """An arrow from each marker [mm] to its target [mm], a little short of both."""
    for name, end in targets.items():
        start = places[name]
        if np.linalg.norm(end - start) > 10 * sheet.scale:
            for color, width, order in ((Color.LIGHT, 3.4, 14), (Color.DARK, 1.3, 14.1)):
                arrow = FancyArrowPatch(
                    (start[0], start[1]), (end[0], end[1]), arrowstyle="-|>,head_length=4.2,head_width=2.1",
                    shrinkA=4, shrinkB=6, color=color, linewidth=width, capstyle="round", joinstyle="round",
                    zorder=order, clip_on=False, connectionstyle="arc3,rad=0.08",
                )  # fmt: skip
                sheet.axes.add_patch(arrow)


def draw_errors(sheet: PictureSheet, places: Mapping[str, Place], targets: Mapping[str, Place]) -> None:
    """A thin red line from each marker [mm] to its target [mm]."""
    ends = np.array([[places[name], target] for name, target in targets.items()])
    sheet.segments(ends, color=Color.LIGHT, linewidth=2.6, zorder=15)
    sheet.segments(ends, color=Color.ERROR, linewidth=1.3, zorder=15.1)


def draw_misses(
    sheet: PictureSheet, panes: Sequence[Pane], tracked: Mapping[str, Vector], goals: Mapping[str, Vector]
) -> None:
    """Draw markers at points [m], a cross at each goal [m], and how far the markers are from these."""
    for pane in panes:
        markers, targets = pane.locate_points(tracked), pane.locate_points(goals)
        draw_errors(sheet, markers, targets)
        draw_crosses(sheet, targets)
        draw_markers(sheet, markers)


def target_places(pose: PoseTarget) -> dict[str, Vector]:
    """Each target [m]."""
    return {name: np.array(target, dtype=float) for name, target in pose.targets.items()}


def target_points(pose: PoseTarget) -> Points:
    """All targets [m]."""
    return np.array(list(pose.targets.values()), dtype=float)


def rest_errors(robot: Robot, pose: PoseTarget) -> dict[str, float]:
    """Distance of each targeted marker from its target while the robot rests [m]."""
    markers = rest_markers(robot)
    return {name: float(np.linalg.norm(markers[name] - np.array(target))) for name, target in pose.targets.items()}
