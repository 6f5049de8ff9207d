"""`single_maps`: a small map for each cable, on which it is the only one that stands out, with all of its numbers."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hydrostat.drawing import THIN, Box, Camera, Canvas, CanvasFrame, fit_height
from hydrostat.fabrication.patterns.stitches import CableStitches
from hydrostat.fabrication.sheets.cable_map import (
    CableRun,
    SightedBody,
    flat_marks,
    flat_rings,
    front_runs,
    pane_of,
    put_run,
    sighted,
)
from hydrostat.fabrication.sheets.label_places import LabelPlaces
from hydrostat.fabrication.winch_marks import winch_marks_of
from hydrostat.robot import Robot

FEWEST = 3
"""With fewer cables one map shows them all."""

_COLUMNS, _ROWS = 3, 4  # of a page
_HEAD, _MARGIN = 5.0, 4.0  # room for a title, and round the body [mm]
_PALE = 0.72  # grey of what does not stand out


@dataclass(frozen=True, eq=False)
class _Scene:
    """What all cells show: runs in a frame, and how the body is drawn there."""

    box: Float[np.ndarray, "2 2"]
    runs: Callable[[CanvasFrame], list[CableRun]]
    draw: Callable[[Canvas, CanvasFrame], None]


def single_maps(
    robot: Robot, stitches: Sequence[CableStitches], *, width: float, height: float, view: Camera | None = None
) -> list[Canvas]:
    """Pages of at most twelve small maps, each of such a size [mm]; none of fewer than three cables.

    Args:
        robot: whose cables they show.
        stitches: of a flat body that is sewn.
        width: of a page.
        height: of a page, at most.
        view: of a body in space; None for a flat one.
    """
    if len(robot.cables) < FEWEST:
        return []
    scene = _flat_scene(robot, stitches) if view is None else _space_scene(robot, view)
    room = width / _COLUMNS
    tall = min(height / _ROWS, _HEAD + 2 * _MARGIN + fit_height(scene.box, room - 2 * _MARGIN, 1e3))
    count = len(scene.runs(CanvasFrame.fit(scene.box, (0.0, 0.0, 1.0, 1.0))))
    each = _COLUMNS * max(int(height / tall), 1)
    pages = []
    for start in range(0, count, each):
        shown = range(start, min(start + each, count))
        canvas = Canvas(width, tall * -(-len(shown) // _COLUMNS))
        for place, number in enumerate(shown):
            left, top = room * (place % _COLUMNS), tall * (place // _COLUMNS)
            _put_cell(canvas, robot, scene, number, (left, top, left + room, top + tall))
        pages.append(canvas)
    return pages


def _flat_scene(robot: Robot, stitches: Sequence[CableStitches]) -> _Scene:
    rings = [1e3 * ring for ring in flat_rings(robot)]
    places = np.concatenate([*rings, *(1e3 * np.array(cable.points) for cable in robot.cables)])

    def draw(canvas: Canvas, frame: CanvasFrame) -> None:
        canvas.line([frame.way(ring) for ring in rings], width=THIN, grey=0.35, closed=True)
        canvas.line([frame.way(mark) for mark in flat_marks(robot)], width=THIN, grey=_PALE)

    box = np.array([places.min(axis=0), places.max(axis=0)])
    return _Scene(box, lambda frame: front_runs(robot, stitches, frame), draw)


def _space_scene(robot: Robot, view: Camera) -> _Scene:
    pane: SightedBody = pane_of(robot, view, 500)

    def runs(frame: CanvasFrame) -> list[CableRun]:
        return [sighted(robot, index, way, pane.sight, frame) for index, way in enumerate(pane.cables)]

    def draw(canvas: Canvas, frame: CanvasFrame) -> None:
        canvas.line([frame.way(way) for way in pane.drawing.outlines], width=THIN, grey=0.35, closed=True)

    return _Scene(pane.box, runs, draw)


def _put_cell(canvas: Canvas, robot: Robot, scene: _Scene, number: int, cell: Box) -> None:
    left, top, right, bottom = cell
    frame = CanvasFrame.fit(scene.box, (left + _MARGIN, top + _HEAD + _MARGIN, right - _MARGIN, bottom - _MARGIN))
    runs = scene.runs(frame)
    own = runs[number]
    scene.draw(canvas, frame)
    for run in runs:
        if run is not own:
            canvas.line([run.spots], width=THIN, grey=_PALE)
    labels = LabelPlaces((left + 0.2, top + _HEAD, right - 0.2, bottom - 0.2))
    cable = robot.cables[own.cable - 1]
    put_run(canvas, labels, own, winch_marks_of(robot)[cable.winch])
    twin = "" if own.twin is None else f", and C{own.twin} behind it"
    words = f"C{own.cable} from {winch_marks_of(robot)[cable.winch]}{twin}"
    canvas.text((left + 1.0, top + 2.6), words, size=9.0, anchor="start", bold=True, colour=own.colour)
