"""Shapes without physics: outlines and their drawings, meshes, and points stuck to the material."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.geometry.anchors import Anchors, clearance, locate, nearest_shares
    from hydrostat.geometry.boundary_tree import BoundaryTree, Pairs
    from hydrostat.geometry.contour import contour
    from hydrostat.geometry.crossings import find_crossings
    from hydrostat.geometry.distance_field import DistanceField, Distances
    from hydrostat.geometry.files.drawing_body import Inner
    from hydrostat.geometry.files.mesh_file import read_labeled_mesh
    from hydrostat.geometry.files.outline_file import OUTLINE_SUFFIXES, read_drawing, read_outline
    from hydrostat.geometry.files.ply_file import write_ply
    from hydrostat.geometry.files.rings import DRAWN_HINT
    from hydrostat.geometry.files.silhouette import contrast
    from hydrostat.geometry.files.surface_file import STEP_SUFFIXES, SURFACE_SUFFIXES, convert_step, read_surface
    from hydrostat.geometry.files.vtu_file import write_lines_vtu, write_vtu
    from hydrostat.geometry.healing.faults import crossing_pairs
    from hydrostat.geometry.healing.heal import heal
    from hydrostat.geometry.healing.healing import Healing
    from hydrostat.geometry.healing.mend import sides_of
    from hydrostat.geometry.inflate import inflate
    from hydrostat.geometry.mesh import Mesh
    from hydrostat.geometry.outline import Curve, Outline, Ring
    from hydrostat.geometry.shell import Nearest, Shell
    from hydrostat.geometry.sizing import size_for
    from hydrostat.geometry.surface import Solid, Surface
    from hydrostat.geometry.tetrahedra.manifold import euler
    from hydrostat.geometry.tetrahedra.small_holes import HOLE_SHARE, fill_small_holes
    from hydrostat.geometry.tetrahedra.tetrahedralize import BOUNDARY_TOLERANCE, fit, tetrahedralize
    from hydrostat.geometry.thickness import Thickness, build_point_tree
    from hydrostat.geometry.triangles.triangulate import triangulate

__all__ = [
    "BOUNDARY_TOLERANCE",
    "DRAWN_HINT",
    "HOLE_SHARE",
    "OUTLINE_SUFFIXES",
    "STEP_SUFFIXES",
    "SURFACE_SUFFIXES",
    "Anchors",
    "BoundaryTree",
    "Curve",
    "DistanceField",
    "Distances",
    "Healing",
    "Inner",
    "Mesh",
    "Nearest",
    "Outline",
    "Pairs",
    "Ring",
    "Shell",
    "Solid",
    "Surface",
    "Thickness",
    "build_point_tree",
    "clearance",
    "contour",
    "contrast",
    "convert_step",
    "crossing_pairs",
    "euler",
    "fill_small_holes",
    "find_crossings",
    "fit",
    "heal",
    "inflate",
    "locate",
    "nearest_shares",
    "read_drawing",
    "read_labeled_mesh",
    "read_outline",
    "read_surface",
    "sides_of",
    "size_for",
    "tetrahedralize",
    "triangulate",
    "write_lines_vtu",
    "write_ply",
    "write_vtu",
]

open_package(__name__)
