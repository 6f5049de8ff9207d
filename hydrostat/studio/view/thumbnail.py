"""`draw_thumbnail`: a robot as a small picture, in milliseconds."""

from collections.abc import Callable
from io import BytesIO

import numpy as np
from PIL import Image, ImageDraw

from hydrostat.arrays import Points
from hydrostat.drawing import Camera, Color
from hydrostat.plot import Attachments, FlatSkin
from hydrostat.robot import Robot
from hydrostat.studio.view.scene_items import RobotShape

SIZE = (240, 180)  # of a picture [pixels]
_FINE = 2  # drawn so many times larger, for smooth edges
_MARGIN = 12  # pixels that stay free on each side


def draw_thumbnail(robot: Robot, shape: RobotShape) -> bytes:
    """A robot in a shape on clear ground, so that it stands on light and dark pages, as WebP."""
    sheet = Image.new("RGBA", (_FINE * SIZE[0], _FINE * SIZE[1]), (0, 0, 0, 0))
    pen, rest = ImageDraw.Draw(sheet), robot.body.mesh.nodes
    view, fit = _look_at(robot)
    if rest.shape[1] == 2:
        outer, *holes = (
            [tuple(point) for point in fit.place(ring)] for ring in FlatSkin.of(robot.body).shape(shape.nodes)
        )
        pen.polygon(outer, fill=Color.FELT, outline=Color.SEAM, width=2 * _FINE)
        for hole in holes:
            pen.polygon(hole, fill=(0, 0, 0, 0), outline=Color.SEAM, width=2 * _FINE)
    else:
        _draw_surface(pen, robot, view(shape.nodes), fit)

    def draw(points: Points, color: str) -> None:
        line = [tuple(point) for point in fit.place(view(points)[:, :2])]
        pen.line(line, fill=color, width=2 * _FINE, joint="curve")

    for anchors in robot.body.mark_anchors:
        draw(anchors.positions(shape.nodes), Color.INK)
    colors, attached = Color.of_winches(robot.winches), Attachments(robot)
    for cable, points in zip(robot.cables, attached.cables(shape.nodes), strict=True):
        draw(points, colors[cable.winch])
    places = fit.place(view(attached.winches(shape.nodes))[:, :2])
    for winch, place in zip(robot.winches, places.tolist(), strict=True):
        pen.circle(place, 4 * _FINE, fill=colors[winch.name], outline="white", width=_FINE)
    buffer = BytesIO()
    sheet.resize(SIZE, Image.Resampling.BOX).save(buffer, format="WEBP", quality=60, method=0)
    return buffer.getvalue()


def _look_at(robot: Robot) -> "tuple[Callable[[Points], Points], _PictureScale]":
    """Points as seen, of a body in space with their depth, and the scale of the picture."""
    nodes = robot.body.mesh.nodes
    if nodes.shape[1] == 2:
        return lambda points: points, _PictureScale(nodes)
    shown = np.array([part.at for part in (*robot.winches, *robot.markers)], dtype=float).reshape(-1, 3)
    camera = Camera.three_quarter(nodes, shown, np.array([0.0, 0.0, 1.0]))
    return camera.see, _PictureScale(camera.see(np.vstack((nodes, shown)))[:, :2])


def _draw_surface(pen: ImageDraw.ImageDraw, robot: Robot, nodes: Points, fit: "_PictureScale") -> None:
    """Triangles of a body in space by their nodes as seen, the far ones first, darker where they turn away."""
    seen = nodes[robot.body.mesh.boundary]  # (triangles, 3, 3)
    normals = np.cross(seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0])
    lights = normals[:, 2] / np.maximum(np.linalg.norm(normals, axis=1), 1e-30)
    felt = np.array([int(Color.FELT[place : place + 2], 16) for place in (1, 3, 5)])
    colors = (felt * (0.55 + 0.45 * lights[:, None])).astype(int)
    for number in np.argsort(seen[:, :, 2].mean(axis=1)):
        if lights[number] > 0:
            pen.polygon([tuple(point) for point in fit.place(seen[number, :, :2])], fill=tuple(colors[number]))


class _PictureScale:
    """Places of the picture: half as much again as the rest shape fits."""

    def __init__(self, rest: Points) -> None:
        low, high = rest.min(axis=0), rest.max(axis=0)
        room = np.array(SIZE) - 2 * _MARGIN
        self._scale = _FINE * float((room / np.maximum(high - low, 1e-9)).min()) / 1.3
        self._middle = (low + high) / 2

    def place(self, points: Points) -> Points:
        """Pixels of points, y downwards."""
        return (points - self._middle) * (self._scale, -self._scale) + _FINE * np.array(SIZE) / 2
