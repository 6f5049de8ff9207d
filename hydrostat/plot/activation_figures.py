"""Pictures of the way to a network: which muscles would pull, which are kept, which routes grow from them."""

from collections.abc import Iterable
from itertools import product

import numpy as np
from matplotlib.figure import Figure

from hydrostat.arrays import Float, Int
from hydrostat.design import Activation
from hydrostat.drawing import Color
from hydrostat.plot.drawn_body import DrawnBody
from hydrostat.plot.labels import Labels, shorten
from hydrostat.plot.open_sheet import open_sheet
from hydrostat.plot.pane import Pane
from hydrostat.plot.sheet import WIDTH, PictureSheet, Spread
from hydrostat.plot.targets import draw_misses, target_places, target_points
from hydrostat.plot.tension_scale import TensionScale
from hydrostat.robot import Robot
from hydrostat.units import MILLIMETERS, plural

PALE = 0.62  # how far felt fades behind muscles


def draw_activation(robot: Robot, activation: Activation, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """The activation graph (Fig 3.9a): the body as its muscles pose it, each fibre as wide and dark as it pulls.

    The title is the pose's name if left out, nothing if empty; width in inches.
    """
    pose, rest = activation.target, robot.body.mesh.nodes
    head = f"Activation: {shorten(pose.name)}" if title is None else title
    note = f"{len(activation.fibres)} fibres, marker error {MILLIMETERS * activation.rms_error:.2f} mm rms"
    sheet, panes = open_sheet(
        robot, [activation.nodes, rest], [target_points(pose)], title=head, subtitle=note, width=width, bar=True
    )
    scale = TensionScale.of(activation.tensions)
    surfaces = []
    for pane in panes:
        pane.draw_ghost(sheet)
        surfaces.append(pane.draw_body(sheet, activation.nodes, pale=PALE))
        scale.draw_lines(sheet, _flat(pane, activation.fibres.ends(activation.nodes)), activation.tensions)
    scale.draw_bar(sheet, of="fibre tension")
    _draw_markers(sheet, robot, activation, panes, surfaces[0])
    return sheet.figure


def draw_candidates(
    robot: Robot,
    activation: Activation,
    candidates: Int[np.ndarray, " candidates"],
    *,
    title: str | None = None,
    width: float = WIDTH,
) -> Figure:
    """The fibres of the candidates that passed the threshold, on the rest shape (Fig 3.9b).

    The title is the pose's name if left out, nothing if empty; width in inches.
    """
    head = f"Candidates: {shorten(activation.target.name)}" if title is None else title
    note = f"the strongest {len(candidates)} of {plural(len(activation.fibres), 'fibre')}"
    sheet, panes = _pale_sheet(robot, head, note, width, bar=True)
    tensions = activation.tensions[candidates]
    scale = TensionScale.of(tensions)
    ends = activation.fibres.ends(robot.body.mesh.nodes)[candidates]
    for pane in panes:
        scale.draw_lines(sheet, _flat(pane, ends), tensions, widest=4.6)
    scale.draw_bar(sheet, of="fibre tension")
    return sheet.figure


def draw_trees(robot: Robot, trees: Iterable[Spread], *, title: str | None = None, width: float = WIDTH) -> Figure:
    """Routes [m] that grew from the candidates, on the rest shape, a color each (Fig 3.9c); width in inches."""
    trees = list(trees)
    note = f"{plural(len(trees), 'route')} grown from the candidates"
    sheet, panes = _pale_sheet(robot, "Trees" if title is None else title, note, width, bar=title == "")
    for pane, (index, tree) in product(panes, enumerate(trees)):
        color, route = Color.WINCHES[index % len(Color.WINCHES)], pane.places(np.asarray(tree))
        sheet.curve(route, color=Color.LIGHT, linewidth=3.6, alpha=0.9, zorder=7)
        sheet.curve(route, color=color, linewidth=1.8, zorder=8)
        sheet.dots(route, 3.0, color=color, markeredgecolor=Color.LIGHT, markeredgewidth=0.6, zorder=9)
    return sheet.figure


def _pale_sheet(robot: Robot, title: str, subtitle: str, width: float, *, bar: bool) -> tuple[PictureSheet, list[Pane]]:
    nodes = robot.body.mesh.nodes
    sheet, panes = open_sheet(robot, [nodes], title=title, subtitle=subtitle, width=width, bar=bar)
    for pane in panes:
        pane.draw_body(sheet, nodes, pale=PALE)
    return sheet, panes


def _flat(pane: Pane, ends: Float[np.ndarray, "lines 2 dim"]) -> Float[np.ndarray, "lines 2 2"]:
    """Ends of lines [m] on the sheet [mm]."""
    return pane.places(ends.reshape(-1, ends.shape[2])).reshape(-1, 2, 2)


def _draw_markers(
    sheet: PictureSheet, robot: Robot, activation: Activation, panes: list[Pane], surface: DrawnBody
) -> None:
    from hydrostat.geometry import locate

    goals = target_places(activation.target)
    named = [marker for marker in robot.markers if marker.name in goals]
    points = locate(robot.body.mesh, np.array([marker.at for marker in named])).positions(activation.nodes)
    tracked = {marker.name: point for marker, point in zip(named, points, strict=True)}
    draw_misses(sheet, panes, tracked, goals)
    markers, targets = panes[0].locate_points(tracked), panes[0].locate_points(goals)
    labels = Labels(sheet, rings=surface.rings, avoid=np.array([*markers.values(), *targets.values()]))
    for name, place in markers.items():
        labels.place(place, f"{shorten(name)}\N{EN SPACE}{MILLIMETERS * activation.errors[name]:.1f} mm")
