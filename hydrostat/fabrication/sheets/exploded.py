"""`exploded_picture`: an assembly drawn apart along its axes, its pieces numbered."""

from collections.abc import Mapping, Sequence

import numpy as np

from hydrostat.fabrication.sheets.canvas import PIXELS, THIN, Box, Canvas, Frame, Spot, balloon_radius, snug
from hydrostat.fabrication.sheets.line_art import LineDrawing, Piece, line_drawing
from hydrostat.fabrication.sheets.view import View
from hydrostat.fabrication.solids.assembly import Assembly, Placed

_SIDE = 9.0
"""Room for balloons to the left and right of the drawing [mm]."""


def exploded_picture(
    assembly: Assembly, numbers: Mapping[str, int], *, width: float, height: float, view: View | None = None
) -> Canvas:
    """Pieces drawn away from each other, a dashed line on the way of each, and a number in a circle beside it.

    Args:
        assembly: what is drawn.
        numbers: of the pieces, by name; pieces without one get no circle, several of one number a single one.
        width: of the picture [mm].
        height: of the picture at most [mm]; it is no higher than what is drawn.
        view: from where; isometric if left out.
    """
    pieces = [Piece.of(placed.solid, shift=placed.pulled) for placed in assembly.pieces]
    drawing = line_drawing(pieces, view or View.isometric(), pixels=round(PIXELS * max(width, height)))
    side = _SIDE if numbers else 0.6
    height = snug(drawing.box, width - 2 * side, height - 1.2) + 1.2
    canvas = Canvas(width, height)
    frame = Frame.fit(drawing.box, (side, 0.6, width - side, height - 0.6))
    canvas.drawing(drawing, frame)
    for placed in assembly.pieces:
        _axis(canvas, drawing, frame, placed)
    targets: dict[str, Spot] = {}
    for index, placed in enumerate(assembly.pieces):
        spot = drawing.spot_on(index) if placed.name in numbers else None
        if spot is not None:
            targets.setdefault(str(numbers[placed.name]), frame.on(spot))
    put_balloons(canvas, list(targets.items()), (0.0, 0.0, width, height))
    return canvas


def _axis(canvas: Canvas, drawing: LineDrawing, frame: Frame, placed: Placed) -> None:
    """The dashed way on which a piece is put in its place, as far as it is seen."""
    pulled = np.array(placed.pulled)
    if not pulled.any():
        return
    box = np.array(placed.solid.bounding_box(), dtype=float).reshape(2, 3)
    middle = box.mean(axis=0)
    seen = drawing.seen_of(np.linspace(middle, middle + pulled, 2))
    canvas.line([frame.way(way) for way in seen], width=THIN, dash=(1.6, 0.8))


def put_balloons(canvas: Canvas, targets: Sequence[tuple[str, Spot]], room: Box) -> None:
    """Numbers in circles, at the left and the right of a room, each led to its spot by a thin line."""
    left, top, right, bottom = room
    ordered = sorted(targets, key=lambda target: (target[1][0], target[1][1]))
    half = (len(ordered) + 1) // 2
    for side, chosen in ((left, ordered[:half]), (right, ordered[half:])):
        column = sorted(chosen, key=lambda target: target[1][1])
        radii = [balloon_radius(words) for words, _ in column]
        step = 2 * max(radii, default=0.0) + 1.0
        heights = spread([spot[1] for _, spot in column], step, top + step / 2, bottom - step / 2)
        for (words, spot), radius, height in zip(column, radii, heights, strict=True):
            inward = 1.0 if side == left else -1.0
            at = (side + inward * (radius + 0.3), height)
            canvas.line([[(at[0] + inward * radius, height), spot]], width=THIN)
            canvas.disc(spot, 0.45, grey=0.0, edge=0.0)
            canvas.balloon(at, words)


def spread(wished: Sequence[float], step: float, low: float, high: float) -> list[float]:
    """Rising numbers near those wished for, a step apart, from `low` to `high` if there is room for so many."""
    places = list(wished)
    for index in range(1, len(places)):
        places[index] = max(places[index], places[index - 1] + step)
    if places and places[-1] > high:
        places[-1] = high
    for index in range(len(places) - 2, -1, -1):
        places[index] = min(places[index], places[index + 1] - step)
    if places and places[0] < low:
        places[0] = low
        for index in range(1, len(places)):
            places[index] = max(places[index], places[index - 1] + step)
    return places
