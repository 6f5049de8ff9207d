"""Rendering of shapes: cameras, depths, lines, shades and colors, for figures and printed pages."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.drawing.camera import Camera, Spots
    from hydrostat.drawing.canvas import NAMESPACE, Box, Canvas, CanvasFrame, Html, Spot, number, path, shape, tag
    from hydrostat.drawing.creases import smooth_normals
    from hydrostat.drawing.depth import DepthBuffer, Polyline, level_rings
    from hydrostat.drawing.line_drawing import DrawnSolid, LineDrawing
    from hydrostat.drawing.palette import Color
    from hydrostat.drawing.render import CREASE, Render, render

__all__ = [
    "CREASE",
    "NAMESPACE",
    "Box",
    "Camera",
    "Canvas",
    "CanvasFrame",
    "Color",
    "DepthBuffer",
    "DrawnSolid",
    "Html",
    "LineDrawing",
    "Polyline",
    "Render",
    "Spot",
    "Spots",
    "level_rings",
    "number",
    "path",
    "render",
    "shape",
    "smooth_normals",
    "tag",
]

open_package(__name__)
