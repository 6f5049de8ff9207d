"""Shapes without physics: outlines and their drawings, meshes, and points stuck to the material."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.geometry.anchors import Anchors, anchor_nodes, clearance, locate, nearest_shares
    from hydrostat.geometry.boundary_tree import BoundaryTree, Pairs, facet_areas
    from hydrostat.geometry.contour import contour
    from hydrostat.geometry.crossings import find_crossings
    from hydrostat.geometry.distance_field import (
        DistanceField,
        Distances,
        box_field,
        capsule_field,
        cylinder_field,
        lengths_of,
        plane_field,
        sphere_field,
    )
    from hydrostat.geometry.files.drawing_body import Inner
    from hydrostat.geometry.files.mesh_file import read_mesh
    from hydrostat.geometry.files.outline_file import OUTLINE_SUFFIXES, read_drawing, read_outline
    from hydrostat.geometry.files.ply_file import write_ply
    from hydrostat.geometry.files.rings import DRAWN_HINT
    from hydrostat.geometry.files.silhouette import contrast
    from hydrostat.geometry.files.surface_file import SURFACE_SUFFIXES, read_surface
    from hydrostat.geometry.files.vtu_file import write_vtu
    from hydrostat.geometry.healing.faults import crossing_pairs
    from hydrostat.geometry.healing.heal import heal
    from hydrostat.geometry.healing.healing import Healing
    from hydrostat.geometry.healing.mend import sides_of
    from hydrostat.geometry.inflate import inflate
    from hydrostat.geometry.mesh import Mesh, dihedral_angles, smallest_angle
    from hydrostat.geometry.outline import Curve, Outline, Ring
    from hydrostat.geometry.shell import Nearest, Shell, outline_shell, shell_field
    from hydrostat.geometry.sizing import size_for
    from hydrostat.geometry.surface import Solid, Surface
    from hydrostat.geometry.tetrahedra.manifold import euler
    from hydrostat.geometry.tetrahedra.stuffing import turned_outward
    from hydrostat.geometry.tetrahedra.tetrahedralize import CLOSE, fit, tetrahedralize
    from hydrostat.geometry.thickness import Thickness, measure_thickness, spacings, thin_parts
    from hydrostat.geometry.triangles.triangulate import triangulate

__all__ = [
    "CLOSE",
    "DRAWN_HINT",
    "OUTLINE_SUFFIXES",
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
    "anchor_nodes",
    "box_field",
    "capsule_field",
    "clearance",
    "contour",
    "contrast",
    "crossing_pairs",
    "cylinder_field",
    "dihedral_angles",
    "euler",
    "facet_areas",
    "find_crossings",
    "fit",
    "heal",
    "inflate",
    "lengths_of",
    "locate",
    "measure_thickness",
    "nearest_shares",
    "outline_shell",
    "plane_field",
    "read_drawing",
    "read_mesh",
    "read_outline",
    "read_surface",
    "shell_field",
    "sides_of",
    "size_for",
    "smallest_angle",
    "spacings",
    "sphere_field",
    "tetrahedralize",
    "thin_parts",
    "triangulate",
    "turned_outward",
    "write_ply",
    "write_vtu",
]

open_package(__name__)
