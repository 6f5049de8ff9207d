"""The soft body: felt with a stitched seam, the ghost of its rest shape, its mesh and its pins."""

import numpy as np
import shapely

from hydrostat.arrays import Nodes
from hydrostat.drawing.palette import DARK, FELT, FELT_LIGHT, GHOST, GHOST_FILL, MESH, SEAM, STITCH, mix
from hydrostat.plot.places import Places
from hydrostat.plot.sheet import MILLIMETRES, Sheet
from hydrostat.plot.skin import Skin
from hydrostat.robot import Robot


def draw_felt(sheet: Sheet, skin: Skin, nodes: Nodes, *, pale: float = 0.0) -> None:
    """The body in a pose, its nodes at `nodes` [m]; `pale` (0 to 1) fades it behind what lies on it."""
    fill, light, seam = (mix(colour, "#ffffff", pale) for colour in (FELT, FELT_LIGHT, SEAM))
    rings = [MILLIMETRES * ring for ring in skin.shape(nodes)]
    sheet.area(rings, facecolor=fill, edgecolor=seam, linewidth=1.3, joinstyle="round", zorder=3)
    seams = [MILLIMETRES * ring for ring in skin.seam(nodes)]
    if seams:
        sheet.area(seams, facecolor=light, edgecolor="none", zorder=3.1)
    for ring in seams:
        closed = np.concatenate([ring, ring[:1]])
        sheet.curve(closed, color=STITCH, linewidth=1.2, linestyle=(0, (2.4, 2.0)), dash_capstyle="butt", zorder=3.2)


def draw_ghost(sheet: Sheet, skin: Skin, nodes: Nodes) -> None:
    """The rest shape, as a faint grey shadow behind a pose."""
    rings = [MILLIMETRES * ring for ring in skin.shape(nodes)]
    sheet.area(rings, facecolor=GHOST_FILL, edgecolor=GHOST, linewidth=0.8, joinstyle="round", zorder=2)


def draw_mesh(sheet: Sheet, robot: Robot, nodes: Nodes) -> None:
    """All edges of the mesh, faint."""
    ends = MILLIMETRES * nodes[robot.body.mesh.edges]
    sheet.segments(ends, color=MESH, linewidth=0.35, alpha=0.42, zorder=4)


def draw_pins(sheet: Sheet, robot: Robot, rings: list[Places]) -> None:
    """What holds the robot: a hatched field for each pin, cut along the body's rings [mm]."""
    body = shapely.Polygon(rings[0], rings[1:]).buffer(0)
    for pin in robot.pins:
        if pin.box is not None:
            field = shapely.box(*MILLIMETRES * np.min(pin.box, axis=0), *MILLIMETRES * np.max(pin.box, axis=0))
        else:
            radius = max(MILLIMETRES * pin.radius, 4 * sheet.scale)
            field = shapely.Point(MILLIMETRES * np.array(pin.at)).buffer(radius, quad_segs=24)
        for part in shapely.get_parts(field.intersection(body)):
            if isinstance(part, shapely.Polygon):
                _hatch(sheet, part)


def _hatch(sheet: Sheet, field: shapely.Polygon) -> None:
    low, high = np.array(field.bounds).reshape(2, 2)
    tall = high[1] - low[1]
    starts = np.arange(low[0] - tall, high[0], 4.2 * sheet.scale)
    strokes = [[(start, low[1]), (start + tall, high[1])] for start in starts]
    cut = shapely.get_parts(shapely.intersection(shapely.linestrings(strokes), field))
    ends = [np.array(line.coords)[[0, -1]] for line in cut if line.geom_type == "LineString" and line.length > 0]
    sheet.segments(np.array(ends), color=DARK, linewidth=0.6, alpha=0.5, zorder=5)
    for ring in (field.exterior, *field.interiors):
        sheet.curve(np.array(ring.coords), color=DARK, linewidth=0.7, alpha=0.55, zorder=5)
