"""Rendering of shapes: cameras, depths, lines, shades and colors, for figures and printed pages."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.drawing.camera import Camera, Spots, along_an_axis, three_quarter, upright
    from hydrostat.drawing.canvas import (
        MIDDLE,
        PIXELS,
        THICK,
        THIN,
        Box,
        Canvas,
        CanvasFrame,
        Spot,
        balloon_radius,
        fit_height,
        text_size,
    )
    from hydrostat.drawing.creases import smooth_normals
    from hydrostat.drawing.depth import DepthBuffer, Polyline, level_rings
    from hydrostat.drawing.line_drawing import DrawnSolid, LineDrawing, line_drawing
    from hydrostat.drawing.palette import (
        DARK,
        ERROR,
        FELT,
        FELT_LIGHT,
        GHOST,
        GHOST_FILL,
        GRID,
        INK,
        LIGHT,
        MESH,
        MUTED,
        PAGE_COLOURS,
        PAPER,
        SEAM,
        STITCH,
        TENSION,
        WINCHES,
        channels,
        mix,
        pose_colours,
        winch_colours,
    )
    from hydrostat.drawing.render import CREASE, Render, render, silhouette
    from hydrostat.drawing.svg import NAMESPACE, Html, number, path, shape, tag

__all__ = [
    "CREASE",
    "DARK",
    "ERROR",
    "FELT",
    "FELT_LIGHT",
    "GHOST",
    "GHOST_FILL",
    "GRID",
    "INK",
    "LIGHT",
    "MESH",
    "MIDDLE",
    "MUTED",
    "NAMESPACE",
    "PAGE_COLOURS",
    "PAPER",
    "PIXELS",
    "SEAM",
    "STITCH",
    "TENSION",
    "THICK",
    "THIN",
    "WINCHES",
    "Box",
    "Camera",
    "Canvas",
    "CanvasFrame",
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
    "pose_colours",
    "render",
    "shape",
    "silhouette",
    "smooth_normals",
    "tag",
    "text_size",
    "three_quarter",
    "upright",
    "winch_colours",
]

open_package(__name__)
