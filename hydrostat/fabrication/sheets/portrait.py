"""`portrait`: a small picture of a robot for the head of its sheet."""

import contourpy
import numpy as np
import shapely
from scipy.ndimage import distance_transform_edt, gaussian_filter

from hydrostat.fabrication.sheets.cable_map import body_piece, flat_rings
from hydrostat.fabrication.sheets.canvas import MIDDLE, PIXELS, THIN, Canvas, Frame
from hydrostat.fabrication.sheets.line_art import line_drawing
from hydrostat.fabrication.sheets.view import View
from hydrostat.robot import Robot

_PIXELS = 300
"""Along the longer side of a flat body."""

_SHADES = ((0.60, 0.93), (0.42, 0.84))
"""Below which light a puffed body is grey, and how bright that grey is."""


def portrait(robot: Robot, view: View | None, *, width: float, height: float) -> Canvas:
    """The body as it will be: a flat one stuffed, one in space as it is seen from somewhere."""
    canvas = Canvas(width, height)
    room = (0.6, 0.6, width - 0.6, height - 0.6)
    if view is not None:
        drawing = line_drawing([body_piece(robot)], view, soft=0.01, pixels=round(PIXELS * max(width, height)))
        canvas.drawing(drawing, Frame.fit(drawing.box, room))
        return canvas
    rings = [1e3 * ring for ring in flat_rings(robot)]
    box = np.array([rings[0].min(axis=0), rings[0].max(axis=0)])
    frame = Frame.fit(box, room)
    for grey, shade in _puffed(rings, box, 500 * (robot.body.thickness or 0.04)):
        canvas.fill([frame.way(ring) for ring in shade], grey=grey)
    canvas.line([frame.way(ring) for ring in rings], width=MIDDLE, closed=True)
    seam = shapely.Polygon(rings[0], rings[1:]).buffer(-1.1 / frame.scale)
    lines = [np.array(part.exterior.coords) for part in shapely.get_parts(seam) if not part.is_empty]
    canvas.line([frame.way(line) for line in lines], width=THIN, dash=(0.9, 0.7), grey=0.35)
    return canvas


def _puffed(rings: list[np.ndarray], box: np.ndarray, radius: float) -> list[tuple[float, list[np.ndarray]]]:
    """Rings round the darker sides of a stuffed body: its section is a half circle of a radius [mm] at the rim."""
    pixel = float((box[1] - box[0]).max()) / _PIXELS
    low = box[0] - 4 * pixel
    columns, rows = (np.ceil((box[1] - low) / pixel).astype(int) + 5).tolist()
    x, y = np.meshgrid(low[0] + pixel * np.arange(columns), low[1] + pixel * np.arange(rows))
    inside = shapely.contains_xy(shapely.Polygon(rings[0], rings[1:]), x, y)
    depth = np.minimum(pixel * np.asarray(distance_transform_edt(inside)) / radius, 1.0)
    high = gaussian_filter(radius * np.sqrt(depth * (2 - depth)), 2.5)
    slope_y, slope_x = np.gradient(high, pixel)
    normal = np.stack([-slope_x, -slope_y, np.ones_like(high)]) / np.sqrt(1 + slope_x**2 + slope_y**2)
    light = gaussian_filter(np.einsum("k,kij->ij", np.array([-0.40, 0.70, 0.59]), normal), 2.0)
    dark = np.where(inside, 1 - light, 0.0)
    shades = []
    for level, grey in _SHADES:
        generator = contourpy.contour_generator(z=dark, line_type=contourpy.LineType.Separate)
        shapes = [shapely.simplify(shapely.linestrings(np.asarray(ring)), 0.4) for ring in generator.lines(1 - level)]
        shades.append((grey, [low + pixel * shapely.get_coordinates(shape) for shape in shapes]))
    return shades
