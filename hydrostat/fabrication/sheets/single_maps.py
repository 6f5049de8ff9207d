"""`single_maps`: a small map for each cable, with the numbers of all of its holes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float
from hydrostat.drawing import Box, Camera, Canvas, CanvasFrame
from hydrostat.fabrication.patterns.stitches import CableStitches
from hydrostat.fabrication.sheets.cable_map import (
    HOLE,
    CableRun,
    SightedBody,
    front_runs,
    pane_of,
    project_cable,
    put_cable,
    put_holes,
    put_number,
)
from hydrostat.fabrication.sheets.map_layout import LabelPlaces, box_round, flat_marks, flat_rings
from hydrostat.fabrication.winch_marks import winch_marks_of
from hydrostat.robot import Robot

_CELL_HEAD, _CELL_MARGIN = 5.0, 4.0  # room for a title, and round the body [mm]
_PALE = 0.72  # grey of what does not stand out
_SMALL_HOLE = 0.4  # radius of a hole in a body that is cast, where holes are close [mm]


@dataclass(frozen=True, eq=False)
class _Scene:
    """Content of cells: runs in a frame, and the drawing of the body there."""

    box: Float[np.ndarray, "2 2"]
    runs: Callable[[CanvasFrame], list[CableRun]]
    draw: Callable[[Canvas, CanvasFrame], None]
    side: str = ""  # where the viewer stands, for the titles
    hole: float = HOLE  # radius of a drawn hole [mm]


def single_maps(
    robot: Robot, stitches: Sequence[CableStitches], *, width: float, height: float, view: Camera | None = None
) -> list[Canvas]:
    """Return pages of maps with one cable each, the same number on each; none for fewer than three cables.

    One or two columns hold all cables on one page. Pages of three columns have up to four rows, or two for a body in
    space. Its cables are drawn from the side that most of their points are on.

    Args:
        robot: robot with the cables.
        stitches: stitches of a flat body that is sewn.
        width: page width [mm].
        height: maximum page height [mm].
        view: camera of one side of a body in space; None for a flat one.
    """
    fewest = 3  # With fewer cables one map shows them all
    if len(robot.cables) < fewest:
        return []
    scenes = _space_scenes(robot, view) if view is not None else [_flat_scene(robot, stitches)]
    shares = [_shares_in_front(scene) for scene in scenes]
    count, rows = len(shares[0]), 4 if view is None else 2
    sizes = [_fit_cells(scenes, count, columns, rows, (width, height)) for columns in (1, 2, 3)]
    columns, tall, _ = max(sizes, key=lambda size: size[2])
    each = -(-count // -(-count // (columns * max(int(height / tall), 1))))
    pages = []
    for start in range(0, count, each):
        shown = range(start, min(start + each, count))
        canvas = Canvas(width, tall * -(-len(shown) // columns))
        for place, number in enumerate(shown):
            row, column = divmod(place, columns)
            num_in_row = min(columns, len(shown) - row * columns)
            left, room = width * (column + (columns - num_in_row) / 2) / columns, width / columns
            nearest = int(np.argmax([each[number] for each in shares]))
            _put_cell(canvas, robot, scenes[nearest], number, (left, tall * row, left + room, tall * (row + 1)))
        pages.append(canvas)
    return pages


def _shares_in_front(scene: _Scene) -> list[float]:
    """Share of each cable in the near half of the body, without the segment from the winch."""
    runs = scene.runs(CanvasFrame.fit(scene.box, (0.0, 0.0, 1.0, 1.0)))
    return [float(np.mean(run.solid[1:] or run.solid)) for run in runs]


def _fit_cells(
    scenes: Sequence[_Scene], count: int, columns: int, most_rows: int, page: tuple[float, float]
) -> tuple[int, float, float]:
    """Columns, height of a cell [mm], and scale of the drawings; one or two columns hold all cables on a page."""
    width, height = page
    rows = min(-(-count // columns), most_rows) if columns == 3 else -(-count // columns)
    margins = np.array([2 * _CELL_MARGIN, _CELL_HEAD + 2 * _CELL_MARGIN])
    across, up = np.max([np.ptp(scene.box, axis=0) for scene in scenes], axis=0)
    scale = min((width / columns - margins[0]) / across, (height / rows - margins[1]) / up)
    return columns, margins[1] + scale * up, scale


def _flat_scene(robot: Robot, stitches: Sequence[CableStitches]) -> _Scene:
    rings = [1e3 * ring for ring in flat_rings(robot)]
    places = np.concatenate([*rings, *(1e3 * np.array(cable.points) for cable in robot.cables)])

    def draw(canvas: Canvas, frame: CanvasFrame) -> None:
        canvas.line([frame.way(ring) for ring in rings], width=Canvas.THIN, grey=0.35, closed=True)
        canvas.line([frame.way(mark) for mark in flat_marks(robot)], width=Canvas.THIN, grey=_PALE)

    box = np.array([places.min(axis=0), places.max(axis=0)])
    return _Scene(box, lambda frame: front_runs(robot, stitches, frame), draw)


def _space_scenes(robot: Robot, view: Camera) -> list[_Scene]:
    """A body from the side of a camera, and from behind at the same height."""
    eye = view.axes[2]
    behind = Camera.towards(2 * (eye @ view.up) * view.up - eye, up=view.up)
    return [_space_scene(robot, view, "near side"), _space_scene(robot, behind, "far side")]


def _space_scene(robot: Robot, view: Camera, side: str) -> _Scene:
    pane: SightedBody = pane_of(robot, view, 500)

    def runs(frame: CanvasFrame) -> list[CableRun]:
        return [project_cable(robot, index, way, pane.sight, frame) for index, way in enumerate(pane.cables)]

    def draw(canvas: Canvas, frame: CanvasFrame) -> None:
        canvas.line([frame.way(way) for way in pane.drawing.outlines], width=Canvas.THIN, grey=0.35)

    return _Scene(pane.box, runs, draw, side, _SMALL_HOLE)


def _put_cell(canvas: Canvas, robot: Robot, scene: _Scene, number: int, cell: Box) -> None:
    left, top, right, bottom = cell
    frame = CanvasFrame.fit(
        scene.box, (left + _CELL_MARGIN, top + _CELL_HEAD + _CELL_MARGIN, right - _CELL_MARGIN, bottom - _CELL_MARGIN)
    )
    runs = scene.runs(frame)
    own = runs[number]
    scene.draw(canvas, frame)
    for run in runs:
        if run is not own:
            canvas.line([run.spots], width=Canvas.THIN, grey=_PALE)
    labels = LabelPlaces((left + 0.2, top + _CELL_HEAD, right - 0.2, bottom - 0.2))
    mark = winch_marks_of(robot)[robot.cables[own.cable - 1].winch]
    _put_run(canvas, labels, own, mark, scene.hole)
    twin = "" if own.twin is None else f", and C{own.twin} behind it"
    words = f"C{own.cable} from {mark}{twin}" + (scene.side and f", {scene.side}")
    canvas.text((left + 1.0, top + 2.6), words, size=9.0, anchor="start", bold=True, color=own.color)


def _put_run(canvas: Canvas, labels: LabelPlaces, run: CableRun, mark: str, radius: float) -> None:
    """One cable alone, with its winch and the numbers of all of its holes."""
    put_cable(canvas, run)
    labels.take_line(run.spots)
    put_holes(canvas, labels, run, radius)
    canvas.balloon(run.spots[0], mark, dark=True, size=7.5)
    labels.take_box(box_round(run.spots[0], Canvas.balloon_radius(mark, 7.5)))
    for place, hole in enumerate(run.holes[:-1]):
        if hole and place:
            put_number(canvas, labels, run, place, led=True, words=str(place + 1))
