"""Pictures of solids on a sheet: an assembly drawn apart, a body with what holds in its mold, a robot in small."""

from collections.abc import Mapping, Sequence

import numpy as np
import shapely
from manifold3d import Manifold
from scipy.ndimage import distance_transform_edt, gaussian_filter

from hydrostat.arrays import Bool, Float, Int
from hydrostat.drawing import Box, Camera, Canvas, CanvasFrame, DrawnSolid, LineDrawing, Polyline, Spot, level_rings
from hydrostat.fabrication.sheets.map_layout import body_solid, flat_marks, flat_rings
from hydrostat.fabrication.solids.assembly import PartAssembly, Placed
from hydrostat.fabrication.solids.printed import triangles_of
from hydrostat.robot import Robot

_SIDE = 9.0  # room for balloons to the left and right of the drawing [mm]


def drawn_solid(solid: Manifold, *, shift: Sequence[float] = (0.0, 0.0, 0.0)) -> DrawnSolid:
    """A solid as it is drawn, moved by a shift [mm]."""
    vertices, triangles = triangles_of(solid)
    return DrawnSolid(vertices=vertices + np.array(shift, dtype=float), triangles=triangles)


def exploded_picture(
    assembly: PartAssembly, numbers: Mapping[str, int], *, width: float, height: float, view: Camera | None = None
) -> Canvas:
    """Pieces drawn away from each other, a dashed line on the path of each, and a number in a circle next to it.

    Numbers go by name: pieces without one get no circle, several of one number a single one. The picture is so wide and
    at most so high [mm]; the view is isometric if left out.
    """
    solids = [drawn_solid(placed.solid, shift=placed.pulled) for placed in assembly.pieces]
    drawing = LineDrawing.of_solids(
        solids, view or Camera.isometric(), pixels=round(Canvas.PIXELS * max(width, height))
    )
    side = _SIDE if numbers else 0.6
    height = Canvas.fit_height(drawing.box, width - 2 * side, height - 1.2) + 1.2
    canvas = Canvas(width, height)
    frame = CanvasFrame.fit(drawing.box, (side, 0.6, width - side, height - 0.6))
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


def _axis(canvas: Canvas, drawing: LineDrawing, frame: CanvasFrame, placed: Placed) -> None:
    """The dashed way on which a piece is put in its place, as far as it is seen."""
    pulled = np.array(placed.pulled)
    if not pulled.any():
        return
    box = np.array(placed.solid.bounding_box(), dtype=float).reshape(2, 3)
    middle = box.mean(axis=0)
    seen = drawing.seen_of(np.linspace(middle, middle + pulled, 2))
    canvas.line([frame.way(way) for way in seen], width=Canvas.THIN, dash=(1.6, 0.8))


def put_balloons(canvas: Canvas, targets: Sequence[tuple[str, Spot]], room: Box) -> None:
    """Numbers in circles, at the left and the right of a room, each led to its spot by a thin line."""
    left, top, right, bottom = room
    ordered = sorted(targets, key=lambda target: (target[1][0], target[1][1]))
    half = (len(ordered) + 1) // 2
    for side, chosen in ((left, ordered[:half]), (right, ordered[half:])):
        column = sorted(chosen, key=lambda target: target[1][1])
        radii = [Canvas.balloon_radius(words) for words, _ in column]
        step = 2 * max(radii, default=0.0) + 1.0
        heights = spread_heights([spot[1] for _, spot in column], step, top + step / 2, bottom - step / 2)
        for (words, spot), radius, height in zip(column, radii, heights, strict=True):
            inward = 1.0 if side == left else -1.0
            at = (side + inward * (radius + 0.3), height)
            canvas.line([[(at[0] + inward * radius, height), spot]], width=Canvas.THIN)
            canvas.disc(spot, 0.45, grey=0.0, edge=0.0)
            canvas.balloon(at, words)


def spread_heights(wished: Sequence[float], step: float, low: float, high: float) -> list[float]:
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


_TURNS = tuple(range(0, 360, 30))  # compass directions round the pull that are tried [degrees]


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
    body = DrawnSolid(vertices=vertices, triangles=triangles, sharp=70.0)
    drawing = LineDrawing.of_solids(
        [body], _view(body, held, pull), soft=0.008, pixels=round(Canvas.PIXELS * max(width, height))
    )
    height = Canvas.fit_height(drawing.box, width - 1.2, height - 9.6) + 9.6
    canvas = Canvas(width, height)
    frame = CanvasFrame.fit(drawing.box, (0.6, 9.0, width - 0.6, height - 0.6))
    canvas.drawing(drawing, frame)
    rings = drawing.rings_of(0, held)
    hatch = 0.8  # between the lines of a hatch on paper [mm]
    canvas.line([frame.way(line) for line in _hatch(rings, hatch / frame.scale)], width=Canvas.THIN)
    canvas.line([frame.way(ring) for ring in rings], width=Canvas.THIN)
    top = frame.on(((drawing.box[0, 0] + drawing.box[1, 0]) / 2, drawing.box[1, 1]))
    canvas.arrow((top[0], top[1] - 1.2), (top[0], max(top[1] - 8.2, 0.4)), width=Canvas.MIDDLE)
    return canvas


def _view(body: DrawnSolid, held: Bool[np.ndarray, " triangles"], pull: Float[np.ndarray, " 3"]) -> Camera:
    """Find the view in which most of what holds faces the eye, with a share for the body's own breadth."""
    one, two, three = (body.vertices[corner] for corner in body.triangles.T)
    crosses = np.cross(two - one, three - one) / 2
    views = [Camera.at(float(turn), 20.0, up=pull) for turn in _TURNS]
    facing = np.array([np.maximum(crosses @ view.axes[2], 0.0) for view in views])
    breadth = facing.sum(axis=1)
    caught = facing[:, held].sum(axis=1)
    return views[int(np.argmax(caught / max(float(caught.max()), 1e-9) + breadth / breadth.max()))]


def _hatch(rings: list[Polyline], gap: float) -> list[np.ndarray]:
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


_SHADES = ((0.60, 0.93), (0.42, 0.84))  # below which light a puffed body is grey, and how bright that grey is


def portrait(robot: Robot, view: Camera | None, *, width: float, height: float) -> Canvas:
    """The body as it will be: a flat one stuffed, one in space as it is seen from somewhere."""
    canvas = Canvas(width, height)
    room = (0.6, 0.6, width - 0.6, height - 0.6)
    if view is not None:
        drawing = LineDrawing.of_solids(
            [body_solid(robot)], view, soft=0.01, pixels=round(Canvas.PIXELS * max(width, height))
        )
        canvas.drawing(drawing, CanvasFrame.fit(drawing.box, room))
        return canvas
    rings = [1e3 * ring for ring in flat_rings(robot)]
    box = np.array([rings[0].min(axis=0), rings[0].max(axis=0)])
    frame = CanvasFrame.fit(box, room)
    for grey, shade in _puff_rings(rings, box, 500 * (robot.body.thickness or 0.04)):
        canvas.fill([frame.way(ring) for ring in shade], grey=grey)
    canvas.line([frame.way(ring) for ring in rings], width=Canvas.MIDDLE, closed=True)
    canvas.line([frame.way(mark) for mark in flat_marks(robot)], width=Canvas.THIN)
    seam = shapely.Polygon(rings[0], rings[1:]).buffer(-1.1 / frame.scale)
    lines = [np.array(part.exterior.coords) for part in shapely.get_parts(seam) if not part.is_empty]
    canvas.line([frame.way(line) for line in lines], width=Canvas.THIN, dash=(0.9, 0.7), grey=0.35)
    return canvas


def _puff_rings(rings: list[np.ndarray], box: np.ndarray, radius: float) -> list[tuple[float, list[np.ndarray]]]:
    """Rings round the darker sides of a stuffed body: its section is a half circle of a radius [mm] at the rim."""
    pixels = 300  # along the longer side of a flat body
    pixel = float((box[1] - box[0]).max()) / pixels
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
        rings = level_rings(dark, 1 - level, tolerance=0.4)
        shades.append((grey, [low + pixel * ring for ring in rings]))
    return shades
