"""Winches and cables: spools, sheaths and stoppers."""

from collections.abc import Sequence

import numpy as np

from hydrostat.arrays import Nodes
from hydrostat.geometry.anchors import locate
from hydrostat.plot.labels import Labels, shorten
from hydrostat.plot.palette import DARK, LIGHT, mix, winch_colours
from hydrostat.plot.places import Place, Places
from hydrostat.plot.sheet import MILLIMETRES, Sheet
from hydrostat.robot import Cable, Mount, Robot, Winch

SHARES = np.linspace(0.3, 0.9, 13)
"""Shares of a cable's length where its number may stand."""


def cable_runs(robot: Robot, nodes: Nodes) -> list[Places]:
    """Where the points of each cable are [mm] when the nodes are at `nodes` [m]."""
    return [MILLIMETRES * _run(robot, cable, nodes) for cable in robot.cables]


def winch_places(robot: Robot, nodes: Nodes) -> list[Place]:
    """Where each winch is [mm] when the nodes are at `nodes` [m]."""
    return [MILLIMETRES * _place(robot, winch, nodes) for winch in robot.winches]


def spool_size(winch: Winch, scale: float) -> float:
    """Diameter of a winch's picture [pt] where a point shows `scale` millimetres: true, unless too small or large."""
    return min(max(2 * MILLIMETRES * winch.spool_radius / scale, 9.0), 22.0)


def stopper_bar(run: Places, scale: float) -> Places:
    """Ends of the bar across the end of a run [mm] where a point shows `scale` millimetres."""
    way = run[-1] - run[-2]
    across = np.array([-way[1], way[0]]) / max(float(np.linalg.norm(way)), 1e-12) * 3.4 * scale
    return np.array([run[-1] - across, run[-1] + across])


def draw_cables(
    sheet: Sheet, robot: Robot, runs: list[Places], *, colours: Sequence[str] | None = None, width: float = 2.0
) -> None:
    """Cables along their runs [mm]: sheaths as pale pipes, a bead at each via point, a bar as the stopper.

    Args:
        sheet: to draw on.
        robot: whose cables they are.
        runs: the points of each cable [mm].
        colours: of each cable; those of the winches if left out.
        width: of a cable [pt].
    """
    by_winch = winch_colours(robot)
    for index, (cable, run) in enumerate(zip(robot.cables, runs, strict=True)):
        colour = colours[index] if colours is not None else by_winch[cable.winch]
        sheet.curve(run, color=LIGHT, linewidth=width + 1.8, alpha=0.85, zorder=8)
        for start, end in cable.sheathed:
            pipe = run[start : end + 1]
            sheet.curve(pipe, color=mix(colour, LIGHT, 0.35), linewidth=width + 5.0, solid_capstyle="butt", zorder=8.2)
            sheet.curve(pipe, color=mix(colour, LIGHT, 0.82), linewidth=width + 3.6, solid_capstyle="butt", zorder=8.3)
        sheet.curve(run, color=colour, linewidth=width, zorder=9)
        sheet.dots(run[1:-1], 3.0, color=LIGHT, markeredgecolor=colour, markeredgewidth=0.9, zorder=9.2)
        _draw_stopper(sheet, run, colour, width)


def draw_winches(sheet: Sheet, robot: Robot, nodes: Nodes) -> None:
    """A spool for each winch when the nodes are at `nodes` [m]."""
    colours = winch_colours(robot)
    for winch, centre in zip(robot.winches, winch_places(robot, nodes), strict=True):
        _draw_spool(sheet, winch, centre, colours[winch.name])


def name_winches(labels: Labels, robot: Robot, nodes: Nodes, notes: Sequence[str] = ()) -> None:
    """The name of each winch, and a note behind it, on a flag at its spool when the nodes are at `nodes` [m]."""
    colours, centres = winch_colours(robot), winch_places(robot, nodes)
    for centre in centres:
        labels.reserve(centre, 18)
    for index, (winch, centre) in enumerate(zip(robot.winches, centres, strict=True)):
        note = f"\N{EN SPACE}{notes[index]}" if notes else ""
        labels.flag(centre, shorten(winch.name) + note, colours[winch.name])


def draw_numbers(sheet: Sheet, runs: list[Places], colours: Sequence[str], labels: Labels) -> list[Place]:
    """The number of each cable, from 1, as a bead on it; returns where the beads are."""
    beads = _beads(runs, 13 * sheet.scale)
    for number, (at, colour) in enumerate(zip(beads, colours, strict=True), start=1):
        labels.reserve(at, 11)
        sheet.dots(at[None], 11, color=colour, markeredgecolor=LIGHT, markeredgewidth=1.0, zorder=12)
        sheet.text(
            (at[0], at[1]), str(number), fontsize=6.5, color=LIGHT, weight="bold", ha="center", va="center_baseline",
            zorder=13,
        )  # fmt: skip
    return beads


def cable_dots(sheet: Sheet, runs: list[Places]) -> Places:
    """Points all along the cables, so close that no label between them can cover a cable."""
    dots = [
        _along(run, share) for run in runs for share in np.linspace(0, 1, 2 + int(_length(run) / (6 * sheet.scale)))
    ]
    return np.array(dots).reshape(-1, 2)


def _beads(runs: list[Places], gap: float) -> list[Place]:
    """A point on each run beyond its middle, if possible further than `gap` from other beads, runs and winches."""
    beads: list[Place] = []
    for index, run in enumerate(runs):
        others = [_along(other, share) for place, other in enumerate(runs) if place != index for share in SHARES]
        seen = np.array([*beads, *beads, run[0], *others])
        spots = [_along(run, share) for share in SHARES]
        crowds = [float(np.maximum(1 - np.linalg.norm(seen - spot, axis=1) / gap, 0).sum()) for spot in spots]
        costs = np.array(crowds) + np.abs(SHARES - 0.62)
        beads.append(spots[int(np.argmin(costs))])
    return beads


def _run(robot: Robot, cable: Cable, nodes: Nodes) -> Places:
    points = np.array(cable.points)
    moving = np.ones(len(points), dtype=bool)
    moving[0] = robot.winch(cable.winch).mount is Mount.BODY
    run = points.copy()
    run[moving] = locate(robot.body.mesh, points[moving]).positions(nodes)
    return run


def _length(run: Places) -> float:
    return float(np.linalg.norm(np.diff(run, axis=0), axis=1).sum())


def _along(run: Places, share: float) -> Place:
    """The point of a run at a share of its length."""
    lengths = np.linalg.norm(np.diff(run, axis=0), axis=1)
    places = np.concatenate([[0.0], np.cumsum(lengths)])
    return np.array([np.interp(share * places[-1], places, run[:, side]) for side in range(2)])


def _place(robot: Robot, winch: Winch, nodes: Nodes) -> Place:
    at = np.array(winch.at)
    return at if winch.mount is Mount.WORLD else locate(robot.body.mesh, at[None]).positions(nodes)[0]


def _draw_spool(sheet: Sheet, winch: Winch, centre: Place, colour: str) -> None:
    """Flange, drum and axle; a winch outside the body sits on a square plate."""
    size = spool_size(winch, sheet.scale)
    if winch.mount is Mount.WORLD:
        sheet.curve(
            centre[None], linestyle="none", marker="s", markersize=1.5 * size, color=LIGHT, markeredgecolor=DARK,
            markeredgewidth=0.9, zorder=19,
        )  # fmt: skip
    sheet.dots(centre[None], size, color=colour, markeredgecolor=LIGHT, markeredgewidth=1.0, zorder=20)
    sheet.dots(centre[None], 0.58 * size, color=mix(colour, LIGHT, 0.75), markeredgecolor="none", zorder=20.1)
    sheet.dots(centre[None], 0.2 * size, color=colour, markeredgecolor="none", zorder=20.2)


def _draw_stopper(sheet: Sheet, run: Places, colour: str, width: float) -> None:
    bar = stopper_bar(run, sheet.scale)
    sheet.curve(bar, color=LIGHT, linewidth=width + 2.4, zorder=9.3)
    sheet.curve(bar, color=colour, linewidth=width + 0.8, zorder=9.4)
