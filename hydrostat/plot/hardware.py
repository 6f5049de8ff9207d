"""Winches and cables on a body: spools, sheaths and stoppers, their names and numbers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.drawing import Color
from hydrostat.plot.drawn_body import DrawnBody, DrawnCable
from hydrostat.plot.frame import Attachments
from hydrostat.plot.labels import Labels, shorten
from hydrostat.plot.pane import Pane
from hydrostat.plot.sheet import PictureSheet, Place, Places, join_lines
from hydrostat.robot import Mount, Robot, Winch, obstacle_lines
from hydrostat.units import MILLIMETERS

SHARES = np.linspace(0.3, 0.9, 13)  # shares of a cable's length where its number may stand


@dataclass(frozen=True, eq=False)
class DrawnRobot:
    """A robot on one pane."""

    pane: Pane  # that shows it
    body: DrawnBody  # as it is drawn
    cables: list[DrawnCable]  # as they are drawn
    winches: Places  # where they are [mm]

    @property
    def runs(self) -> list[Places]:
        """Points of each cable [mm]."""
        return [cable.points for cable in self.cables]

    def labels(self, sheet: PictureSheet, places: Places) -> Labels:
        """Labels that keep off cables and off places [mm], such as markers."""
        labels = Labels(sheet, rings=self.body.rings, avoid=np.concatenate([_cable_dots(sheet, self.runs), places]))
        for place in places:
            labels.reserve(place, 6)
        return labels


def draw_hardware(
    sheet: PictureSheet,
    pane: Pane,
    body: DrawnBody,
    carried: Attachments,
    nodes: Nodes,
    *,
    colors: Sequence[str] | None = None,
    width: float = 2.0,
    contractions: Vector | None = None,
) -> DrawnRobot:
    """Draw cables and winches on a body whose nodes are at `nodes` [m].

    Cables have the colors of the winches if left out, and a width in points; contractions [m] are told by hands on the
    spools, and without them there are none.
    """
    cables, winches = [body.cable(points) for points in carried.cables(nodes)], carried.winches(nodes)
    drawn = DrawnRobot(pane, body, cables, pane.places(winches))
    for line in obstacle_lines(carried.robot):
        sheet.curve(pane.places(line), color=Color.MUTED, linewidth=1.2, clip_on=True)
    _draw_cables(sheet, carried.robot, cables, colors=colors, width=width)
    _draw_winches(sheet, carried.robot, drawn.winches, body.fades(winches), contractions=contractions)
    return drawn


def spool_size(winch: Winch, scale: float) -> float:
    """Diameter of a winch's picture [pt] where a point shows `scale` millimeters: true, unless too small or large."""
    return min(max(2 * MILLIMETERS * winch.spool_radius / scale, 9.0), 22.0 if len(winch.at) == 2 else 12.0)


def stopper_bar(run: Places, scale: float) -> Places:
    """Ends of the bar across the end of a run [mm] where a point shows `scale` millimeters."""
    way = run[-1] - run[-2]
    across = np.array([-way[1], way[0]]) / max(float(np.linalg.norm(way)), 1e-12) * 3.4 * scale
    return np.array([run[-1] - across, run[-1] + across])


def _draw_cables(
    sheet: PictureSheet,
    robot: Robot,
    runs: list[DrawnCable],
    *,
    colors: Sequence[str] | None = None,
    width: float = 2.0,
) -> None:
    """Cables along their runs: sheaths as pale pipes, a bead at each via point, a bar as the stopper.

    What the body covers is thinner and of the color of the body, the more so the deeper it lies.
    """
    by_winch = Color.of_winches(robot.winches)
    for index, (cable, run) in enumerate(zip(robot.cables, runs, strict=True)):
        color = colors[index] if colors is not None else by_winch[cable.winch]
        for start, end in cable.sheathed:
            _draw_sheath(sheet, run.points[start : end + 1], color, width, float(run.fades[start : end + 1].mean()))
        for fade in sorted({fade for _, fade in run.parts}):
            alike = [part for part, own in run.parts if own == fade]
            _draw_part(sheet, join_lines(alike), color, width, fade)
        _draw_beads(sheet, run, color)
        _draw_stopper(sheet, run, color, width)


def _draw_winches(
    sheet: PictureSheet, robot: Robot, centers: Places, fades: Vector, *, contractions: Vector | None
) -> None:
    """A spool for each winch at its center [mm], faded where the body covers it; a hand tells how far it has turned.

    There are hands only where `contractions` [m] are given.
    """
    colors = Color.of_winches(robot.winches)
    for index, (winch, center, fade) in enumerate(zip(robot.winches, centers, fades, strict=True)):
        _draw_spool(sheet, winch, center, colors[winch.name], float(fade))
        if contractions is not None:
            turn = float(contractions[index]) / winch.spool_radius
            _draw_hand(sheet, winch, center, turn, _fade_color(Color.DARK, float(fade)), 20.3 if fade == 0 else 10.8)


def name_winches(labels: Labels, robot: Robot, centers: Places, notes: Sequence[str] = ()) -> None:
    """The name of each winch, and a note behind it, on a flag at its spool with the center [mm]."""
    colors = Color.of_winches(robot.winches)
    for center in centers:
        labels.reserve(center, 18)
    notes = [f"\N{EN SPACE}{note}" for note in notes] or [""] * len(robot.winches)
    words = [shorten(winch.name) + note for winch, note in zip(robot.winches, notes, strict=True)]
    labels.flags(centers, words, [colors[winch.name] for winch in robot.winches])


def draw_numbers(sheet: PictureSheet, runs: list[Places], colors: Sequence[str], labels: Labels) -> list[Place]:
    """The number of each cable, from 1, as a bead on it; returns where the beads are."""
    beads = _beads(runs, 13 * sheet.scale)
    for number, (at, color) in enumerate(zip(beads, colors, strict=True), start=1):
        labels.reserve(at, 11)
        sheet.dots(at[None], 11, color=color, markeredgecolor=Color.LIGHT, markeredgewidth=1.0, zorder=12)
        sheet.text(
            (at[0], at[1]), str(number), fontsize=6.5, color=Color.LIGHT, weight="bold", ha="center",
            va="center_baseline", zorder=13,
        )  # fmt: skip
    return beads


def _cable_dots(sheet: PictureSheet, runs: list[Places]) -> Places:
    """Points all along the cables, so close that no label between them can cover a cable."""
    dots = [_along(run, np.linspace(0, 1, 2 + int(_length(run) / (6 * sheet.scale)))) for run in runs]
    return np.concatenate([np.zeros((0, 2)), *dots])


def _beads(runs: list[Places], gap: float) -> list[Place]:
    """A point on each run beyond its middle, if possible further than `gap` from other beads, runs and winches."""
    beads: list[Place] = []
    along = [_along(run, SHARES) for run in runs]
    for index, run in enumerate(runs):
        others = [point for place, other in enumerate(along) if place != index for point in other]
        seen = np.array([*beads, *beads, run[0], *others])
        spots = along[index]
        crowds = [float(np.maximum(1 - np.linalg.norm(seen - spot, axis=1) / gap, 0).sum()) for spot in spots]
        costs = np.array(crowds) + np.abs(SHARES - 0.62)
        beads.append(spots[int(np.argmin(costs))])
    return beads


def _length(run: Places) -> float:
    return float(np.linalg.norm(np.diff(run, axis=0), axis=1).sum())


def _along(run: Places, shares: Vector) -> Places:
    """The points of a run at shares of its length."""
    lengths = np.linalg.norm(np.diff(run, axis=0), axis=1)
    places = np.concatenate([[0.0], np.cumsum(lengths)])
    return np.column_stack([np.interp(shares * places[-1], places, run[:, side]) for side in range(2)])


def _draw_spool(sheet: PictureSheet, winch: Winch, center: Place, color: str, fade: float) -> None:
    """Flange, drum and axle; a winch outside the body sits on a square plate, a covered one beneath markers."""
    size, light, color = spool_size(winch, sheet.scale), _fade_color(Color.LIGHT, fade), _fade_color(color, fade)
    order = 19.0 if fade == 0 else 9.5
    if winch.mount is Mount.WORLD:
        sheet.curve(
            center[None], linestyle="none", marker="s", markersize=1.5 * size, color=light,
            markeredgecolor=_fade_color(Color.DARK, fade), markeredgewidth=0.9, zorder=order,
        )  # fmt: skip
    sheet.dots(center[None], size, color=color, markeredgecolor=light, markeredgewidth=1.0, zorder=order + 1)
    sheet.dots(
        center[None], 0.58 * size, color=Color.mix(color, light, 0.75), markeredgecolor="none", zorder=order + 1.1
    )
    sheet.dots(center[None], 0.2 * size, color=color, markeredgecolor="none", zorder=order + 1.2)


def _draw_hand(sheet: PictureSheet, winch: Winch, center: Place, turn: float, color: str, order: float) -> None:
    """A hand on a spool, upright at rest, that goes round to the right by `turn` [rad]."""
    reach = 0.44 * spool_size(winch, sheet.scale) * sheet.scale
    end = center + reach * np.array([np.sin(turn), np.cos(turn)])
    sheet.curve(np.array([center, end]), color=color, linewidth=1.2, zorder=order)


def _draw_sheath(sheet: PictureSheet, pipe: Places, color: str, width: float, fade: float) -> None:
    """A pale pipe around a piece of a cable, beneath all cables where the body covers it."""
    wall, order = _fade_color(color, fade), 6.0 if fade > 0 else 8.2
    sheet.curve(
        pipe, color=Color.mix(wall, Color.LIGHT, 0.35), linewidth=width + 5.0, solid_capstyle="butt", zorder=order
    )
    sheet.curve(
        pipe, color=Color.mix(wall, Color.LIGHT, 0.82), linewidth=width + 3.6, solid_capstyle="butt", zorder=order + 0.1
    )


def _draw_part(sheet: PictureSheet, part: Places, color: str, width: float, fade: float) -> None:
    """Pieces of a cable: with a pale border where they lie in front, thinner where the body covers them."""
    if fade > 0:
        sheet.curve(
            part, color=_fade_color(Color.LIGHT, 0.45 + 0.5 * fade), linewidth=0.8 * width + 1.4, zorder=6.9 - fade
        )
        sheet.curve(part, color=_fade_color(color, fade), linewidth=0.8 * width, zorder=7 - fade)
    else:
        sheet.curve(part, color=Color.LIGHT, linewidth=width + 1.8, alpha=0.85, zorder=8)
        sheet.curve(part, color=color, linewidth=width, zorder=9)


def _draw_beads(sheet: PictureSheet, run: DrawnCable, color: str) -> None:
    fades = run.fades[1:-1]
    for fade in np.unique(fades):
        look = {"color": _fade_color(Color.LIGHT, fade), "markeredgecolor": _fade_color(color, fade)}
        beads = run.points[1:-1][fades == fade]
        sheet.dots(beads, 2.2 if fade else 3.0, markeredgewidth=0.6 if fade else 0.9, zorder=9.2 - 2 * fade, **look)


def _draw_stopper(sheet: PictureSheet, run: DrawnCable, color: str, width: float) -> None:
    bar, fade = stopper_bar(run.points, sheet.scale), float(run.fades[-1])
    sheet.curve(bar, color=_fade_color(Color.LIGHT, fade), linewidth=width + 2.4, zorder=9.3)
    sheet.curve(bar, color=_fade_color(color, fade), linewidth=width + 0.8, zorder=9.4)


def _fade_color(color: str, fade: float) -> str:
    return Color.mix(color, Color.FELT, fade) if fade > 0 else color
