"""Meshes from and to files, by meshio."""

import sys
from collections.abc import Mapping
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.geometry.mesh import Mesh


def read_mesh(path: Path, *, unit: float = 1.0, size: float | None = None) -> Mesh:
    """Mesh of tetrahedra, or of triangles if there are none, from a VTK, VTU or Gmsh file.

    Args:
        path: the file.
        unit: metres that one coordinate counts.
        size: longest side of the bounding box [m] to scale to, instead of `unit`.

    Raises:
        InputError: the file cannot be read or holds neither tetrahedra nor flat triangles.
    """
    if path.suffix.lower() not in _FORMATS:
        raise InputError(f"{path.name}: meshes are read from {', '.join(_FORMATS)} files only")
    data = _read(path)
    for kind, dim in (("tetra", 3), ("triangle", 2)):
        if kind in data.cells_dict:
            return _simplices(path.name, data.points, data.cells_dict[kind], dim, unit, size)
    raise InputError(f"{path.name}: holds neither tetrahedra nor triangles")


_FORMATS = {".vtk": "vtk", ".vtu": "vtu", ".msh": "gmsh"}
"""Endings, and meshio's names of the formats."""


def _read(path: Path) -> Any:
    """What meshio makes of a file, in silence; whatever a damaged file does to it is told in one line."""
    import meshio

    try:
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()), np.errstate(all="ignore"):
            return meshio.read(path, file_format=_FORMATS[path.suffix.lower()])
    except (Exception, SystemExit) as error:  # noqa: BLE001  a damaged file breaks meshio in any way there is
        reason = str(error).strip().splitlines()
        raise InputError(
            f"{path.name}: no mesh can be read from it ({reason[0] if reason else 'damaged file'})"
        ) from None


def _simplices(name: str, points: np.ndarray, cells: np.ndarray, dim: int, unit: float, size: float | None) -> Mesh:
    if cells.min(initial=0) < 0 or cells.max(initial=-1) >= len(points):
        raise InputError(f"{name}: an element names a node that the file does not have")
    used, elements = np.unique(cells, return_inverse=True)
    elements = elements.reshape(cells.shape).astype(np.int64)
    nodes = np.array(points[used], dtype=float)
    if not np.isfinite(nodes).all():
        raise InputError(f"{name}: a coordinate is not a finite number")
    if dim == 2 and nodes.shape[1] == 3 and np.ptp(nodes[:, 2]) > 1e-9 * np.ptp(nodes):
        raise InputError(f"{name}: its triangles do not lie in a plane of constant z; a body in space needs tetrahedra")
    nodes = nodes[:, :dim] * unit
    if size is not None:
        nodes = nodes * (size / np.ptp(nodes, axis=0).max())
    corners = nodes[elements]
    flipped = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
    elements[flipped] = elements[flipped][:, [1, 0, *range(2, dim + 1)]]
    return Mesh(nodes, elements)


def write_mesh(path: Path, mesh: Mesh, nodes: np.ndarray, point_data: Mapping[str, np.ndarray]) -> None:
    """Write a mesh with its nodes moved to `nodes` [m] as VTU, which ParaView opens."""
    import meshio

    kind = "triangle" if mesh.dim == 2 else "tetra"
    data = meshio.Mesh(
        _in_space(nodes), [(kind, mesh.elements)], {key: _in_space(array) for key, array in point_data.items()}
    )
    meshio.write(path, data, file_format="vtu", binary=sys.byteorder == "little")


def _in_space(array: np.ndarray) -> np.ndarray:
    """Vectors of the plane with a third component zero, which VTK wants."""
    return np.pad(array, ((0, 0), (0, 1))) if array.ndim == 2 and array.shape[1] == 2 else array
