"""Panes: a flat body of felt as it is, a body in space as a camera sees it. Figures draw on either alike."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from hydrostat.arrays import Int, Nodes, Points, Vector
from hydrostat.drawing import Camera, Color, Render, Spots, render
from hydrostat.plot.drawn_body import DrawnBody
from hydrostat.plot.sheet import BODY, PictureSheet, Place, Places
from hydrostat.plot.skin import FlatSkin
from hydrostat.robot import Obstacle, ObstacleShape, Robot, find_part_facets, rims
from hydrostat.units import MILLIMETERS

Surface = tuple[Points, Int[np.ndarray, "triangles 3"]]  # places of its corners [m], and triangles seen from outside


def object_surface(obstacle: Obstacle) -> Surface:
    """The surface of an object that has an end: its own if it is a mesh, else a hull of points."""
    from scipy.spatial import ConvexHull

    if obstacle.mesh is not None:
        return np.array(obstacle.at) + obstacle.mesh.surface.vertices, obstacle.mesh.surface.triangles
    points = _points(obstacle)
    triangles = ConvexHull(points).simplices
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = (normals * (corners[:, 0] - points.mean(axis=0))).sum(axis=1) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return points, triangles


def _points(obstacle: Obstacle) -> Points:
    """Points all over it [m]."""
    at, to, radius = np.array(obstacle.at), np.array(obstacle.to or obstacle.at), obstacle.radius or 0.0
    if obstacle.shape is ObstacleShape.BOX:
        return at + np.array(list(np.ndindex(2, 2, 2))) * (to - at)
    if obstacle.shape is ObstacleShape.CYLINDER:
        axes, turns = obstacle.frame()[1], np.linspace(0.0, 2 * np.pi, 48, endpoint=False)
        ring = radius * (np.outer(np.cos(turns), axes[1]) + np.outer(np.sin(turns), axes[2]))
        return np.concatenate([at + ring, to + ring])
    dots = 800  # Points on a sphere
    heights = np.linspace(-1.0, 1.0, dots)
    turns = np.pi * (3 - np.sqrt(5)) * np.arange(dots)  # a spiral by the golden angle covers a sphere evenly
    flat = np.sqrt(1 - heights**2)
    ball = radius * np.column_stack([flat * np.cos(turns), flat * np.sin(turns), heights])
    return at + ball if obstacle.to is None else np.concatenate([at + ball, to + ball])


DPI = 200  # pixels of an image of a body to an inch


@dataclass(frozen=True, eq=False)
class Pane(ABC):
    """A view of a robot on a sheet."""

    robot: Robot  # to draw

    @abstractmethod
    def places(self, points: Points) -> Places:
        """Places on the sheet [mm] of points [m]."""

    @abstractmethod
    def outline(self, sheet: PictureSheet, nodes: Nodes) -> list[Places]:
        """Rings around the body with its nodes at `nodes` [m], on the sheet [mm]; the outer one first."""

    @abstractmethod
    def draw_body(
        self,
        sheet: PictureSheet,
        nodes: Nodes,
        *,
        pale: float = 0.0,
        mesh: bool = False,
        pins: bool = False,
        obstacles: Sequence[Obstacle] = (),
    ) -> DrawnBody:
        """Draw the body with its nodes at `nodes` [m]; `pale`, 0 to 1, fades it, `mesh` and `pins` add these.

        Things that have an end are drawn with it: their rims, and in space hatched solids.
        """

    def _with_rims(self, sheet: PictureSheet, body: DrawnBody, obstacles: Sequence[Obstacle]) -> DrawnBody:
        """Draw the rims of obstacles where the body does not cover them; returns the body."""
        for line in (line for obstacle in obstacles for line in rims(obstacle, self.robot)):
            for part, fade in body.cable(line).parts:
                if fade == 0:
                    sheet.curve(part, color=Color.INK, linewidth=1.2, clip_on=True, zorder=3.3)
        return body

    def locate_points(self, points: Mapping[str, Vector]) -> dict[str, Place]:
        """Places on the sheet [mm] of named points [m]."""
        return {name: self.places(np.asarray(point)[None])[0] for name, point in points.items()}

    def draw_ghost(self, sheet: PictureSheet) -> None:
        """Draw the rest shape, as a faint shadow."""
        rings = self.outline(sheet, self.robot.body.mesh.nodes)
        sheet.area(rings, facecolor=Color.GHOST_FILL, edgecolor=Color.GHOST, linewidth=0.8, joinstyle="round", zorder=2)


@dataclass(frozen=True, eq=False)
class FlatPane(Pane):
    """A flat body of felt with a stitched seam."""

    skin: FlatSkin  # its boundary

    def places(self, points: Points) -> Places:
        return MILLIMETERS * points

    def outline(self, sheet: PictureSheet, nodes: Nodes) -> list[Places]:
        return [MILLIMETERS * ring for ring in self.skin.shape(nodes)]

    def draw_body(
        self,
        sheet: PictureSheet,
        nodes: Nodes,
        *,
        pale: float = 0.0,
        mesh: bool = False,
        pins: bool = False,
        obstacles: Sequence[Obstacle] = (),
    ) -> DrawnBody:
        fill, light, seam = (
            Color.mix(color, Color.PAPER, pale) for color in (Color.FELT, Color.FELT_LIGHT, Color.SEAM)
        )
        rings, seams = self.outline(sheet, nodes), [MILLIMETERS * ring for ring in self.skin.seam(nodes)]
        sheet.area(rings, facecolor=fill, edgecolor=seam, linewidth=1.3, joinstyle="round", zorder=3)
        if seams:
            sheet.area(seams, facecolor=light, edgecolor="none", zorder=3.1)
        stitches = {"linewidth": 1.2, "linestyle": (0, (2.4, 2.0)), "dash_capstyle": "butt"}
        for ring in seams:
            sheet.curve(np.concatenate([ring, ring[:1]]), color=Color.STITCH, zorder=3.2, **stitches)
        for part, loops in zip(self.robot.body.parts, self.robot.body.part_rings, strict=True):
            color = Color.mix(Color.mix(Color.INK, Color.FELT, 0.6 if part.is_rigid else 0.85), Color.PAPER, pale)
            borders = [MILLIMETERS * nodes[loop] for loop in loops]
            sheet.area(
                borders, facecolor=color, edgecolor=Color.mix(Color.INK, Color.FELT, 0.4), linewidth=0.8, zorder=3.25
            )
        for cover in self.robot.sheets:
            color = Color.mix(Color.SHEET, Color.PAPER, pale)
            borders = [MILLIMETERS * nodes[loop] for loop in cover.find_rings(self.robot.body.mesh)]
            if borders:
                sheet.area(borders, facecolor=Color.mix(color, fill, 0.45), edgecolor=color, linewidth=0.8, zorder=3.22)
            if len(rim := cover.find_facets(self.robot.body.mesh)[1]):
                sheet.segments(MILLIMETERS * nodes[rim], color=color, linewidth=2.4, zorder=3.23)
        for anchors in self.robot.body.mark_anchors:
            sheet.curve(
                MILLIMETERS * anchors.positions(nodes),
                color=Color.mix(Color.INK, Color.PAPER, pale),
                linewidth=1.5,
                zorder=3.3,
            )
        if mesh:
            ends = MILLIMETERS * nodes[self.robot.body.mesh.edges]
            sheet.segments(ends, color=Color.MESH, linewidth=0.35, alpha=0.42, zorder=4)
        if pins:
            _draw_pins(sheet, self.robot, rings)
        return self._with_rims(sheet, DrawnBody(rings), obstacles)


@dataclass(frozen=True, eq=False)
class SpacePane(Pane):
    """A body in space."""

    camera: Camera  # that sees it
    shift: Place  # what is added to its places on the sheet [mm]
    pixel: float | None = None  # side of a pixel of the image of the body [mm]; by the size of the picture if left out

    def places(self, points: Points) -> Places:
        return self.camera.see(MILLIMETERS * points)[:, :2] + self.shift

    def outline(self, sheet: PictureSheet, nodes: Nodes) -> list[Places]:
        spots = self.camera.see(MILLIMETERS * nodes)
        image = Render.silhouette(spots, self.robot.body.mesh.boundary, pixel=self._pixel(sheet, spots))
        return [ring + self.shift for ring in image.rings()]

    def draw_body(
        self,
        sheet: PictureSheet,
        nodes: Nodes,
        *,
        pale: float = 0.0,
        mesh: bool = False,
        pins: bool = False,
        obstacles: Sequence[Obstacle] = (),
    ) -> DrawnBody:
        body, facets = self.robot.body.mesh, [self.robot.body.mesh.boundary]
        spots = self.camera.see(MILLIMETERS * nodes)
        held = np.any([np.zeros(len(nodes)), *(pin.holds(body) for pin in self.robot.pins)], axis=0)
        held &= pins
        for places, triangles in map(object_surface, obstacles):
            facets.append(triangles + len(spots))
            spots = np.concatenate([spots, self.camera.see(MILLIMETERS * places)])
            held = np.append(held, np.ones(len(places), dtype=bool))
        image = render(
            spots, np.concatenate(facets), pixel=self._pixel(sheet, spots), up=self.camera.sky, pale=0.6 * pale,
            held=held.astype(float) if held.any() else None, lines=self._density(sheet) if mesh else 0.0,
            point=sheet.scale,
        )  # fmt: skip
        for cover in self.robot.sheets:
            color = Color.mix(Color.SHEET, Color.PAPER, 0.6 * pale)
            own = np.arange(sum(map(len, facets))) < len(body.boundary)
            own[: len(body.boundary)] = cover.holds(body.nodes[body.boundary].mean(axis=1))
            image = image.with_tint(own, color)
        rings = lay_image(sheet, image, self.shift, seam=Color.mix(Color.SEAM, Color.PAPER, 0.6 * pale))
        self._draw_parts(sheet, nodes, pale)
        thickness = MILLIMETERS * float(np.ptp(body.nodes, axis=0).min())
        return self._with_rims(sheet, DrawnBody(rings, (self.camera, self.shift, image, thickness)), obstacles)

    def _draw_parts(self, sheet: PictureSheet, nodes: Nodes, pale: float) -> None:
        """Draw the parts of the body with its nodes at `nodes` [m] as if it were half transparent."""
        if not self.robot.body.parts:
            return
        spots = self.camera.see(MILLIMETERS * nodes)
        pixel, edge = self._pixel(sheet, spots), Color.mix(Color.INK, Color.PAPER, pale)
        body = self.robot.body
        found = find_part_facets(body.mesh, body.element_materials, len(body.parts))
        for part, facets in zip(body.parts, found, strict=True):
            color = Color.mix(Color.mix(Color.INK, Color.FELT, 0.3 if part.is_rigid else 0.7), Color.PAPER, pale)
            rings = [ring + self.shift for ring in Render.silhouette(spots, facets, pixel=pixel).rings()]
            if rings:
                look = {"edgecolor": "none", "alpha": 0.45, "joinstyle": "round"}
                sheet.area(rings, facecolor=color, zorder=3.15, **look)
                sheet.area(rings, facecolor="none", edgecolor=edge, linewidth=0.9, linestyle=(0, (3, 2)), zorder=3.16)

    def _pixel(self, sheet: PictureSheet, spots: Spots) -> float:
        """Side of a pixel [mm] of an image of spots [mm]."""
        return self.pixel or fit_pixel(sheet, np.ptp(spots[:, :2], axis=0))

    def _density(self, sheet: PictureSheet) -> float:
        """Opacity of the mesh edges from 0 to 1: lower, the closer together they are."""
        mesh = self.robot.body.mesh
        sides = np.linalg.norm(np.diff(mesh.nodes[mesh.boundary[:, :2]], axis=1)[:, 0], axis=1)
        return float(np.clip(MILLIMETERS * np.median(sides) / (9 * sheet.scale), 0.0, 1.0))


def fit_pixel(sheet: PictureSheet, sides: Place, *, dpi: float = DPI) -> float:
    """Side of a pixel [mm] of an image with these sides [mm], so many to an inch unless they would be too many."""
    most_pixels = 1.0e6  # pixels of a larger image grow, so that no image takes long
    return max(72 / dpi * sheet.scale, float(np.sqrt(np.prod(sides) / most_pixels)))


def lay_image(sheet: PictureSheet, image: Render, shift: Place, *, seam: str = Color.SEAM) -> list[Places]:
    """Put the image of a body on a sheet, moved by a shift [mm], with a line around it; returns its outline [mm]."""
    x, y = shift
    left, right, low, high = image.extent
    sheet.axes.imshow(
        image.colors, extent=(left + x, right + x, low + y, high + y), origin="lower", aspect="auto", zorder=3,
        interpolation="antialiased", clip_on=False, label=BODY,
    )  # fmt: skip
    rings = [ring + shift for ring in image.rings()]
    if rings:
        sheet.area(rings, facecolor="none", edgecolor=seam, linewidth=0.9, joinstyle="round", zorder=3.1)
    return rings


def _draw_pins(sheet: PictureSheet, robot: Robot, rings: list[Places]) -> None:
    """Draw the boundary conditions: a hatched field for each pin, cut along the body's rings [mm]."""
    body = shapely.Polygon()
    for ring in rings:  # a body of several parts, with holes
        body = body.symmetric_difference(shapely.Polygon(ring).buffer(0))
    for pin in robot.pins:
        if pin.box is not None:
            field = shapely.box(*MILLIMETERS * np.min(pin.box, axis=0), *MILLIMETERS * np.max(pin.box, axis=0))
        else:
            radius = max(MILLIMETERS * pin.radius, 4 * sheet.scale)
            field = shapely.Point(MILLIMETERS * np.array(pin.at)).buffer(radius, quad_segs=24)
        for part in shapely.get_parts(field.intersection(body)):
            if isinstance(part, shapely.Polygon):
                _hatch(sheet, part)


def _hatch(sheet: PictureSheet, field: shapely.Polygon) -> None:
    low, high = np.array(field.bounds).reshape(2, 2)
    tall = high[1] - low[1]
    starts = np.arange(low[0] - tall, high[0], 4.2 * sheet.scale)
    strokes = [[(start, low[1]), (start + tall, high[1])] for start in starts]
    cut = shapely.get_parts(shapely.intersection(shapely.linestrings(strokes), field))
    ends = [np.array(line.coords)[[0, -1]] for line in cut if line.geom_type == "LineString" and line.length > 0]
    sheet.segments(np.array(ends), color=Color.DARK, linewidth=0.6, alpha=0.5, zorder=5)
    for ring in (field.exterior, *field.interiors):
        sheet.curve(np.array(ring.coords), color=Color.DARK, linewidth=0.7, alpha=0.55, zorder=5)
