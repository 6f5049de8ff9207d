"""`Strokes`: many lines and dots of a picture as one artist."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from hydrostat.arrays import Float

Rgba = tuple[float, float, float, float]


class _Stroke(NamedTuple):
    """A line, or dots where a marker is given, in matplotlib's words."""

    path: Path
    color: Rgba
    width: float
    cap: str
    join: str
    marker: MarkerStyle | None = None
    size: float = 0.0
    edge: Rgba = (0.0, 0.0, 0.0, 0.0)


class Strokes(Artist):
    """Lines and dots at one height, drawn in turn: as matplotlib draws a Line2D for each, pixel by pixel, but faster.

    A frame of a film has hundreds of them, and preparing a Line2D takes ten times as long as drawing it.
    """

    def __init__(self, zorder: float) -> None:
        super().__init__()
        self.set_zorder(zorder)
        self._strokes: list[_Stroke] = []

    def draw(self, renderer: Any) -> None:
        """Draw all of them."""
        transform = self.get_transform().frozen()
        for stroke in self._strokes:
            gc = renderer.new_gc()
            gc.set_linewidth(stroke.width)
            gc.set_joinstyle(stroke.join)
            gc.set_capstyle(stroke.cap)
            if stroke.marker is None:
                gc.set_foreground(stroke.color, isRGBA=True)
                renderer.draw_path(gc, stroke.path, transform)
            else:
                size, snap = renderer.points_to_pixels(stroke.size), stroke.marker.get_snap_threshold()
                gc.set_snap(None if snap is None else size >= snap)
                gc.set_foreground(stroke.edge, isRGBA=True)
                scaled = Affine2D(stroke.marker.get_transform().get_matrix()).scale(size)
                renderer.draw_markers(gc, stroke.marker.get_path(), scaled, stroke.path, transform, stroke.color)
            gc.restore()

    def add(self, stroke: _Stroke) -> None:
        """Draw this one, too, after the others."""
        self._strokes.append(stroke)


class StrokeLayers:
    """Strokes of a picture by their height."""

    def __init__(self, axes: Axes) -> None:
        self._axes = axes
        self._layers: dict[float, Strokes] = {}
        self._markers: dict[str, MarkerStyle] = {}

    def take(self, points: Float[np.ndarray, "_ 2"], look: dict[str, Any]) -> bool:
        """Draw a line or dots; False if they have a look that only a Line2D has, such as dashes."""
        is_dots = "marker" in look
        if look["clip_on"] or not look.keys() <= _KNOWN or is_dots != (look.get("linestyle") == "none"):
            return False
        alpha = look.get("alpha")
        color = to_rgba(look["color"], alpha)
        path, join = Path(points), look["solid_joinstyle"]
        path.should_simplify = False
        if is_dots:
            edge = to_rgba(look.get("markeredgecolor", look["color"]), alpha)
            name, wide = look["marker"], look.get("markeredgewidth", 1.0)
            kind = self._markers[name] = self._markers.get(name) or MarkerStyle(name)
            size = look["markersize"]
            stroke = _Stroke(path, color, wide, kind.get_capstyle(), kind.get_joinstyle(), kind, size, edge)
        else:
            stroke = _Stroke(path, color, look["linewidth"], look["solid_capstyle"], join)
        zorder = look["zorder"]
        if zorder not in self._layers:
            self._layers[zorder] = Strokes(zorder)
            self._axes.add_artist(self._layers[zorder])
        self._layers[zorder].add(stroke)
        return True

    def clear(self) -> None:
        """Remove all of them from the picture."""
        for layer in self._layers.values():
            layer.remove()
        self._layers.clear()


_KNOWN = {
    *("color", "linewidth", "alpha", "zorder", "clip_on", "solid_capstyle", "solid_joinstyle"),
    *("linestyle", "marker", "markersize", "markeredgecolor", "markeredgewidth"),
}
