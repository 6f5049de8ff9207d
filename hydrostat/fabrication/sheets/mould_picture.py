"""`undercut_picture`: the body with what holds in its mould."""

import numpy as np
import shapely
from jaxtyping import Bool, Float, Int

from hydrostat.fabrication.sheets.canvas import MIDDLE, PIXELS, THIN, Canvas, Frame, snug
from hydrostat.fabrication.sheets.line_art import Piece, line_drawing
from hydrostat.fabrication.sheets.view import View

_TURNS = tuple(range(0, 360, 30))
"""Compass directions round the pull that are tried [degrees]."""

_HATCH = 0.8
"""Between the lines of a hatch on paper [mm]."""


def undercut_picture(
    vertices: Float[np.ndarray, "vertices 3"],
    triangles: Int[np.ndarray, "triangles 3"],
    held: Bool[np.ndarray, " triangles"],
    pull: Float[np.ndarray, "3"],
    *,
    width: float,
    height: float,
) -> Canvas:
    """The body with the pull upright, hatched where it holds in its half; seen from where most of that is in sight."""
    piece = Piece(vertices=vertices, triangles=triangles, sharp=70.0)
    drawing = line_drawing([piece], _view(piece, held, pull), soft=0.008, pixels=round(PIXELS * max(width, height)))
    height = snug(drawing.box, width - 1.2, height - 9.6) + 9.6
    canvas = Canvas(width, height)
    frame = Frame.fit(drawing.box, (0.6, 9.0, width - 0.6, height - 0.6))
    canvas.drawing(drawing, frame)
    rings = drawing.rings_of(0, held)
    canvas.line([frame.way(line) for line in _hatch(rings, _HATCH / frame.scale)], width=THIN)
    canvas.line([frame.way(ring) for ring in rings], width=THIN)
    top = frame.on(((drawing.box[0, 0] + drawing.box[1, 0]) / 2, drawing.box[1, 1]))
    canvas.arrow((top[0], top[1] - 1.2), (top[0], max(top[1] - 8.2, 0.4)), width=MIDDLE)
    return canvas


def _view(piece: Piece, held: Bool[np.ndarray, " triangles"], pull: Float[np.ndarray, " 3"]) -> View:
    """From where the area of what holds and faces the eye is largest, with a share for the body's own breadth."""
    one, two, three = (piece.vertices[corner] for corner in piece.triangles.T)
    crosses = np.cross(two - one, three - one) / 2
    views = [View.upright(pull, float(turn), 20.0) for turn in _TURNS]
    facing = np.array([np.maximum(crosses @ view.axes[2], 0.0) for view in views])
    breadth = facing.sum(axis=1)
    caught = facing[:, held].sum(axis=1)
    return views[int(np.argmax(caught / max(float(caught.max()), 1e-9) + breadth / breadth.max()))]


def _hatch(rings: tuple[np.ndarray, ...], gap: float) -> list[np.ndarray]:
    """Lines at 45 degrees within rings, by the even-odd rule."""
    area = shapely.Polygon()
    for ring in rings:
        area = area.symmetric_difference(shapely.make_valid(shapely.Polygon(ring)))
    if area.is_empty:
        return []
    left, low, right, high = area.bounds
    starts = np.arange(left - (high - low), right, gap * np.sqrt(2))
    lines = shapely.multilinestrings([shapely.linestrings([(x, low), (x + high - low, high)]) for x in starts])
    parts = shapely.get_parts(area.intersection(lines))
    return [shapely.get_coordinates(part) for part in parts if isinstance(part, shapely.LineString)]
