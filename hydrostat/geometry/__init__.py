"""Shapes without physics: outlines and their drawings, meshes, and points stuck to the material."""

from hydrostat.geometry.anchors import Anchors, locate
from hydrostat.geometry.files.svg import read_svg
from hydrostat.geometry.mesh import Mesh, dihedral_angles, smallest_angle
from hydrostat.geometry.outline import Outline
from hydrostat.geometry.triangles.triangulate import triangulate

__all__ = ["Anchors", "Mesh", "Outline", "dihedral_angles", "locate", "read_svg", "smallest_angle", "triangulate"]
