"""Meshes from and to files, by meshio."""

import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from hydrostat.errors import InputError
from hydrostat.geometry.mesh import Mesh


def read_mesh(path: Path, *, unit: float = 1.0, size: float | None = None) -> Mesh:
    """Mesh of tetrahedra, or of triangles if there are none, from any file that meshio knows.

    Args:
        path: the file.
        unit: metres that one coordinate counts.
        size: longest side of the bounding box [m] to scale to, instead of `unit`.

    Raises:
        InputError: the file cannot be read or holds neither tetrahedra nor flat triangles.
    """
    import meshio

    try:
        data = meshio.read(path)
    except (meshio.ReadError, SystemExit, ValueError, KeyError, IndexError, OSError, UnicodeDecodeError) as error:
        reason = str(error).strip().splitlines()
        raise InputError(
            f"{path.name}: no mesh can be read from it ({reason[0] if reason else 'damaged file'})"
        ) from None
    for kind, dim in (("tetra", 3), ("triangle", 2)):
        if kind in data.cells_dict:
            return _simplices(path.name, data.points, data.cells_dict[kind], dim, unit, size)
    raise InputError(f"{path.name}: holds neither tetrahedra nor triangles")


def _simplices(name: str, points: np.ndarray, cells: np.ndarray, dim: int, unit: float, size: float | None) -> Mesh:
    used, elements = np.unique(cells, return_inverse=True)
    elements = elements.reshape(cells.shape).astype(np.int64)
    nodes = np.array(points[used], dtype=float)
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
