"""`FramePictures`: frames of an animation as pixels, all seen by one eye in one frame."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.artist import Artist

from hydrostat.arrays import UInt8
from hydrostat.drawing import Color
from hydrostat.plot.drawn_parts import draw_loads, draw_rods, load_reach
from hydrostat.plot.frame import Attachments, Frame
from hydrostat.plot.hardware import draw_hardware
from hydrostat.plot.labels import shorten
from hydrostat.plot.open_sheet import open_sheet
from hydrostat.plot.pane import SpacePane, fit_pixel
from hydrostat.plot.picture_file import figure_pixels
from hydrostat.plot.sheet import Spread
from hydrostat.plot.skin import outer_points
from hydrostat.plot.strokes import StrokeLayers
from hydrostat.plot.targets import draw_misses, target_places, target_points
from hydrostat.plot.tension_scale import TensionScale
from hydrostat.robot import Robot, rims
from hydrostat.simulation import with_obstacles

Picture = UInt8[np.ndarray, "_ _ 3"]  # red, green and blue of each pixel, the top row first


class FramePictures:
    """A sheet on which one frame after another is drawn; camera, frame and colors of tension are those of all."""

    def __init__(self, robot: Robot, frames: Sequence[Frame], *, width: int) -> None:
        """Room for all of the frames, in pictures of a width [pixels]."""
        self._robot, self._carried = robot, Attachments(robot)
        self._scale = TensionScale.of(np.concatenate([frame.tensions for frame in frames]))
        points = _visible_points(robot, self._carried, frames)
        inches = 6.4  # width of the drawing, whatever its pixels: words and lines keep their share of it
        self._sheet, panes = open_sheet(
            with_obstacles(robot, frames[0].obstacles),
            [],
            [points],
            title=shorten(robot.name),
            subtitle=" ",
            width=inches,
            bar=True,
            ruled=False,
        )
        self._dpi = width / inches
        pane = panes[0]
        # pixels of the image of a body for one of the picture: edges of its parts stay smooth as they move
        finer = 1.25
        pixel = fit_pixel(self._sheet, self._sheet.high - self._sheet.low, dpi=finer * self._dpi)
        self._pane = replace(pane, pixel=pixel) if isinstance(pane, SpacePane) else pane
        self._sheet.figure.set_facecolor(Color.PAPER)
        self._sheet.figure.set_dpi(self._dpi)
        if robot.cables:
            self._scale.draw_bar(self._sheet, of="cable tension")
        self._layers = StrokeLayers(self._sheet.axes)
        self._sheet = replace(self._sheet, layers=self._layers)
        self._still = set(self._artists())
        self._last: tuple[Frame, Picture] | None = None

    def draw(self, frame: Frame) -> Picture:
        """The picture of a frame; one that shows the same as the frame before is not drawn again."""
        if self._last is not None and _alike(self._last[0], frame):
            return self._last[1]
        self._layers.clear()
        for artist in self._artists():
            if artist not in self._still:
                artist.remove()
        self._sheet.figure.texts[1].set_text(frame.words)
        self._draw(frame)
        picture = figure_pixels(self._sheet.figure)[..., :3].copy()
        self._last = frame, picture
        return picture

    def _artists(self) -> list[Artist]:
        """All that is drawn in the axes of the body."""
        axes = self._sheet.axes
        return [*axes.lines, *axes.patches, *axes.images, *axes.texts]

    def _draw(self, frame: Frame) -> None:
        sheet, pane, robot, carried = self._sheet, self._pane, self._robot, self._carried
        surface = pane.draw_body(sheet, frame.nodes, pale=0.25, pins=True, obstacles=frame.obstacles)
        colors = [self._scale.color(float(tension)) for tension in frame.tensions]
        look = {"colors": colors, "width": 2.6, "contractions": frame.contractions}
        draw_hardware(sheet, pane, surface, carried, frame.nodes, **look)
        draw_rods(sheet, pane, robot, frame.nodes)
        draw_loads(sheet, pane, robot, frame.nodes)
        names = [marker.name for marker in robot.markers]
        markers = dict(zip(names, carried.markers(frame.nodes), strict=True))
        draw_misses(sheet, [pane], markers, {} if frame.target is None else target_places(frame.target))


def _visible_points(robot: Robot, carried: Attachments, frames: Sequence[Frame]) -> Spread:
    """Points that every picture must hold [m]: body, cables and winches of all frames, and all targets."""
    shapes = list({id(frame.nodes): frame.nodes for frame in frames}.values())
    parts = outer_points(robot.body, shapes)
    parts += [part for nodes in shapes for part in (*carried.cables(nodes), carried.winches(nodes))]
    parts += [line for frame in frames for obstacle in frame.obstacles for line in rims(obstacle, robot)]
    parts += [load_reach(robot, nodes) for nodes in shapes]
    parts += [target_points(frame.target) for frame in frames if frame.target is not None]
    return np.concatenate(parts)


def _alike(one: Frame, two: Frame) -> bool:
    """True if two frames look the same."""
    if one is two:
        return True
    return (
        one.words == two.words
        and one.target == two.target
        and one.obstacles == two.obstacles
        and np.array_equal(one.nodes, two.nodes)
        and np.array_equal(one.tensions, two.tensions)
        and np.array_equal(_or_none(one.contractions), _or_none(two.contractions))
    )


def _or_none(values: np.ndarray | None) -> np.ndarray:
    return np.zeros(0) if values is None else values
