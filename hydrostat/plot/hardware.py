"""Winches and cables: spools, sheaths and stoppers."""

from collections.abc import Sequence

import numpy as np

from hydrostat.arrays import Nodes
from hydrostat.geometry.anchors import locate
from hydrostat.plot.labels import shorten
from hydrostat.plot.palette import DARK, LIGHT, mix, winch_colours
from hydrostat.plot.places import Place, Places
from hydrostat.plot.sheet import MILLIMETRES, Sheet
from hydrostat.robot import Cable, Mount, Robot, Winch


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


def draw_winches(
    sheet: Sheet, robot: Robot, nodes: Nodes, *, notes: Sequence[str] | None = None, named: bool = True
) -> None:
    """A spool for each winch with its name, and a note after the name, when the nodes are at `nodes` [m]."""
    colours = winch_colours(robot)
    centres = winch_places(robot, nodes)
    tags = _Tags(sheet, centres)
    for index, (winch, centre) in enumerate(zip(robot.winches, centres, strict=True)):
        _draw_spool(sheet, winch, centre, colours[winch.name])
        if named:
            note = f"\N{EN SPACE}{notes[index]}" if notes else ""
            tags.place(index, shorten(winch.name) + note, colours[winch.name])


def draw_numbers(sheet: Sheet, runs: list[Places], colours: Sequence[str]) -> list[Place]:
    """The number of each cable, from 1, as a bead on it; returns where the beads are [mm]."""
    beads = [_along(run, 0.62) for run in runs]
    for number, (at, colour) in enumerate(zip(beads, colours, strict=True), start=1):
        sheet.dots(at[None], 11, color=colour, markeredgecolor=LIGHT, markeredgewidth=1.0, zorder=12)
        sheet.text(
            (at[0], at[1]), str(number), fontsize=6.5, color=LIGHT, weight="bold", ha="center", va="center_baseline",
            zorder=13,
        )  # fmt: skip
    return beads


class _Tags:
    """Names of winches on little flags, each on the side where no other winch is near."""

    def __init__(self, sheet: Sheet, centres: list[Place]) -> None:
        self._sheet = sheet
        self._centres = np.array(centres).reshape(-1, 2)
        self._taken: list[np.ndarray] = []

    def place(self, index: int, words: str, colour: str) -> None:
        scale = self._sheet.scale
        extent = np.array([0.64 * len(words) + 1.2, 1.9]) * 7 * scale
        middle = self._centres.mean(axis=0)
        best, least = np.zeros(2), np.inf
        for ray in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)):
            for gap in (13, 20, 30):
                centre = self._centres[index] + np.array(ray) * (extent / 2 + gap * scale * np.abs(ray))
                away = (centre - self._centres[index]) @ (self._centres[index] - middle)
                cost = gap / 40 + 3 * self._hits(centre, extent) - 0.3 * np.sign(round(float(away), 6))
                if cost < least:
                    best, least = centre, cost
        self._taken.append(np.array([*best, *extent]))
        self._write(self._centres[index], best, words, colour)

    def _hits(self, centre: np.ndarray, extent: np.ndarray) -> float:
        spools = (np.abs(self._centres - centre) < extent / 2 + 8 * self._sheet.scale).all(axis=1).sum()
        tags = sum(bool((np.abs(tag[:2] - centre) < (tag[2:] + extent) / 2).all()) for tag in self._taken)
        low, high = centre - extent / 2, centre + extent / 2
        return float(spools + tags + 3 * bool((low < self._sheet.low).any() or (high > self._sheet.high).any()))

    def _write(self, spool: np.ndarray, centre: np.ndarray, words: str, colour: str) -> None:
        self._sheet.curve(np.array([spool, centre]), color=colour, linewidth=0.9, zorder=10)
        self._sheet.text(
            (centre[0], centre[1]), words, fontsize=7, color=LIGHT, weight="bold", ha="center", va="center_baseline",
            zorder=25, bbox={"boxstyle": "round,pad=0.32,rounding_size=0.6", "facecolor": colour, "edgecolor": LIGHT,
            "linewidth": 0.7},
        )  # fmt: skip


def _run(robot: Robot, cable: Cable, nodes: Nodes) -> Places:
    points = np.array(cable.points)
    moving = np.ones(len(points), dtype=bool)
    moving[0] = robot.winch(cable.winch).mount is Mount.BODY
    run = points.copy()
    run[moving] = locate(robot.body.mesh, points[moving]).positions(nodes)
    return run


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
