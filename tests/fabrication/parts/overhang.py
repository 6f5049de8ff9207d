"""What a printer would lay into the air."""

import math

import numpy as np

from hydrostat.fabrication.solids.printed import Printed


def overhang(printed: Printed, *, steepest: float = 50.5) -> float:
    """Area above the bed that faces down and leans further than an angle from upright [degrees], in mm^2."""
    vertices, triangles = printed.file_mesh
    corners = vertices[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    size = np.linalg.norm(areas, axis=1)
    leans = areas[:, 2] < -math.sin(math.radians(steepest)) * size
    return float(size[leans & (corners[:, :, 2].max(axis=1) > 1e-3)].sum())
