"""`DrawnBody`: a drawn body, and what of cables, winches and markers lies behind it."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.drawing import Camera, Render
from hydrostat.plot.sheet import Place, Places, Spread
from hydrostat.robot import SEWN_DEPTH
from hydrostat.units import MILLIMETERS

LEVELS = 8  # steps from what is just covered to what is deep inside


@dataclass(frozen=True, eq=False)
class DrawnCable:
    """A cable on a picture."""

    points: Places  # its points [mm]
    parts: list[tuple[Places, float]]  # pieces [mm], faded from 0 in front of the body towards 1 behind it
    fades: Vector  # how far each of its points has faded


@dataclass(frozen=True, eq=False)
class DrawnBody:
    """The drawn body."""

    rings: list[Places]  # its silhouette [mm], the outer ring first
    sight: tuple[Camera, Place, Render, float] | None = None  # with its shift and the shortest side [mm]; None: flat

    def fades(self, points: Points) -> Vector:
        """Fading of objects at points [m] behind the body: 0 in front of it, towards 1 behind it."""
        if self.sight is None:
            return np.zeros(len(points))
        camera, _, image, thickness = self.sight
        depths = image.covers(camera.see(MILLIMETERS * points))
        levels = np.ceil(LEVELS * (1 - np.exp(-3 * depths / thickness))) / LEVELS
        skin = min(MILLIMETERS * SEWN_DEPTH, 0.1 * thickness)  # depth of cables on a skin, which are visible
        return np.where(depths > max(skin, image.buffer.pixel), 0.26 + 0.42 * levels, 0.0)

    def cable(self, points: Points) -> DrawnCable:
        """A cable through points [m]."""
        if self.sight is None:
            places = MILLIMETERS * points
            return DrawnCable(places, [(places, 0.0)], np.zeros(len(points)))
        camera, shift, image, _ = self.sight
        step = 1.0  # length of the pieces into which a run is cut to see which of them are covered, in pixels
        fine = _subdivide(points, step * image.buffer.pixel / MILLIMETERS)
        places, fades = camera.see(MILLIMETERS * fine)[:, :2] + shift, self.fades(fine)
        cuts = np.flatnonzero(np.diff(fades)) + 1
        starts, ends = [0, *cuts], [*cuts, len(fades)]
        parts = [(places[start : end + 1], float(fades[start])) for start, end in zip(starts, ends, strict=True)]
        whole = camera.see(MILLIMETERS * points)[:, :2] + shift
        return DrawnCable(whole, [part for part in parts if len(part[0]) > 1], self.fades(points))


def _subdivide(points: Points, step: float) -> Spread:
    """Points close together along the lines through points [m]."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    parts = [
        start + np.linspace(0, 1, max(2, int(np.ceil(length / step))), endpoint=False)[:, None] * (end - start)
        for start, end, length in zip(points[:-1], points[1:], lengths, strict=True)
    ]
    return np.concatenate([*parts, points[-1:]])
