"""`robot_items`, `winch_bars`: pins, winches, cables and markers of a robot as dots and lines, its winches as bars."""

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product

import numpy as np

from hydrostat.arrays import Int, Points, Vector
from hydrostat.design import Diagnostic, Severity
from hydrostat.drawing import Color
from hydrostat.errors import in_words
from hydrostat.fabrication import winch_marks_of
from hydrostat.geometry import Mesh
from hydrostat.given import Point
from hydrostat.robot import Body, Cable, Mount, Pin, Robot, Winch, find_part_facets, find_rings, obstacle_lines
from hydrostat.simulation import obstacles_in_pose
from hydrostat.studio.view.scene_items import Cloud, Dot, Look, RobotShape, SceneItem, Strand, Stroke


def pinned_points(robot: Robot) -> Points:
    """Points on all that pins hold [m]: on the skin of a body in space; on a flat one, in the boxes of pins."""
    flat = robot.body.mesh.dim == 2
    return _points(robot.body.mesh, tuple(pin for pin in robot.pins if not flat or pin.box is not None))


@lru_cache(maxsize=8)
def _points(mesh: Mesh, pins: tuple[Pin, ...]) -> Points:
    held = np.zeros(len(mesh.nodes), dtype=bool)
    for pin in pins:
        held |= pin.holds(mesh)
    faces = mesh.elements if mesh.dim == 2 else mesh.boundary
    corners = mesh.nodes[faces[held[faces].all(axis=1)]]
    parts = 4  # a triangle is dotted with so many points along each side
    steps = [(i, j, parts - i - j) for i, j in product(range(parts + 1), repeat=2) if i + j <= parts]
    dots = np.einsum("sc,fcd->fsd", np.array(steps) / parts, corners).reshape(-1, mesh.dim)
    return np.unique(np.concatenate([dots, mesh.nodes[held]]).round(7), axis=0)


MARKER = "#2b2833"
PIN = "#5f5a68"
PREDICTED = "#d9730d"
DETAIL = 1500  # so many points of what is drawn on a body are sent with each frame at most, or near that


def robot_items(
    robot: Robot,
    *,
    tensions: Vector | None = None,
    scale: float = 10.0,
    carried: Points | None = None,
    chosen: Collection[str] = (),
    vias: bool = False,
) -> list[SceneItem]:
    """Return a robot's obstacles, drawn lines, pins, cables, winches and markers, in this order; `chosen` are selected.

    Keys are "pin:0", "cable:0", "via:0:2" (cable and point), "winch:left" and "marker:tip". Tensions of the cables [N]
    are drawn on a scale up to the largest, obstacles that move where they are carried to [m]. With `vias` each point of
    a cable is a dot that can be taken hold of; else only its stopper is shown.
    """
    colors, marks = Color.of_winches(robot.winches), winch_marks_of(robot)
    items: list[SceneItem] = [
        Strand(points=tuple(map(tuple, line.tolist())), stroke=Stroke.RIM, color=Color.MUTED, loose=-1)
        for line in obstacle_lines(obstacles_in_pose(robot, carried))
    ]
    items += [*_part_items(robot), *_drawing_items(robot)]
    held = pinned_points(robot)
    if len(held):
        items.append(Cloud(name="pins", points=held, color=PIN))
    for index, pin in enumerate(robot.pins):
        middle = pin.at if pin.at is not None else tuple(np.mean(pin.box or (), axis=0).tolist())
        key = f"pin:{index}"
        items.append(Dot(key=key, at=middle, look=Look.PIN, color=PIN, chosen=key in chosen, radius=pin.radius))
    loads = np.zeros(len(robot.cables)) if tensions is None else np.clip(tensions / scale, 0.0, 1.0)
    for index, cable in enumerate(robot.cables):
        items += _cable(robot, index, cable, colors[cable.winch], float(loads[index]), chosen)
    for index, cable in enumerate(robot.cables):
        items += _vias(index, cable, colors[cable.winch], chosen, every=vias)
    for winch in robot.winches:
        key = f"winch:{winch.name}"
        items.append(_winch(winch, colors[winch.name], marks[winch.name], chosen=key in chosen))
    for marker in robot.markers:
        key = f"marker:{marker.name}"
        dot = Dot(key=key, at=marker.at, look=Look.MARKER, color=MARKER, label=marker.name, chosen=key in chosen)
        items.append(dot)
    return items


def proposal_items(robot: Robot, own: Collection[Winch] = ()) -> list[SceneItem]:
    """Cables and winches of a network that is proposed, faintly; none can be picked.

    Winches that stand on own ones, which are drawn already, are left out.
    """
    colors, marks = Color.of_winches(robot.winches), winch_marks_of(robot)
    items: list[SceneItem] = []
    for index, cable in enumerate(robot.cables):
        items += _cable(robot, index, cable, colors[cable.winch], 0.0, ())
    for index, cable in enumerate(robot.cables):
        items += _vias(index, cable, colors[cable.winch], (), every=False)
    items += [
        _winch(winch, colors[winch.name], marks[winch.name], chosen=False)
        for winch in robot.winches
        if all(math.dist(winch.at, other.at) > 2 * other.spool_radius for other in own)
    ]
    return [
        replace(item, key="", label="", faint=True) if isinstance(item, Dot) else replace(item, key="", faint=True)
        for item in items
        if isinstance(item, Dot | Strand)
    ]


def _winch(winch: Winch, color: str, mark: str, *, chosen: bool) -> Dot:
    return Dot(
        key=f"winch:{winch.name}",
        at=winch.at,
        look=Look.WINCH,
        color=color,
        label=winch.name,
        short=mark,
        stuck=winch.mount is Mount.BODY,
        chosen=chosen,
    )


def _part_items(robot: Robot) -> list[SceneItem]:
    """Lines on the parts of a body, and borders of the sheets of a flat one."""
    mesh = robot.body.mesh
    sheets = [mesh.nodes[[*loop, loop[0]]] for sheet in robot.sheets for loop in sheet.find_rings(mesh)]
    return [
        Strand(points=tuple(map(tuple, line.tolist())), stroke=Stroke.DRAWN, color=color)
        for color, lines in ((Color.MUTED, find_part_lines(robot.body)), (Color.SHEET, sheets))
        for line in lines
    ]


def _drawing_items(robot: Robot) -> list[SceneItem]:
    """Eyes, a mouth: lines that are drawn on the body, with fewer points where they have very many."""
    marks = robot.body.marks
    step = max(1, sum(map(len, marks)) // DETAIL)
    return [
        Strand(
            points=tuple(map(tuple, [*line[:-1:step].tolist(), line[-1].tolist()])),
            stroke=Stroke.DRAWN,
            color=Color.DARK,
        )
        for line in marks
    ]


def target_items(
    targets: Mapping[str, Point], places: Mapping[str, Point], *, chosen: str = "", color: str = Color.INK
) -> list[SceneItem]:
    """Rings where markers should go [m], keys "target:tip", the chosen one selected, with lines from where they are."""
    items: list[SceneItem] = []
    for name, target in targets.items():
        key = f"target:{name}"
        if name in places:
            items.append(Strand(points=(places[name], target), stroke=Stroke.MISS, color=color, loose=-1))
        items.append(Dot(key=key, at=target, look=Look.TARGET, color=color, stuck=False, chosen=key == chosen))
    return items


def prediction_items(shape: RobotShape) -> list[SceneItem]:
    """Dots where networks expect markers while the body is on its way there."""
    prediction = shape.prediction
    if prediction is None or prediction.exact:
        return []
    return [
        Dot(at=place, look=Look.MARKER, color=PREDICTED, label="predicted", stuck=False)
        for place in prediction.markers.values()
    ]


def _cable(robot: Robot, index: int, cable: Cable, color: str, load: float, chosen: Collection[str]) -> list[SceneItem]:
    """The run of a cable, its sheaths over it."""
    key, loose = f"cable:{index}", int(robot.winch(cable.winch).mount is Mount.WORLD)
    items: list[SceneItem] = [
        Strand(key=key, points=cable.points, stroke=Stroke.CABLE, color=color, loose=loose, load=load,
             chosen=key in chosen)
    ]  # fmt: skip
    for start, end in cable.sheathed:
        hidden = loose if start == 0 else 0
        items.append(Strand(points=cable.points[start : end + 1], stroke=Stroke.SHEATH, color=color, loose=hidden))
    return items


def _vias(index: int, cable: Cable, color: str, chosen: Collection[str], *, every: bool) -> list[SceneItem]:
    """The points of a cable after its winch; the last is its stopper."""
    last = len(cable.points) - 1
    places = range(1, last + 1) if every else [last]
    keys = {place: f"via:{index}:{place}" for place in places}
    return [
        Dot(
            key=keys[place],
            at=cable.points[place],
            look=Look.STOPPER if place == last else Look.VIA,
            color=color,
            chosen=keys[place] in chosen,
        )
        for place in places
    ]


@dataclass(frozen=True, kw_only=True)
class Bar:
    """State of one winch, as a bar."""

    winch: str  # its name
    mark: str  # of it in the kit, as W1
    color: str  # of it
    contraction: float  # cable taken in [m]
    travel: float  # the most it can take in [m]
    release: float  # the most it can let out [m]
    tension: float  # the largest of its cables [N]
    limit: float  # the most that a cable bears [N]


def winch_bars(robot: Robot, shape: RobotShape, limit: float) -> list[Bar]:
    """A bar for each winch: what it does in a shape, beside the most that a cable bears [N]."""
    colors, marks = Color.of_winches(robot.winches), winch_marks_of(robot)
    largest = dict.fromkeys(colors, 0.0)
    for cable, tension in zip(robot.cables, np.asarray(shape.tensions).tolist(), strict=True):
        largest[cable.winch] = max(largest[cable.winch], tension)
    return [
        Bar(
            winch=winch.name,
            mark=marks[winch.name],
            color=colors[winch.name],
            contraction=contraction,
            travel=winch.travel,
            release=winch.release,
            tension=largest[winch.name],
            limit=limit,
        )
        for winch, contraction in zip(robot.winches, np.asarray(shape.contractions).tolist(), strict=True)
    ]


TONES = {Severity.REFUSED: "#c8243f", Severity.LIMIT: "#6d6875", Severity.WARNING: Color.SEAM}  # color of each severity
MAX_LABEL_LETTERS = 64  # letters that are written beside a ring


def diagnostic_items(robot: Robot, said: Iterable[Diagnostic], chosen: Diagnostic | None = None) -> list[SceneItem]:
    """A ring at each place of each finding; its words are seen where it is chosen, or its part under the pointer."""
    loose = {f"winch:{winch.name}" for winch in robot.winches if winch.mount is Mount.WORLD}
    items: list[SceneItem] = []
    most = 24  # rings of one finding: more say no more
    for finding in said:
        words = in_words(finding.text)
        label = (
            words
            if len(words) <= MAX_LABEL_LETTERS
            else words[: MAX_LABEL_LETTERS - 1].rsplit(" ", 1)[0].rstrip(",;:") + " …"
        )
        items += [
            Dot(
                at=place.at,
                look=Look.FLAG,
                color=TONES[finding.severity],
                label=label,
                about=place.part,
                stuck=place.part not in loose,
                chosen=finding == chosen,
            )
            for place in finding.places[:most]
        ]
    return items


@lru_cache(maxsize=8)
def find_part_lines(body: Body) -> tuple[Points, ...]:
    """Closed lines at rest [m]: borders of the parts of a flat body; in space sections through their middles."""
    nodes = body.mesh.nodes
    if body.mesh.dim == 2:
        return tuple(nodes[[*loop, loop[0]]] for loops in body.part_rings for loop in loops)
    lines = list[Points]()
    for facets in find_part_facets(body.mesh, body.element_materials, len(body.parts)):
        corners = nodes[facets]
        for axis, middle in enumerate((corners.min(axis=(0, 1)) + corners.max(axis=(0, 1))) / 2):
            lines += _find_sections(nodes, facets, axis, float(middle))
    return tuple(lines)


def _find_sections(nodes: Points, facets: Int[np.ndarray, "_ 3"], axis: int, place: float) -> list[Points]:
    """Closed lines where a surface meets the plane across an axis at a place [m]."""
    above = nodes[:, axis] > place
    starts, ends = facets, np.roll(facets, -1, axis=1)
    rising, falling = ~above[starts] & above[ends], above[starts] & ~above[ends]
    met = rising.any(axis=1)
    # each facet that is met has one rising and one falling side; its neighbor has the same side the other way round
    sides = np.concatenate([[starts[met][flags[met]], ends[met][flags[met]]] for flags in (rising, falling)], axis=1).T
    edges, numbers = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    heights = nodes[edges][:, :, axis] - place
    shares = (heights[:, 0] / (heights[:, 0] - heights[:, 1]))[:, None]
    points = nodes[edges[:, 0]] + shares * (nodes[edges[:, 1]] - nodes[edges[:, 0]])
    chains = find_rings(numbers.reshape(2, -1).T)
    return [points[[*chain, chain[0]]] for chain in chains]
