"""Panes: a flat body as it is, a body in space as a camera sees it. Figures draw on either alike."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.drawing.camera import Camera, Spots
from hydrostat.drawing.palette import GHOST, GHOST_FILL, SEAM, mix
from hydrostat.drawing.render import Render, render
from hydrostat.plot.felt import draw_felt, draw_ghost, draw_mesh, draw_pins
from hydrostat.plot.places import Place, Places
from hydrostat.plot.sheet import BODY, MILLIMETRES, Sheet
from hydrostat.plot.skin import Skin
from hydrostat.plot.surface import Surface
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
    skin: Skin

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
    ) -> Surface:
        """The body with its nodes at `nodes` [m]; `pale` fades it, `mesh` and `pins` add these."""
        rings = [MILLIMETRES * ring for ring in self.skin.shape(nodes)]
        draw_felt(sheet, self.skin, nodes, pale=pale)
        if mesh:
            draw_mesh(sheet, self.robot, nodes)
        if pins:
            draw_pins(sheet, self.robot, rings)
        return Surface(rings)


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
    ) -> Surface:
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
        return Surface(rings, (self.camera, self.shift, image, thickness))

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
