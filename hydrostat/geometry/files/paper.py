"""`leave_table_out`: the sheet of paper in a photograph as its ground, where the table around it is seen too."""

import numpy as np
from shapely import Polygon, get_coordinates

from hydrostat.arrays import Float
from hydrostat.geometry.files.silhouette import Silhouette, fit_ground

_SHARE = 0.3  # of the picture that a sheet covers at least
_MARGIN = 0.02  # of its longer side: at its edge, paper is shaded or curled


def leave_table_out(
    pixels: Float[np.ndarray, "rows columns 3"], found: Silhouette
) -> Float[np.ndarray, "rows columns 3"] | None:
    """Return the picture with the color of the paper in place of all around a sheet; None if the body is no sheet.

    A sheet is pale, large, and bounded by at most seven straight lines: four sides, cut at corners of the picture.
    """
    from PIL import Image, ImageDraw

    shape = Polygon(found.body)
    extent = float(np.ptp(found.body, axis=0).max())
    hull = shape.convex_hull
    corners = len(get_coordinates(hull.simplify(_MARGIN * extent))) - 1
    most_corners, straight = 7, 0.96
    if corners > most_corners or shape.area < max(straight * hull.area, _SHARE * pixels[..., 0].size):
        return None
    sheet = hull.buffer(-_MARGIN * extent)
    canvas = Image.new("1", pixels.shape[1::-1])
    ImageDraw.Draw(canvas).polygon([tuple(place) for place in get_coordinates(sheet)], fill=1)
    inside = np.asarray(canvas, dtype=bool)
    paper, around = np.median(pixels[inside], axis=0), np.median(pixels[~inside], axis=0)
    most_colored = 60.0
    if np.ptp(paper) > most_colored or paper.mean() < around.mean():
        return None
    return np.where(inside[..., None], pixels, fit_ground(pixels, inside, paper)[0])
