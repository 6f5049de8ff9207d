"""Rendering of shapes: cameras, depths, lines, shades and colors, for figures and printed pages."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.drawing.camera import Camera, Spots, along_an_axis, three_quarter, upright
    from hydrostat.drawing.canvas import (
        NAMESPACE,
        Box,
        Canvas,
        CanvasFrame,
        Html,
        Spot,
        balloon_radius,
        fit_height,
        number,
        path,
        shape,
        tag,
        text_size,
    )
    from hydrostat.drawing.creases import smooth_normals
    from hydrostat.drawing.depth import DepthBuffer, Polyline, level_rings
    from hydrostat.drawing.line_drawing import DrawnSolid, LineDrawing, line_drawing
    from hydrostat.drawing.palette import (
        Color,
        channels,
        mix,
        pose_colors,
        winch_colors,
    )
    from hydrostat.drawing.render import CREASE, Render, render, silhouette

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
    "along_an_axis",
    "balloon_radius",
    "channels",
    "fit_height",
    "level_rings",
    "line_drawing",
    "mix",
    "number",
    "path",
    "pose_colors",
    "render",
    "shape",
    "silhouette",
    "smooth_normals",
    "tag",
    "text_size",
    "three_quarter",
    "upright",
    "winch_colors",
]

open_package(__name__)
