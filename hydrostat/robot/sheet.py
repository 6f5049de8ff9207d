"""`Membrane`: an elastic sheet on the skin of a body, such as felt, a knitted glove or a layer of fibres."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Int
from hydrostat.closed_set import make_member
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.given import check_positive, check_type
from hydrostat.robot.material import Material
from hydrostat.robot.materials import get_material
from hydrostat.robot.part_elements import find_rings
from hydrostat.robot.region import PartRegion


class SheetSide(StrEnum):
    """Sides of a flat body that a sheet covers; in space there is only the skin."""

    SKIN = "skin"  # all: faces and outline
    FACES = "faces"  # front and back
    OUTLINE = "outline"  # as wide as the body is thick


@dataclass(frozen=True, kw_only=True)
class Membrane(PartRegion):
    """Elastic sheet bonded to the skin of a body; it resists in-plane stretch and shear, not bending.

    It covers the mesh facets whose center is in its region, or the whole skin without a shape. It adds no thickness to
    the body: contact and drawing stay unchanged.

    Attributes:
        thickness: thickness of the sheet [m].
        material: elastic material, or its name in the table. It is Neo-Hookean, without viscosity or hysteresis.
        on: sides of a flat body that it covers.
        wrinkles: True if it resists no compression, as cloth; False for a layer that is bonded everywhere.

    Raises:
        InputError: as for `PartRegion`, a value out of range, or a material that is not purely elastic.
    """

    thickness: float
    material: Material
    on: SheetSide | str = SheetSide.SKIN
    wrinkles: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        make_member(self, "on", SheetSide)
        if self.label is not None:
            raise InputError('the shape "cells" is for parts of the body')
        check_positive("thickness", self.thickness, "m")
        check_type(self.wrinkles, bool, "wrinkles must be True or False")
        if isinstance(self.material, str):
            object.__setattr__(self, "material", get_material(self.material))
        check_type(self.material, Material, "material must be a Material or a name of the table")
        known = self.material
        if known.foam or known.viscosity or known.relaxation or known.hysteresis:
            raise InputError(
                "material: a sheet has young, poisson and density alone; remove law, viscosity, relaxation, hysteresis"
            )

    def find_facets(self, mesh: Mesh) -> tuple[Int[np.ndarray, "triangles 3"], Int[np.ndarray, "edges 2"]]:
        """Return the triangles and edges of a mesh that it covers; both faces of a flat body are the same triangles.

        Raises InputError: it covers nothing.
        """
        triangles, edges = (mesh.elements, mesh.boundary) if mesh.dim == 2 else (mesh.boundary, mesh.boundary[:0, :2])
        if self.on is SheetSide.FACES:
            edges = edges[:0]
        if self.on is SheetSide.OUTLINE:
            triangles = triangles[:0]
        triangles, edges = (each[self.holds(mesh.nodes[each].mean(axis=1))] for each in (triangles, edges))
        if not len(triangles) and not len(edges):
            raise InputError("covers no facet of the skin; move or enlarge its region")
        return triangles, edges

    def find_rings(self, mesh: Mesh) -> tuple[Int[np.ndarray, " _"], ...]:
        """Return the nodes along the closed borders of its part of a flat body; empty without faces, and in space."""
        triangles, _ = self.find_facets(mesh)
        return tuple(find_rings(Mesh(mesh.nodes, triangles).boundary)) if mesh.dim == 2 and len(triangles) else ()

    def find_area(self, mesh: Mesh, depth: float | None) -> float:
        """Return its covered area [m^2], on both faces of a flat body of this thickness [m].

        Raises InputError: it covers nothing.
        """
        triangles, edges = self.find_facets(mesh)
        spans = mesh.nodes[triangles[:, 1:]] - mesh.nodes[triangles[:, :1]]
        faces = 0.5 * float(np.sqrt(np.linalg.det(spans @ np.swapaxes(spans, 1, 2))).sum())
        rim = float(np.linalg.norm(np.diff(mesh.nodes[edges], axis=1), axis=2).sum())
        return faces if depth is None else 2 * faces + depth * rim


def check_sheets(sheets: Iterable[Membrane], mesh: Mesh) -> None:
    """Reject sheets that do not fit a body (InputError)."""
    for index, sheet in enumerate(sheets):
        where, most = f"sheet[{index}]", 0.1 * mesh.size
        if sheet.dim > mesh.dim:
            raise InputError(f"{where}: has {sheet.dim} coordinates, but the body has {mesh.dim}")
        if mesh.dim == 3 and sheet.on is not SheetSide.SKIN:
            raise InputError(f"{where}.on is for flat bodies: in space a sheet covers the skin; remove it")
        if sheet.thickness > most:
            raise InputError(
                f"{where}.thickness of {1e3 * sheet.thickness:.4g} mm is above {1e3 * most:.4g} mm, a tenth of the "
                "body: a sheet does not resist bending. Take a [[body.part]]"
            )
        try:
            sheet.find_facets(mesh)
        except InputError as error:
            raise InputError(f'{where}: "{sheet.name}" {error}') from None
