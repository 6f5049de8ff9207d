"""Shapes without physics: outlines and their drawings, meshes, and points stuck to the material."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.geometry.anchors import Anchors, locate
    from hydrostat.geometry.crossings import Crossings, find_crossings
    from hydrostat.geometry.files.outline_file import read_outline
    from hydrostat.geometry.mesh import Mesh, dihedral_angles, smallest_angle
    from hydrostat.geometry.outline import Outline
    from hydrostat.geometry.triangles.triangulate import triangulate

__all__ = [
    "Anchors",
    "Crossings",
    "Mesh",
    "Outline",
    "dihedral_angles",
    "find_crossings",
    "locate",
    "read_outline",
    "smallest_angle",
    "triangulate",
]

open_package(__name__)
