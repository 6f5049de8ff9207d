"""`Body`: the soft part of a robot, its file and its mesh."""

from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Points
from hydrostat.errors import InputError
from hydrostat.geometry.anchors import locate
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.outline import Outline
from hydrostat.robot.material import Material


class Source(StrEnum):
    """What kind of file a body comes from; also its key in robot.toml."""

    OUTLINE = "outline"
    MESH = "mesh"


@dataclass(frozen=True, kw_only=True)
class Body:
    """A meshed body. Two bodies are equal when they come from the same file and numbers.

    Attributes:
        source: what the file holds.
        file: its name in the robot's folder.
        content: its bytes, so that a robot can be saved anywhere.
        material: what it is made of.
        size: longest side of the bounding box [m]; None: as the file says.
        element_size: length of a mesh edge [m]; None for a ready mesh.
        thickness: of a flat body [m]; None in space.
        mesh: nodes and elements.
        outline: of a flat body that was drawn.
    """

    source: Source
    file: str
    content: bytes = field(repr=False)
    material: Material
    size: float | None = None
    element_size: float | None = None
    thickness: float | None = None
    mesh: Mesh = field(compare=False, repr=False)
    outline: Outline | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if (self.mesh.dim == 2) != (self.thickness is not None):
            raise InputError("a flat body needs a thickness, a body in space has none")
        if self.thickness is not None and not self.thickness > 0:
            raise InputError(f"thickness must be above 0, not {self.thickness:g} m")

    def distances(self, points: Points) -> Float[np.ndarray, " points"]:
        """How far points lie outside the body [m], 0 inside its drawing or its mesh."""
        distances = locate(self.mesh, points).distances
        if self.outline is None:
            return distances
        from shapely import distance
        from shapely import points as shapely_points

        return np.where(distances > 0, distance(self.outline.polygon, shapely_points(points)), 0.0)


def outline_body(
    content: bytes,
    *,
    file: str,
    material: Material,
    element_size: float,
    thickness: float,
    size: float | None = None,
) -> Body:
    """Body from the bytes of an SVG drawing.

    Raises:
        InputError: the drawing is no closed outline, or a number is out of its range.
    """
    from hydrostat.geometry.svg import read_svg
    from hydrostat.geometry.triangulate import triangulate

    outline = read_svg(content, name=file, size=size)
    return Body(
        source=Source.OUTLINE,
        file=file,
        content=content,
        material=material,
        size=size,
        element_size=element_size,
        thickness=thickness,
        mesh=triangulate(outline, element_size),
        outline=outline,
    )


def mesh_body(
    path: Path, *, unit: float, material: Material, size: float | None = None, thickness: float | None = None
) -> Body:
    """Body from a ready mesh of triangles or tetrahedra whose coordinates count `unit` metres each.

    Raises:
        InputError: the file cannot be read or holds no such mesh.
    """
    from hydrostat.geometry.mesh_file import read_mesh

    return Body(
        source=Source.MESH,
        file=path.name,
        content=path.read_bytes(),
        material=material,
        size=size,
        thickness=thickness,
        mesh=read_mesh(path, unit=unit, size=size),
    )
