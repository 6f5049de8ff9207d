"""`sheet_pieces`: cloth of the sheets on the skin of a flat body, for a laser cutter."""

import numpy as np
import shapely
from shapely import LineString, MultiLineString, Polygon

from hydrostat.fabrication.patterns.pattern import Pattern, cut_sheet
from hydrostat.fabrication.patterns.skin import silhouette
from hydrostat.robot import Membrane, Robot, SheetSide


def sheet_pieces(robot: Robot, sheet: Membrane) -> Pattern | None:
    """Pieces of a sheet at true scale: that of one face, as seen from the front, and strips of the outline.

    The face is where the region meets the drawn outline, not the border of the elements. None for a body in space.
    """
    if robot.body.mesh.dim == 3:
        return None
    seam = silhouette(robot.body)
    region, gap, rings, floor = _region(sheet, seam), 10.0, [], 0.0
    if sheet.on is not SheetSide.OUTLINE:
        for face in shapely.get_parts(region.intersection(seam)):
            rings += [
                np.array(ring.coords)[:-1] * 1e3
                for part in [face]
                if isinstance(part, Polygon)
                for ring in (part.exterior, *part.interiors)
            ]
    if sheet.on is not SheetSide.FACES:
        floor = min((float(ring[:, 1].min()) for ring in rings), default=0.0)
        left = min((float(ring[:, 0].min()) for ring in rings), default=0.0)
        for length in _rim_lengths(region, seam):
            floor -= 1e3 * (robot.body.thickness or 0.0) + gap
            box = shapely.box(left, floor, left + length, floor + 1e3 * (robot.body.thickness or 0.0))
            rings.append(np.array(box.exterior.coords)[:-1])
    return cut_sheet(f"{robot.name} - {sheet.name}", [tuple(map(tuple, ring.tolist())) for ring in rings])


def _region(sheet: Membrane, seam: Polygon) -> Polygon:
    """Region of a sheet in the plane [m]."""
    if sheet.shape == "polygon":
        return Polygon(sheet.points)
    if sheet.shape == "box":
        (x, y), (u, v) = sheet.at or (0, 0), sheet.to or (0, 0)
        return shapely.box(min(x, u), min(y, v), max(x, u), max(y, v))
    if sheet.shape in ("sphere", "capsule"):
        return LineString([sheet.at or (0, 0), sheet.to or sheet.at or (0, 0)]).buffer(sheet.radius or 0.0)
    return seam.buffer(1e-3)


def _rim_lengths(region: Polygon, seam: Polygon) -> list[float]:
    """Lengths of the pieces of the outline in a region [mm], the longest first."""
    lengths = []
    for ring in (seam.exterior, *seam.interiors):
        within = ring.intersection(region)
        merged = shapely.line_merge(within) if isinstance(within, MultiLineString) else within
        lengths += [1e3 * part.length for part in shapely.get_parts(merged) if part.length > 0]
    return sorted(lengths, reverse=True)
