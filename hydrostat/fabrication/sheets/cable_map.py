"""`flat_map`, `space_map`: the robot with its cables, holes, winches and stoppers, numbered."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float
from hydrostat.drawing import Box, Camera, Canvas, CanvasFrame, Color, LineDrawing, Spot
from hydrostat.fabrication.inserts import InsertKind, find_inserts
from hydrostat.fabrication.patterns.stitches import CableStitches, Side
from hydrostat.fabrication.sheets.map_layout import (
    LabelPlaces,
    Visibility,
    body_solid,
    box_round,
    flat_marks,
    flat_rings,
    pin_ring,
)
from hydrostat.fabrication.winch_marks import winch_marks_of
from hydrostat.given import Point
from hydrostat.robot import Mount, Robot

_MARGIN = 7.0  # room round the body for labels [mm]
HOLE = 0.65  # radius of a drawn hole [mm]


@dataclass(frozen=True, eq=False)
class CableRun:
    """One cable on paper."""

    cable: int  # number, from 1
    spots: list[Spot]  # paper positions of its points, from the winch [mm]
    solid: Sequence[bool]  # True for each segment that runs on the outside, or in front
    sheathed: Sequence[bool]  # True for each segment that runs in a tube
    holes: Sequence[bool]  # True for each point that goes through the skin or is held by it
    twin: int | None = None  # number of the cable behind it, on the other panel

    @property
    def color(self) -> str:
        """Its color on paper: that of no cable near it in number."""
        return Color.WINCHES[(self.cable - 1) % len(Color.WINCHES)]


def flat_map(robot: Robot, stitches: Sequence[CableStitches], *, width: float, height: float) -> Canvas:
    """A flat body from the front, at most so high [mm]; dashed runs inside the cloth. Without stitches it is cast.

    Of pairs those in front are drawn, with the numbers of both: those behind run at the same places.
    """
    rings = [1e3 * ring for ring in flat_rings(robot)]
    places = np.concatenate([*rings, *(1e3 * np.array(cable.points) for cable in robot.cables)])
    box = np.array([places.min(axis=0), places.max(axis=0)])
    canvas = Canvas(width, height := Canvas.fit_height(box, width - 2 * _MARGIN, height - 2 * _MARGIN) + 2 * _MARGIN)
    frame = CanvasFrame.fit(box, (_MARGIN, _MARGIN, width - _MARGIN, height - _MARGIN))
    canvas.fill([frame.way(ring) for ring in rings], grey=0.95)
    canvas.line([frame.way(ring) for ring in rings], width=Canvas.THICK, closed=True)
    canvas.line([frame.way(mark) for mark in flat_marks(robot)], width=Canvas.THIN, grey=0.45)
    labels = LabelPlaces((0.2, 0.2, width - 0.2, height - 0.2))
    for ring in rings:
        labels.take_line(frame.way([*ring, ring[0]]), weight=3)
    _put_inserts(canvas, labels, robot, lambda places: frame.way(places[:, :2]))
    runs = front_runs(robot, stitches, frame)
    _put_runs(canvas, labels, runs, {mark: frame.on(1e3 * np.array(at)) for mark, at in _stands(robot).items()})
    _put_pins(canvas, labels, robot, frame)
    return canvas


def front_runs(robot: Robot, stitches: Sequence[CableStitches], frame: CanvasFrame) -> list[CableRun]:
    """The cables of a flat body as they are seen from the front; of pairs those in front."""
    near = [sewn for sewn in stitches if sewn.panel == stitches[0].panel]
    behind = [sewn.cable for sewn in stitches if sewn.panel != stitches[0].panel]
    twins: Sequence[int | None] = behind or [None] * len(near)
    return [_draw_stitches(robot, sewn, frame, twin) for sewn, twin in zip(near, twins, strict=True)] or [
        _within(robot, index, frame) for index in range(len(robot.cables))
    ]


@dataclass(frozen=True, eq=False)
class SightedBody:
    """A body in space and all that belongs to it, as they are seen."""

    camera: Camera
    drawing: LineDrawing
    sight: Visibility
    cables: list[Float[np.ndarray, "_ 3"]]
    winches: list[Float[np.ndarray, " 3"]]
    box: Float[np.ndarray, "2 2"]


def space_map(robot: Robot, *, width: float, height: float, views: Sequence[Camera]) -> Canvas:
    """A body in space from several places, side by side, at most so high [mm]; dashed is what lies in its far half."""
    pixels = round(Canvas.PIXELS * max(width / len(views), height))
    panes = [pane_of(robot, view, pixels) for view in views]
    breadths = np.array([float(np.ptp(pane.box[:, 0])) for pane in panes])
    rooms = breadths / breadths.sum() * (width - 2 * _MARGIN * len(views))
    inner = max(
        Canvas.fit_height(pane.box, float(room), height - 2 * _MARGIN) for pane, room in zip(panes, rooms, strict=True)
    )
    canvas, left = Canvas(width, inner + 2 * _MARGIN), 0.0
    for pane, room in zip(panes, rooms.tolist(), strict=True):
        _put_pane(canvas, robot, pane, (left, 0.0, left + room + 2 * _MARGIN, canvas.height))
        left += room + 2 * _MARGIN
    return canvas


def pane_of(robot: Robot, camera: Camera, pixels: int) -> SightedBody:
    """A body in space and its cables and winches [mm], as a camera sees them."""
    body = body_solid(robot)
    soft = 0.008  # share of the picture over which the light on a body is blurred
    drawing = LineDrawing.of_solids([body], camera, soft=soft, pixels=pixels)
    cables = [camera.see(1e3 * np.array(cable.points)) for cable in robot.cables]
    winches = [camera.see(1e3 * np.array([winch.at]))[0] for winch in robot.winches]
    places = np.concatenate([drawing.box, *(way[:, :2] for way in cables)])
    box = np.array([places.min(axis=0), places.max(axis=0)])
    return SightedBody(camera, drawing, Visibility.of(body, camera), cables, winches, box)


def _put_pane(canvas: Canvas, robot: Robot, pane: SightedBody, room: Box) -> None:
    left, top, right, bottom = room
    frame = CanvasFrame.fit(pane.box, (left + _MARGIN, top + _MARGIN, right - _MARGIN, bottom - _MARGIN))
    canvas.drawing(pane.drawing, frame)
    labels = LabelPlaces((left + 0.2, top + 0.2, right - 0.2, bottom - 0.2))
    for way in pane.drawing.outlines:
        labels.take_line(frame.way(way), weight=3)
    camera = pane.camera
    _put_inserts(canvas, labels, robot, lambda places: frame.way(camera.see(places)[:, :2]))
    runs = [project_cable(robot, index, way, pane.sight, frame) for index, way in enumerate(pane.cables)]
    stands = {mark: frame.on(stand) for mark, stand in zip(_stands(robot), pane.winches, strict=True)}
    _put_runs(canvas, labels, runs, stands)


def _draw_stitches(robot: Robot, sewn: CableStitches, frame: CanvasFrame, twin: int | None) -> CableRun:
    """A cable that is sewn through cloth."""
    sides = [stitch.after is Side.OUTSIDE for stitch in sewn.stitches[:-1]]
    cable = robot.cables[sewn.cable - 1]
    holes = [stitch.passes for stitch in sewn.stitches]
    return CableRun(sewn.cable, frame.way(1e3 * np.array(cable.points)), sides, (~cable.bare).tolist(), holes, twin)


def _within(robot: Robot, index: int, frame: CanvasFrame) -> CableRun:
    """A cable in the middle of a flat body that is cast."""
    cable = robot.cables[index]
    outside = [True] * (len(cable.points) - 1)
    holes = [robot.winch(cable.winch).mount is Mount.BODY, *outside]
    return CableRun(index + 1, frame.way(1e3 * np.array(cable.points)), outside, (~cable.bare).tolist(), holes)


def project_cable(
    robot: Robot, index: int, way: Float[np.ndarray, "points 3"], sight: Visibility, frame: CanvasFrame
) -> CableRun:
    """Project a cable in space to the page, along its path as seen by a camera [mm]."""
    cable = robot.cables[index]
    solid = sight.in_front((way[:-1] + way[1:]) / 2).tolist()
    holes = [robot.winch(cable.winch).mount is Mount.BODY, *[True] * (len(cable.points) - 1)]
    return CableRun(index + 1, frame.way(way), solid, (~cable.bare).tolist(), holes)


def _stands(robot: Robot) -> dict[str, Point]:
    """Position of each winch [m], by its mark."""
    return {mark: robot.winch(name).at for name, mark in winch_marks_of(robot).items()}


def _put_runs(canvas: Canvas, labels: LabelPlaces, runs: Sequence[CableRun], stands: Mapping[str, Spot]) -> None:
    """Cables, then holes and stoppers on them, then winches, then all words where they fit."""
    for run in runs:
        put_cable(canvas, run)
        labels.take_line(run.spots)
    for run in runs:
        put_holes(canvas, labels, run, HOLE)
    _put_winches(canvas, labels, stands)
    for run in runs:
        words = f"C{run.cable}" if run.twin is None else f"C{run.cable} C{run.twin}"
        middle = labels.beside(run.spots[-1], Canvas.text_size(words, 9.0, bold=True), gap=1.7)
        if middle is not None:
            canvas.text(middle, words, size=9.0, bold=True, halo=True, color=run.color)
    _put_numbers(canvas, labels, runs)


def put_holes(canvas: Canvas, labels: LabelPlaces, run: CableRun, radius: float) -> None:
    """Draw the holes of a cable as discs of a radius [mm], and its stopper, and keep labels off them."""
    for spot, hole in zip(run.spots[:-1], run.holes[:-1], strict=True):
        if hole:
            canvas.disc(spot, radius)
            labels.take_box(box_round(spot, radius))
    put_stopper(canvas, run)
    labels.take_box(box_round(run.spots[-1], 1.4))


def _put_pins(canvas: Canvas, labels: LabelPlaces, robot: Robot, frame: CanvasFrame) -> None:
    """Regions in which a flat body is held, dotted, with a word."""
    for way in (frame.way(pin_ring(pin)) for pin in robot.pins):
        canvas.line([way], width=Canvas.THIN, dash=(0.3, 0.9), closed=True)
        if middle := labels.beside(max(way, key=lambda spot: spot[1]), Canvas.text_size("clamp", 8.0), gap=1.2):
            canvas.text(middle, "clamp", size=8.0, halo=True, grey=0.25)


def _put_inserts(
    canvas: Canvas, labels: LabelPlaces, robot: Robot, project: Callable[[Float[np.ndarray, "_ _"]], list[Spot]]
) -> None:
    """Parts and sheets as grey areas of a flat body, rods as thick grey lines, with their marks where they fit."""
    for rings in robot.body.part_rings:
        ways = [project(1e3 * robot.body.mesh.nodes[ring]) for ring in rings]
        if ways:
            canvas.fill(ways, grey=0.8)
            canvas.line(ways, width=Canvas.THIN, closed=True, grey=0.4)
    for sheet in robot.sheets:
        ways = [project(1e3 * robot.body.mesh.nodes[ring]) for ring in sheet.find_rings(robot.body.mesh)]
        if ways:
            canvas.fill(ways, grey=0.9)
            canvas.line(ways, width=Canvas.THIN, closed=True, grey=0.6)
    inserts = find_inserts(robot)
    ways = [project(np.array(insert.places)) for insert in inserts]
    for insert, way in zip(inserts, ways, strict=True):
        if insert.kind is InsertKind.ROD:
            canvas.line([way], width=1.0, grey=0.55)
            labels.take_line(way)
    for insert, way in zip(inserts, ways, strict=True):
        spot = np.mean(way[:2], axis=0)
        middle = labels.beside((float(spot[0]), float(spot[1])), Canvas.text_size(insert.mark, 8.0), gap=0.3)
        if middle is not None:
            canvas.text(middle, insert.mark, size=8.0, bold=True, halo=True, grey=0.25)


def _put_winches(canvas: Canvas, labels: LabelPlaces, stands: Mapping[str, Spot]) -> None:
    """Mark each winch; a mark on another winch is moved and led to its place by a line."""
    taken: list[Spot] = []
    many = 6  # more winches than this have smaller marks
    size = 9.0 if len(stands) <= many else 7.5
    for letter, stand in stands.items():
        radius, at = Canvas.balloon_radius(letter, size), stand
        if any(np.hypot(*np.subtract(stand, other)) < 2 * radius for other in taken):
            at = labels.beside(stand, (2 * radius, 2 * radius), gap=0.8) or stand
            canvas.line([[stand, at]], width=Canvas.MIDDLE)
            canvas.disc(stand, 0.7, grey=0.0)
        canvas.balloon(at, letter, dark=True, size=size)
        labels.take_box(box_round(at, radius))
        taken.append(at)


def _put_numbers(canvas: Canvas, labels: LabelPlaces, runs: Sequence[CableRun]) -> None:
    """The first and the last number of each cable with its name, led to its hole if need be; others where is room."""
    # The first point is at the winch.
    numbered = [[place for place, hole in enumerate(run.holes[:-1]) if hole and place] for run in runs]
    for run, places in zip(runs, numbered, strict=True):
        for place in dict.fromkeys((*places[:1], *places[-1:])):
            put_number(canvas, labels, run, place, led=True)
    for first in (2, 1):
        for run, places in zip(runs, numbered, strict=True):
            for place in places[1:-1][first - 1 :: 2]:
                put_number(canvas, labels, run, place)


def put_number(
    canvas: Canvas, labels: LabelPlaces, run: CableRun, place: int, *, led: bool = False, words: str = ""
) -> None:
    """Put a number next to its hole, or with `led` and the cable's name further away with a line to it."""
    words = words or (f"C{run.cable}-{place + 1}" if led else str(place + 1))
    size, spot = Canvas.text_size(words, 7.5), run.spots[place]
    middle = labels.beside(spot, size, gap=0.75, most=40 if led else 3, rings=6 if led else 2, led=True)
    if middle is None:
        return
    near = 3.2  # a number further than this from its hole is led to it by a line [mm]
    if np.hypot(*np.subtract(middle, spot)) > near:
        canvas.line([labels.lead(middle, size, spot)], width=0.12, grey=0.35)
    canvas.text(middle, words, size=7.5, halo=led, color=run.color)


def put_cable(canvas: Canvas, run: CableRun) -> None:
    """A cable, dashed where it is behind; double in a tube."""
    for start, end, solid, sheathed in zip(run.spots[:-1], run.spots[1:], run.solid, run.sheathed, strict=True):
        if sheathed:
            canvas.line([[start, end]], width=1.25, color=run.color)
            canvas.line([[start, end]], width=0.8, grey=1.0)
            canvas.line([[start, end]], width=Canvas.THIN, dash=None if solid else (1.0, 0.7), color=run.color)
        else:
            canvas.line([[start, end]], width=Canvas.THICK, dash=None if solid else (1.1, 0.8), color=run.color)


def put_stopper(canvas: Canvas, run: CableRun) -> None:
    """A black bar across the end of a cable."""
    end = np.array(run.spots[-1])
    way = end - np.array(run.spots[-2])
    length = float(np.hypot(*way))
    way = way / length if length > 1e-6 else np.array([1.0, 0.0])
    aside = np.array([-way[1], way[0]])
    corners = [end + 1.35 * a * aside + 0.55 * b * way for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    canvas.fill([[(float(x), float(y)) for x, y in corners]], grey=0.0)
