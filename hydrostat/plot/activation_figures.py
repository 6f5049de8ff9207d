"""Pictures of the way to a network: which muscles would pull, which are kept, which routes grow from them."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Int
from matplotlib.figure import Figure

from hydrostat.design.network import Activation
from hydrostat.plot.felt import draw_felt, draw_ghost
from hydrostat.plot.labels import Labels, shorten
from hydrostat.plot.palette import LIGHT, WINCHES
from hydrostat.plot.places import Places
from hydrostat.plot.sheet import MILLIMETRES, WIDTH, Sheet, new_sheet
from hydrostat.plot.skin import Skin
from hydrostat.plot.targets import draw_crosses, draw_errors, draw_markers, target_points
from hydrostat.plot.tension_scale import TensionScale
from hydrostat.robot import Robot
from hydrostat.units import counted

PALE = 0.62
"""How far felt fades behind muscles."""


def draw_activation(robot: Robot, activation: Activation, *, title: str | None = None, width: float = WIDTH) -> Figure:
    """The activation graph (Fig 3.9a): the body as its muscles pose it, each fibre as wide and dark as it pulls.

    Args:
        robot: to draw.
        activation: the muscles' tensions and the pose they make.
        title: above the picture; the pose's name if left out, nothing if empty.
        width: of the picture [inch].

    Raises:
        InputError: a body in space.
    """
    skin, pose = Skin.of(robot.body), activation.target
    rings = [MILLIMETRES * ring for ring in skin.shape(activation.nodes)]
    ghost = MILLIMETRES * skin.shape(robot.body.mesh.nodes)[0]
    head = f"Activation: {shorten(pose.name)}" if title is None else title
    note = f"{len(activation.fibres)} fibres, marker error {MILLIMETRES * activation.rms_error:.2f} mm rms"
    points = np.concatenate([rings[0], ghost, target_points(pose)])
    sheet = new_sheet(points, title=head, subtitle=note, width=width, bar=True)
    draw_ghost(sheet, skin, robot.body.mesh.nodes)
    draw_felt(sheet, skin, activation.nodes, pale=PALE)
    scale = TensionScale.of(activation.tensions)
    scale.draw_lines(sheet, MILLIMETRES * activation.fibres.ends(activation.nodes), activation.tensions)
    scale.draw_bar(sheet, of="fibre tension")
    _draw_markers(sheet, robot, activation, rings)
    return sheet.figure


def draw_candidates(
    robot: Robot,
    activation: Activation,
    candidates: Int[np.ndarray, " candidates"],
    *,
    title: str | None = None,
    width: float = WIDTH,
) -> Figure:
    """The fibres that passed the threshold, on the rest shape (Fig 3.9b).

    Args:
        robot: to draw.
        activation: all fibres and their tensions.
        candidates: which of them are kept.
        title: above the picture; the pose's name if left out, nothing if empty.
        width: of the picture [inch].

    Raises:
        InputError: a body in space.
    """
    head = f"Candidates: {shorten(activation.target.name)}" if title is None else title
    note = f"the strongest {len(candidates)} of {counted(len(activation.fibres), 'fibre')}"
    sheet = _pale_sheet(robot, head, note, width, bar=True)
    tensions = activation.tensions[candidates]
    scale = TensionScale.of(tensions)
    scale.draw_lines(
        sheet, MILLIMETRES * activation.fibres.ends(robot.body.mesh.nodes)[candidates], tensions, widest=4.6
    )
    scale.draw_bar(sheet, of="fibre tension")
    return sheet.figure


def draw_trees(robot: Robot, trees: Iterable[Places], *, title: str | None = None, width: float = WIDTH) -> Figure:
    """Routes that grew from the candidates, on the rest shape, a colour each (Fig 3.9c).

    Args:
        robot: to draw.
        trees: the routes [m].
        title: above the picture; "Trees" if left out, nothing if empty.
        width: of the picture [inch].

    Raises:
        InputError: a body in space.
    """
    trees = list(trees)
    note = f"{counted(len(trees), 'route')} grown from the candidates"
    sheet = _pale_sheet(robot, "Trees" if title is None else title, note, width, bar=title == "")
    for index, tree in enumerate(trees):
        colour, route = WINCHES[index % len(WINCHES)], MILLIMETRES * np.asarray(tree)
        sheet.curve(route, color=LIGHT, linewidth=3.6, alpha=0.9, zorder=7)
        sheet.curve(route, color=colour, linewidth=1.8, zorder=8)
        sheet.dots(route, 3.0, color=colour, markeredgecolor=LIGHT, markeredgewidth=0.6, zorder=9)
    return sheet.figure


def _pale_sheet(robot: Robot, title: str, subtitle: str, width: float, *, bar: bool) -> Sheet:
    skin, nodes = Skin.of(robot.body), robot.body.mesh.nodes
    sheet = new_sheet(MILLIMETRES * skin.shape(nodes)[0], title=title, subtitle=subtitle, width=width, bar=bar)
    draw_felt(sheet, skin, nodes, pale=PALE)
    return sheet


def _draw_markers(sheet: Sheet, robot: Robot, activation: Activation, rings: list[Places]) -> None:
    from hydrostat.geometry.anchors import locate

    named = [marker for marker in robot.markers if marker.name in activation.target.targets]
    places = locate(robot.body.mesh, np.array([marker.at for marker in named])).positions(activation.nodes)
    markers = {marker.name: place for marker, place in zip(named, places, strict=True)}
    draw_errors(sheet, markers, activation.target)
    draw_crosses(sheet, activation.target)
    draw_markers(sheet, markers)
    labels = Labels(sheet, rings=rings, avoid=np.concatenate([MILLIMETRES * places, target_points(activation.target)]))
    for name, place in markers.items():
        labels.place(MILLIMETRES * place, f"{shorten(name)}\N{EN SPACE}{MILLIMETRES * activation.errors[name]:.1f} mm")
