"""Meshes from files, by our own lines, which believe no count before the bytes for it are there."""

from pathlib import Path

import numpy as np

from hydrostat.arrays import Int
from hydrostat.errors import InputError
from hydrostat.files import read_stranger
from hydrostat.geometry.files.msh_file import read_msh
from hydrostat.geometry.files.vtk_file import read_vtk
from hydrostat.geometry.files.vtu_file import read_vtu
from hydrostat.geometry.mesh import Mesh


def read_labeled_mesh(
    path: Path, *, unit: float = 1.0, size: float | None = None
) -> tuple[Mesh, dict[str, Int[np.ndarray, " _"]]]:
    """Mesh of tetrahedra, or of triangles if there are none, from a VTK, VTU or Gmsh file, and its labels.

    Labels are physical groups of MSH files and whole numbers in the cell data of VTU files, each with the indices of
    its elements: "bone" for a group with a name, "physical=3", and "3" if its array is the only one, or that of
    physical groups.

    A coordinate counts `unit` meters, unless the longest side of the bounding box is to be `size` [m]. Raises
    InputError if the file cannot be read or holds neither tetrahedra nor flat triangles.
    """
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path.name}: meshes are read from {', '.join(_READERS)} files only")
    content = read_stranger(path, name=path.name)
    if reader in (read_vtk, read_vtu):  # either kind is found under either name
        begin = content[:100].lstrip().lower()
        reader = read_vtu if begin.startswith(b"<") else read_vtk if begin.startswith(b"# vtk") else reader
    cells = reader(content, path.name)
    for kind, (elements, dim) in enumerate(((cells.tetrahedra, 3), (cells.triangles, 2))):
        if len(elements):
            mesh = _simplices(path.name, cells.points, elements, dim, unit, size)
            return mesh, _find_labels(cells.labels[kind], cells.names[kind])
    raise InputError(f"{path.name}: holds neither tetrahedra nor triangles")


def _find_labels(arrays: dict[str, np.ndarray], names: dict[str, int]) -> dict[str, Int[np.ndarray, " _"]]:
    """Elements of each label; arrays with many values, such as numbers of elements, are passed over."""
    most_labels, found = 1000, {}
    known = {name: values for name, values in arrays.items() if len(np.unique(values)) <= most_labels}
    main = next((name for name in ("physical", "gmsh:physical") if name in known), "")
    for name, values in known.items():
        for value in np.unique(values).tolist():
            own = np.flatnonzero(values == value)
            found[f"{name}={value}"] = own
            if name == main or len(known) == 1:
                found[str(value)] = own
    return found | {name: found[str(tag)] for name, tag in names.items() if str(tag) in found}


_READERS = {".vtk": read_vtk, ".vtu": read_vtu, ".msh": read_msh}


def _simplices(name: str, points: np.ndarray, cells: np.ndarray, dim: int, unit: float, size: float | None) -> Mesh:
    if cells.min(initial=0) < 0 or cells.max(initial=-1) >= len(points):
        raise InputError(f"{name}: an element names a node that the file does not have")
    used, elements = np.unique(cells, return_inverse=True)
    elements = elements.reshape(cells.shape).astype(np.int64)
    nodes = np.array(points[used], dtype=float)
    if not (np.abs(nodes) < 1e100).all():
        raise InputError(f"{name}: a coordinate is not a finite number below 1e100: save the mesh again")
    if dim == 2 and nodes.shape[1] == 3 and np.ptp(nodes[:, 2]) > 1e-9 * np.ptp(nodes):
        raise InputError(f"{name}: its triangles do not lie in a plane of constant z; a body in space needs tetrahedra")
    nodes = nodes[:, :dim] * unit
    if size is not None:
        nodes = nodes * (size / max(float(np.ptp(nodes, axis=0).max()), 1e-100))
    corners = nodes[elements]
    flipped = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
    elements[flipped] = elements[flipped][:, [1, 0, *range(2, dim + 1)]]
    return Mesh(nodes, elements)
