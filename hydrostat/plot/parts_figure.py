"""`draw_parts`: the closed shapes of a drawing, with the numbers by which one is chosen."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from shapely import Polygon, maximum_inscribed_circle

from hydrostat.arrays import Float
from hydrostat.drawing import Color
from hydrostat.plot.sheet import WIDTH, new_sheet
from hydrostat.units import MILLIMETERS


def draw_parts(parts: Mapping[int, Float[np.ndarray, "_ 2"]], *, title: str = "", width: float = WIDTH) -> Figure:
    """Draw closed shapes with their numbers, on a millimeter grid.

    Args:
        parts: corners of each shape by its number, (corners, 2) [m].
        title: title; none if empty.
        width: width of the figure [inch].
    """
    rings = {number: MILLIMETERS * np.asarray(ring) for number, ring in parts.items()}
    corners = np.concatenate(list(rings.values()))
    sheet = new_sheet(np.array([corners.min(axis=0), corners.max(axis=0)]), title=title, width=width)
    for number, ring in rings.items():
        sheet.area([ring], facecolor=Color.FELT_LIGHT, edgecolor=Color.SEAM, linewidth=1.0, zorder=5)
        x, y = maximum_inscribed_circle(Polygon(ring).buffer(0)).coords[0]
        sheet.text((x, y), str(number), ha="center", va="center", fontsize=18, color=Color.INK, zorder=8)
    return sheet.figure
