"""Panes: a flat body of felt as it is, a body in space as a camera sees it. Figures draw on either alike."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import shapely

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.drawing.camera import Camera, Spots
from hydrostat.drawing.palette import DARK, FELT, FELT_LIGHT, GHOST, GHOST_FILL, MESH, SEAM, STITCH, mix
from hydrostat.drawing.render import Render, render
from hydrostat.plot.drawn_body import DrawnBody
from hydrostat.plot.sheet import BODY, MILLIMETRES, Place, Places, Sheet
from hydrostat.plot.skin import FlatSkin
from hydrostat.robot import Robot

DPI = 200
"""Pixels of an image of a body to an inch."""

MOST_PIXELS = 1.0e6
"""Pixels of a larger image grow, so that no image takes long."""


@dataclass(frozen=True, eq=False)
class FlatPane:
    """A flat body.

    Attributes:
        robot: to draw.
        skin: its boundary.
    """

    robot: Robot
    skin: FlatSkin

    def places(self, points: Points) -> Places:
        """Where points [m] lie on the sheet [mm]."""
        return MILLIMETRES * points

    def named(self, points: Mapping[str, Vector]) -> dict[str, Place]:
        """Where named points [m] lie on the sheet [mm]."""
        return {name: MILLIMETRES * np.asarray(point) for name, point in points.items()}

    def draw_ghost(self, sheet: Sheet) -> None:
        """The rest shape, as a faint shadow."""
        draw_ghost(sheet, self.skin, self.robot.body.mesh.nodes)

    def draw_body(
        self, sheet: Sheet, nodes: Nodes, *, pale: float = 0.0, mesh: bool = False, pins: bool = False
    ) -> DrawnBody:
        """The body with its nodes at `nodes` [m]; `pale` fades it, `mesh` and `pins` add these."""
        rings = [MILLIMETRES * ring for ring in self.skin.shape(nodes)]
        draw_felt(sheet, self.skin, nodes, pale=pale)
        if mesh:
            draw_mesh(sheet, self.robot, nodes)
        if pins:
            draw_pins(sheet, self.robot, rings)
        return DrawnBody(rings)


@dataclass(frozen=True, eq=False)
class SpacePane:
    """A body in space.

    Attributes:
        robot: to draw.
        camera: that sees it.
        shift: what is added to its places on the sheet [mm].
        pixel: side of a pixel of the image of the body [mm]; by the size of the picture if left out.
    """

    robot: Robot
    camera: Camera
    shift: Place
    pixel: float | None = None

    def places(self, points: Points) -> Places:
        """Where points [m] lie on the sheet [mm]."""
        return self.camera.see(MILLIMETRES * points)[:, :2] + self.shift

    def named(self, points: Mapping[str, Vector]) -> dict[str, Place]:
        """Where named points [m] lie on the sheet [mm]."""
        return {name: self.places(np.asarray(point)[None])[0] for name, point in points.items()}

    def draw_ghost(self, sheet: Sheet) -> None:
        """The rest shape, as a faint shadow."""
        mesh = self.robot.body.mesh
        spots = self.camera.see(MILLIMETRES * mesh.nodes)
        image = render(spots, mesh.boundary, pixel=self._pixel(sheet, spots), shaded=False)
        rings = [ring + self.shift for ring in image.rings()]
        sheet.area(rings, facecolor=GHOST_FILL, edgecolor=GHOST, linewidth=0.8, joinstyle="round", zorder=2)

    def draw_body(
        self, sheet: Sheet, nodes: Nodes, *, pale: float = 0.0, mesh: bool = False, pins: bool = False
    ) -> DrawnBody:
        """The body with its nodes at `nodes` [m]; `pale` fades it, `mesh` and `pins` add these."""
        body = self.robot.body.mesh
        spots = self.camera.see(MILLIMETRES * nodes)
        image = render(
            spots, body.boundary, pixel=self._pixel(sheet, spots), up=self.camera.sky, pale=0.6 * pale,
            held=_held(self.robot) if pins else None, lines=_density(self.robot, sheet) if mesh else 0.0,
            point=sheet.scale,
        )  # fmt: skip
        lay_image(sheet, image, self.shift)
        rings = [ring + self.shift for ring in image.rings()]
        seam = mix(SEAM, "#ffffff", 0.6 * pale)
        sheet.area(rings, facecolor="none", edgecolor=seam, linewidth=0.9, joinstyle="round", zorder=3.1)
        thickness = MILLIMETRES * float(np.ptp(body.nodes, axis=0).min())
        return DrawnBody(rings, (self.camera, self.shift, image, thickness))

    def _pixel(self, sheet: Sheet, spots: Spots) -> float:
        """Side of a pixel [mm] of an image of spots [mm]."""
        return self.pixel or fit_pixel(sheet, np.ptp(spots[:, :2], axis=0))


Pane = FlatPane | SpacePane


def fit_pixel(sheet: Sheet, sides: Place, *, dpi: float = DPI) -> float:
    """Side of a pixel [mm] of an image with these sides [mm], so many to an inch unless they would be too many."""
    return max(72 / dpi * sheet.scale, float(np.sqrt(np.prod(sides) / MOST_PIXELS)))


def lay_image(sheet: Sheet, image: Render, shift: Place) -> None:
    """Put the image of a body on a sheet, moved by a shift [mm]."""
    x, y = shift
    left, right, low, high = image.extent
    sheet.axes.imshow(
        image.colours, extent=(left + x, right + x, low + y, high + y), origin="lower", aspect="auto", zorder=3,
        interpolation="antialiased", clip_on=False, label=BODY,
    )  # fmt: skip


def _held(robot: Robot) -> Vector:
    """1 at nodes that a pin holds, 0 elsewhere."""
    nodes = robot.body.mesh.nodes
    held = np.zeros(len(nodes), dtype=bool)
    for pin in robot.pins:
        if pin.box is not None:
            held |= ((nodes >= np.min(pin.box, axis=0)) & (nodes <= np.max(pin.box, axis=0))).all(axis=1)
        else:
            held |= np.linalg.norm(nodes - np.array(pin.at), axis=1) <= pin.radius
    return held.astype(float)


def _density(robot: Robot, sheet: Sheet) -> float:
    """How strongly the edges of the mesh may be drawn: less, the closer together they are."""
    mesh = robot.body.mesh
    sides = np.linalg.norm(np.diff(mesh.nodes[mesh.boundary[:, :2]], axis=1)[:, 0], axis=1)
    return float(np.clip(MILLIMETRES * np.median(sides) / (9 * sheet.scale), 0.0, 1.0))


def draw_felt(sheet: Sheet, skin: FlatSkin, nodes: Nodes, *, pale: float = 0.0) -> None:
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


def draw_ghost(sheet: Sheet, skin: FlatSkin, nodes: Nodes) -> None:
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
