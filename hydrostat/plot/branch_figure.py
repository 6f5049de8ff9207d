"""`draw_branches`: the poses that one robot takes at the same contractions, and how they hang together."""

from collections.abc import Sequence
from math import ceil

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from hydrostat.arrays import Vector
from hydrostat.drawing import Color
from hydrostat.errors import InputError
from hydrostat.plot.chart import plain_axes
from hydrostat.plot.labels import Labels, shorten
from hydrostat.plot.open_sheet import open_sheet
from hydrostat.plot.pane import Pane
from hydrostat.plot.sheet import WIDTH, PictureSheet, Spread
from hydrostat.robot import Robot
from hydrostat.simulation import Branch, Equilibrium, Multistability
from hydrostat.units import MILLIMETERS, plural

TOLD = 0.25  # markers that differ less, or move less, than this share of the first have no chart
ROW = 2.3  # height of a row of charts [inch]
EDGES = 0.75  # of that for words and numbers [inch]


def draw_branches(
    robot: Robot, found: Multistability, branches: Sequence[Branch], *, title: str | None = None, width: float = WIDTH
) -> Figure:
    """The poses found, one over the other; below how far markers move along the branches, if there are any.

    Stable parts are solid lines, unstable ones dashed; dots mark folds, diamonds bifurcations, and numbered dots at the
    end the poses above. Branches are on straight ways between rest and these contractions, in either direction; the
    share of the contractions is that of `found`, which must not all be 0 (InputError). The title is the robot's name if
    left out; width in inches.
    """
    if not found.contractions.any():
        raise InputError("branches lead from rest to other contractions, but these are all 0; contract a winch")
    rest, poses = robot.body.mesh.nodes, [one.pose for one in found.poses]
    head = shorten(robot.name) if title is None else title
    sheet, panes = open_sheet(
        robot, [rest, *(pose.nodes for pose in poses)], title=head, subtitle=_found_text(found), width=width
    )
    tracked = _tracked_markers(robot, found, branches)
    for pane in panes:
        _draw_poses(sheet, pane, poses)
    if len(poses) > 1:
        _name_poses(sheet, panes[0], poses, tracked[0])
    if not branches:
        return sheet.figure
    columns = 1 if len(tracked) == 1 else 2
    rows = ceil(len(tracked) / columns)
    _grow(sheet.figure, rows * ROW + 0.15)
    for index, name in enumerate(tracked):
        axes = _chart(sheet.figure, index, rows, columns, last=index >= len(tracked) - columns)
        _draw_chart(axes, robot, name, found, branches)
        if index == 0:
            _draw_key(axes, branches)
    return sheet.figure


def _found_text(found: Multistability) -> str:
    if not found.poses:
        return "no stable pose found"
    if found.unique:
        return f"one pose from {plural(found.starts, 'start')}"
    where, far = found.largest
    return f"{len(found.poses)} poses at the same contractions, up to {MILLIMETERS * far:.3g} mm apart at {where}"


def _tracked_markers(robot: Robot, found: Multistability, branches: Sequence[Branch]) -> list[str]:
    """Names of the markers that have a chart; one empty name for the node that moves most where there are none."""
    names = [marker.name for marker in robot.markers]
    if not names:
        return [""]
    points = [point for branch in branches for point in branch.points]
    ways = {name: max((_displacement(robot, point.pose, name) for point in points), default=0.0) for name in names}
    counts = found.spread if len(found.poses) > 1 else ways
    told = [name for name in names if counts[name] >= TOLD * max(counts.values())]
    most_markers = 4  # so many markers have a chart: those that differ most between the poses, or move most
    return sorted(told, key=lambda name: -counts[name])[:most_markers]


def _displacement(robot: Robot, pose: Equilibrium, name: str) -> float:
    """Displacement of a marker from its rest position, or of the node that moves most if no name is given [m]."""
    if not name:
        return float(np.linalg.norm(pose.nodes - robot.body.mesh.nodes, axis=1).max())
    at = next(marker.at for marker in robot.markers if marker.name == name)
    return float(np.linalg.norm(pose.markers[name] - np.array(at)))


def _color(index: int) -> str:
    return Color.WINCHES[index % len(Color.WINCHES)]


def _draw_poses(sheet: PictureSheet, pane: Pane, poses: Sequence[Equilibrium]) -> None:
    """The rest shape, the pose of least energy as a body, the others as outlines."""
    pane.draw_ghost(sheet)
    for index, pose in reversed(list(enumerate(poses))):
        if index == 0:
            pane.draw_body(sheet, pose.nodes, pale=0.35)
        if len(poses) > 1:
            rings = pane.outline(sheet, pose.nodes)
            color = _color(index)
            fill = "none" if index == 0 else Color.mix(color, Color.PAPER, 0.75)
            sheet.area(rings, facecolor=fill, alpha=0.55, edgecolor="none", joinstyle="round", zorder=2.5)
            sheet.area(
                rings, facecolor="none", edgecolor=color, linewidth=1.3, joinstyle="round", zorder=8 - 0.1 * index
            )


def _name_poses(sheet: PictureSheet, pane: Pane, poses: Sequence[Equilibrium], name: str) -> None:
    """A numbered flag on each pose, at the marker that differs most."""
    points: Spread = np.array([pose.markers[name] if name else _farthest(poses, pose) for pose in poses])
    places = pane.places(points)
    labels = Labels(sheet, rings=pane.outline(sheet, poses[0].nodes), avoid=places)
    colors = [_color(index) for index in range(len(poses))]
    for place, color in zip(places, colors, strict=True):
        sheet.dots(place[None], 5, color=color, markeredgecolor="white", markeredgewidth=0.8, zorder=12)
    labels.flags(places, [f"{number}: {pose.energy:.4g} J" for number, pose in enumerate(poses, start=1)], colors)


def _farthest(poses: Sequence[Equilibrium], pose: Equilibrium) -> Vector:
    """The node that differs most between the poses [m]."""
    apart = sum(np.linalg.norm(other.nodes - poses[0].nodes, axis=1) for other in poses)
    return pose.nodes[int(np.argmax(apart))]


def _grow(figure: Figure, more: float) -> None:
    """Room below all that a figure holds [inch]."""
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + more)
    share = height / (height + more)
    for axes in figure.axes:
        box = axes.get_position()
        axes.set_position((box.x0, 1 - share * (1 - box.y0), box.width, share * box.height))
    for text in figure.texts:
        x, y = text.get_position()
        text.set_position((x, 1 - share * (1 - y)))


def _chart(figure: Figure, index: int, rows: int, columns: int, *, last: bool) -> Axes:
    """An empty chart below the poses; `last` in its column."""
    width, height = figure.get_size_inches()
    row, column = divmod(index, columns)
    wide = (width - 0.2) / columns
    left, low = 0.55 + column * wide, 0.42 + (rows - 1 - row) * ROW
    axes = figure.add_axes((left / width, low / height, (wide - 0.6) / width, (ROW - EDGES) / height))
    plain_axes(axes, size=7)
    if last:
        axes.set_xlabel("share of the contractions [%]", color=Color.INK, fontsize=8)
    return axes


def _draw_chart(axes: Axes, robot: Robot, name: str, found: Multistability, branches: Sequence[Branch]) -> None:
    """Draw the displacement of one marker along the branches [mm]."""
    title = f"{shorten(name)} moved [mm]" if name else "largest displacement [mm]"
    axes.set_title(title, loc="left", color=Color.INK, fontsize=8, fontweight="bold", parse_math=False)
    for branch in branches:
        shares = 100 * np.array([_share(point.pose, found.contractions) for point in branch.points])
        moved = MILLIMETERS * np.array([_displacement(robot, point.pose, name) for point in branch.points])
        for part, stable in branch.runs():
            dashes, color, order = ("-", Color.INK, 3.0) if stable else ((0, (2.5, 1.8)), Color.ERROR, 2.5)
            axes.plot(shares[part], moved[part], linewidth=1.4, linestyle=dashes, color=color, zorder=order)
        for point in branch.critical:
            marker = "o" if point.kind == "fold" else "D"
            axes.plot(
                shares[point.index], moved[point.index], marker=marker, markersize=4.5, color=Color.ERROR,
                markeredgecolor="white", markeredgewidth=0.8, zorder=4, linestyle="none",
            )  # fmt: skip
    heights = [MILLIMETERS * _displacement(robot, one.pose, name) for one in found.poses]
    _zoom(axes, _parting(found, branches), heights)
    if len(found.poses) > 1:
        _number_poses(axes, heights)


def _parting(found: Multistability, branches: Sequence[Branch]) -> float:
    """Share [%] a little before the first pose that is not stable, or a fold; 0 where branches do not part."""
    marked = [branch.points[point.index] for branch in branches for point in branch.critical]
    lost = marked + [point for branch in branches for point in branch.points if not point.stable]
    first = min((100 * _share(point.pose, found.contractions) for point in lost), default=0.0)
    return min(max(0.0, first - 0.5 * (100 - first)), 90.0)


def _zoom(axes: Axes, begin: float, heights: Sequence[float]) -> None:
    """Show what lies between a share [%] and the end, in its own height and that of the poses there."""
    if begin > 0:
        lines = [np.column_stack(line.get_data()) for line in axes.lines]
        shown = np.concatenate([heights, *(line[line[:, 0] >= begin, 1] for line in lines)])
        edge = 0.06 * max(float(np.ptp(shown)), 1e-9)
        axes.set_ylim(float(shown.min()) - edge, float(shown.max()) + edge)
    axes.set_xlim(begin if begin > 0 else min(0.0, axes.get_xlim()[0] + 5), 100 + 0.02 * (100 - begin))


def _draw_key(axes: Axes, branches: Sequence[Branch]) -> None:
    """Draw the legend of lines and marks, if there is more than one kind."""
    dot = {"linestyle": "none", "color": Color.ERROR, "markersize": 4.5}
    keys = {
        "stable": Line2D([], [], color=Color.INK, linewidth=1.4),
        "unstable": Line2D([], [], color=Color.ERROR, linewidth=1.4, linestyle=(0, (2.5, 1.8))),
        "fold": Line2D([], [], marker="o", **dot),
        "bifurcation": Line2D([], [], marker="D", **dot),
    }
    shown = {str(point.kind) for branch in branches for point in branch.critical}
    shown |= {"stable" if stable else "unstable" for branch in branches for _, stable in branch.runs()}
    if len(shown) > 1:
        names = [name for name in keys if name in shown]
        axes.legend([keys[name] for name in names], names, loc="best", fontsize=7, frameon=False, labelcolor=Color.INK)


def _number_poses(axes: Axes, heights: Sequence[float]) -> None:
    """A dot with its number for each pose, where all contractions are taken in; numbers keep apart."""
    low, high = axes.get_ylim()
    point = (high - low) / (72 * (ROW - EDGES))
    last = -np.inf
    for index in np.argsort(heights):
        at, color = heights[index], _color(int(index))
        last = max(at, last + 9 * point)
        axes.plot(100, at, marker="o", markersize=6, color=color, zorder=5, clip_on=False)
        axes.annotate(
            f"{index + 1}", (100, at), xytext=(7, (last - at) / point), textcoords="offset points", color=color,
            fontsize=8, fontweight="bold", va="center",
        )  # fmt: skip


def _share(pose: Equilibrium, goal: Vector) -> float:
    """Share of the way from rest to the goal."""
    return float(pose.controls @ goal / (goal @ goal))
