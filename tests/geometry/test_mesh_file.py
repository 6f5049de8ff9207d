"""Mesh files: what meshio, an independent program, writes and reads; what is wrong is told in one line."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.geometry.files.mesh_file import read_labeled_mesh
from hydrostat.geometry.files.vtu_file import write_vtu

_NODES = np.array([[0, 0, 0], [10, 0, 0], [0, 20, 0], [0, 0, 30], [10, 20, 30.5]], dtype=float)
_TETRAHEDRA = np.array([[0, 1, 2, 3], [1, 4, 2, 3]])
_TRIANGLES = np.array([[0, 1, 2], [1, 4, 2]])

FORMATS = {
    "vtk 5.1 bytes": (".vtk", "vtk", {"binary": True}),
    "vtk 5.1 text": (".vtk", "vtk", {"binary": False}),
    "vtk 4.2 bytes": (".vtk", "vtk42", {"binary": True}),
    "vtk 4.2 text": (".vtk", "vtk42", {"binary": False}),
    "vtu zlib": (".vtu", "vtu", {"binary": True}),
    "vtu base64": (".vtu", "vtu", {"binary": True, "compression": None}),
    "vtu text": (".vtu", "vtu", {"binary": False}),
    "msh 4.1 bytes": (".msh", "gmsh", {"binary": True}),
    "msh 4.1 text": (".msh", "gmsh", {"binary": False}),
    "msh 2.2 bytes": (".msh", "gmsh22", {"binary": True}),
    "msh 2.2 text": (".msh", "gmsh22", {"binary": False}),
}
"""Ending, meshio's name, and its options."""


def written(folder: Path, kind: str) -> Path:
    """A file of two tetrahedra, and other cells among them, by meshio."""
    import meshio

    suffix, name, options = FORMATS[kind]
    path = folder / f"{kind.replace(' ', '_')}{suffix}"
    cells = [("vertex", np.array([[4]])), ("line", np.array([[0, 1], [1, 2]])), ("tetra", _TETRAHEDRA)]
    mesh = meshio.Mesh(_NODES, cells[2:] if name == "gmsh" else [*cells, ("triangle", _TRIANGLES)])
    mesh.point_data = {"u": np.arange(5.0)}
    if "gmsh" in name:
        tags = [np.ones(len(block), dtype=np.int32) for block in mesh.cells]
        mesh.cell_data = dict.fromkeys(("gmsh:physical", "gmsh:geometrical"), tags)
    meshio.write(path, mesh, file_format=name, **options)
    return path


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("kind", FORMATS)
def test_what_meshio_writes_is_read(kind: str, tmp_path: Path, capsys) -> None:
    mesh = read_labeled_mesh(written(tmp_path, kind), unit=1e-3)[0]
    assert mesh.nodes.shape == (5, 3)
    volumes = np.linalg.det(mesh.nodes[mesh.elements][:, 1:] - mesh.nodes[mesh.elements][:, :1]) / 6
    expected = np.abs(np.linalg.det(_NODES[_TETRAHEDRA][:, 1:] - _NODES[_TETRAHEDRA][:, :1])) / 6
    np.testing.assert_allclose(volumes, 1e-9 * expected, rtol=1e-12)
    np.testing.assert_array_equal(np.sort(mesh.elements), np.sort(_TETRAHEDRA))


GMSH = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 7 "skin"
3 7 "soft bone"
$EndPhysicalNames
$Entities
1 1 0 2
1 0 0 0 0
1 0 0 0 1 1 1 0 1 1
5 0 0 0 1 1 1 1 7 0
6 0 0 0 1 1 1 0 1 1
$EndEntities
$Nodes
1 5 1 5
3 5 0 5
1
2
3
4
5
0 0 0
10 0 0
0 20 0
0 0 30
10 20 30.5
$EndNodes
$Elements
2 2 1 2
3 6 4 1
1 1 2 3 4
3 5 4 1
2 2 5 3 4
$EndElements
"""


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("kind", ["msh 2.2 bytes", "msh 2.2 text", "vtu zlib", "vtu text"])
def test_labels_of_elements_are_read(kind: str, tmp_path: Path) -> None:
    """Of a tetrahedron with 7 and one with 9, by meshio; numbers with a fraction are no labels."""
    import meshio

    suffix, name, options = FORMATS[kind]
    cells: Any = [("triangle", _TRIANGLES), ("tetra", _TETRAHEDRA)]
    tags = [np.array([5, 5], dtype=np.int32), np.array([7, 9], dtype=np.int32)]
    data: Any = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    if suffix == ".vtu":
        data = {"material": tags, "share": [values / 2 for values in tags]}
    groups = {"bone": np.array([9, 3]), "skin": np.array([7, 2])}
    mesh = meshio.Mesh(_NODES, cells, cell_data=data, field_data=groups if suffix == ".msh" else {})
    meshio.write(tmp_path / f"a{suffix}", mesh, file_format=name, **options)
    array = "physical" if suffix == ".msh" else "material"
    expected = {f"{array}=7": [0], "7": [0], f"{array}=9": [1], "9": [1]}
    found = read_labeled_mesh(tmp_path / f"a{suffix}")[1]
    assert {key: own.tolist() for key, own in found.items()} == expected | ({"bone": [1]} if suffix == ".msh" else {})


def test_labels_of_gmsh_are_read(tmp_path: Path) -> None:
    """Version 4.1 has the groups of an element by its entity; written by hand after Gmsh's manual."""
    (tmp_path / "a.msh").write_text(GMSH)
    found = read_labeled_mesh(tmp_path / "a.msh")[1]
    assert {key: own.tolist() for key, own in found.items()} == {
        "physical=0": [0], "0": [0], "physical=7": [1], "7": [1], "soft bone": [1]
    }  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('2 7 "skin"', "2 7 skin", "has a physical name that is not understood"),
        ("1 1 0 2\n1 0 0", "1 1 0 -2\n1 0 0", "declares 1 entities"),
        ("5 0 0 0 1 1 1 1 7 0", "5 0 0 0 1 1 1 9000 7 0", "declares 9000 numbers"),
    ],
)
def test_damaged_groups_are_told(old: str, new: str, told: str, tmp_path: Path) -> None:
    assert old in GMSH
    (tmp_path / "a.msh").write_text(GMSH.replace(old, new))
    with pytest.raises(InputError, match=told):
        read_labeled_mesh(tmp_path / "a.msh")


@pytest.mark.parametrize(("kind", "suffix"), [("vtu text", ".vtk"), ("vtk 4.2 text", ".vtu")])
def test_a_kind_under_the_name_of_the_other_is_read(kind: str, suffix: str, tmp_path: Path) -> None:
    path = written(tmp_path, kind)
    assert len(read_labeled_mesh(path.rename(path.with_suffix(suffix)), unit=1e-3)[0].elements) == len(_TETRAHEDRA)


def test_a_block_without_elements_is_passed_over(tmp_path: Path) -> None:
    path = written(tmp_path, "msh 4.1 text")
    lines = path.read_text().splitlines()
    head = lines.index("$Elements") + 1
    blocks, *rest = lines[head].split()
    lines[head : head + 1] = [" ".join([str(int(blocks) + 1), *rest]), "3 1 4 0"]
    path.write_text("\n".join(lines) + "\n")
    assert len(read_labeled_mesh(path, unit=1e-3)[0].elements) == len(_TETRAHEDRA)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("copies", [1, 1024])
def test_what_is_written_is_read_by_us_and_by_meshio(dim: int, copies: int, tmp_path: Path) -> None:
    """Nodes, elements and numbers at the nodes, bit for bit; packed in one block, and in many, the last full."""
    import meshio

    corners = np.vstack([np.zeros(dim), np.eye(dim)])
    nodes = np.concatenate([1e-3 * (corners + 1 / 3 + number) for number in range(copies)])
    mesh = Mesh(nodes, np.arange(len(nodes)).reshape(copies, dim + 1))
    moved = nodes + 0.1
    data = {"rest": nodes, 'height & "depth"': np.arange(len(nodes)), "whole": np.full((len(nodes), 3), np.pi)}
    (tmp_path / "a.vtu").write_bytes(write_vtu(mesh, moved, data))
    again, other = read_labeled_mesh(tmp_path / "a.vtu")[0], meshio.read(tmp_path / "a.vtu")
    for read, elements in (
        (again.nodes, again.elements),
        (other.points, other.cells_dict[("triangle", "tetra")[dim - 2]]),
    ):
        np.testing.assert_array_equal(read[:, :dim], moved)
        np.testing.assert_array_equal(elements, mesh.elements)
    assert other.points.shape == (len(nodes), 3)
    assert other.point_data.keys() == data.keys()
    for name, values in data.items():
        found = other.point_data[name]
        assert found.dtype == values.dtype
        np.testing.assert_array_equal(found[:, :dim] if name == "rest" else found, values)
    assert not other.points[:, dim:].any()
    assert not other.point_data["rest"][:, dim:].any()


def test_the_same_mesh_gives_the_same_bytes() -> None:
    mesh = Mesh(1e-3 * _NODES[:4], np.array([[0, 1, 2, 3]]))
    assert write_vtu(mesh, mesh.nodes, {}) == write_vtu(mesh, mesh.nodes, {})


def _vtu(encoding: str, order: str = "LittleEndian", packed: bool = False) -> bytes:
    """A tetrahedron in a VTU file with appended data, as ParaView writes it."""
    import base64
    import zlib

    end = "<" if order == "LittleEndian" else ">"
    arrays = [("points", "Float32", _NODES[:4].astype(end + "f4")), ("connectivity", "Int32", np.arange(4)),
              ("offsets", "Int64", np.array([4])), ("types", "UInt8", np.array([10]))]  # fmt: skip
    kinds = {"Float32": "f4", "Int32": "i4", "Int64": "i8", "UInt8": "u1"}
    tags, data = {}, b""
    for name, kind, values in arrays:
        content = values.astype(end + kinds[kind]).tobytes()
        head = np.array([len(content)], dtype=end + "u4").tobytes()
        if packed:
            half = -(-len(content) // 2)
            blocks = [zlib.compress(content[:half]), zlib.compress(content[half:])]
            head = np.array([2, half, len(content) - half, *map(len, blocks)], dtype=end + "u4").tobytes()
            content = b"".join(blocks)
        tags[name] = f'<DataArray type="{kind}" Name="{name}" format="appended" offset="{len(data)}"/>'
        if encoding == "raw":
            data += head + content
        else:
            data += base64.b64encode(head) + base64.b64encode(content) if packed else base64.b64encode(head + content)
    cells = tags["connectivity"] + tags["offsets"] + tags["types"]
    compressor = ' compressor="vtkZLibDataCompressor"' if packed else ""
    return (
        f'<VTKFile type="UnstructuredGrid" byte_order="{order}"{compressor}><UnstructuredGrid>'
        f'<Piece NumberOfPoints="4" NumberOfCells="1"><Points>{tags["points"]}</Points><Cells>{cells}</Cells></Piece>'
        f'</UnstructuredGrid><AppendedData encoding="{encoding}">\n _'
    ).encode() + data + b"\n</AppendedData></VTKFile>"  # fmt: skip


@pytest.mark.parametrize("encoding", ["raw", "base64"])
@pytest.mark.parametrize("order", ["LittleEndian", "BigEndian"])
@pytest.mark.parametrize("packed", [False, True])
def test_appended_data_of_vtu(encoding: str, order: str, packed: bool, tmp_path: Path) -> None:
    path = tmp_path / "a.vtu"
    path.write_bytes(_vtu(encoding, order, packed))
    np.testing.assert_array_equal(read_labeled_mesh(path)[0].nodes, _NODES[:4])


_ROBOTS = Path(__file__).parents[3] / "shared" / "robots"


@pytest.mark.parametrize("name", ["finger/finger.vtk", "trunk/trunk.vtk", "diamond/diamond.vtu"])
def test_real_robots_are_read_as_meshio_reads_them(name: str) -> None:
    import meshio

    if not (_ROBOTS / name).exists():
        pytest.skip("the robots of SOFA are not here")
    expected, mesh = meshio.read(_ROBOTS / name), read_labeled_mesh(_ROBOTS / name)[0]
    tetrahedra = expected.cells_dict["tetra"]
    np.testing.assert_array_equal(mesh.nodes, expected.points[np.unique(tetrahedra)])
    np.testing.assert_array_equal(np.sort(np.unique(tetrahedra)[mesh.elements]), np.sort(tetrahedra))


_HEAD = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n"
_TEXT = _HEAD + "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
_MSH = (
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n7 0 0 1\n$EndNodes\n"
    "$Elements\n2\n1 15 2 0 1 1\n2 4 2 0 1 1 2 3 7\n$EndElements\n"
)
_BAD = {
    "no such format": ("a.inp", "x", "meshes are read from"),
    "empty": ("a.vtk", "", "VTK"),
    "grid": ("a.vtk", _TEXT.replace("UNSTRUCTURED_GRID", "STRUCTURED_POINTS"), "unstructured grid"),
    "huge": ("a.vtk", _TEXT.replace("POINTS 4", "POINTS 4000000000"), "bytes for"),
    "negative": ("a.vtk", _TEXT.replace("CELLS 1", "CELLS -1"), "do not fit"),
    "huge cell": ("a.vtk", _TEXT.replace("4 0 1", "400000000 0 1"), "do not fit"),
    "word": ("a.vtk", _TEXT.replace("1 0 0", "1 zero 0"), "text where numbers"),
    "nan": ("a.vtk", _TEXT.replace("1 0 0", "1 nan 0"), "not a finite"),
    "cut": ("a.vtk", _TEXT[:-16], "ends"),
    "range": ("a.vtk", _TEXT.replace("4 0 1 2 3", "4 0 1 2 9"), "does not have"),
    "index": ("a.vtk", _TEXT.replace("4 0 1 2 3", "4 0 1 2 1e300"), "does not have"),
    "other cells": ("a.vtk", _TEXT.replace("\n10\n", "\n9\n"), "neither"),
    "sections": ("a.vtk", _HEAD + "POINTS 0 float\n" * 200, "too many"),
    "xml": ("a.vtu", "<VTKFile", "XML is broken"),
    "vtu kind": ("a.vtu", '<VTKFile type="PolyData"/>', "unstructured grid"),
    "entity": ("a.vtu", '<!DOCTYPE a [<!ENTITY a "b">]><VTKFile type="UnstructuredGrid"/>', "entities"),
    "no piece": ("a.vtu", '<VTKFile type="UnstructuredGrid"/>', "no piece"),
    "lzma": ("a.vtu", '<VTKFile type="UnstructuredGrid" compressor="vtkLZMADataCompressor"/>', "zlib"),
    "msh version": ("a.msh", _MSH.replace("2.2", "4.0"), "version 4.0"),
    "msh huge": ("a.msh", _MSH.replace("$Nodes\n4", "$Nodes\n40000000000"), "bytes for"),
    "msh tag": ("a.msh", _MSH.replace("3 7", "3 8"), "does not have"),
    "msh kind": ("a.msh", _MSH.replace("2 4 2", "2 77 2"), "not known"),
    "msh few": ("a.msh", _MSH.replace("$Elements\n2", "$Elements\n1"), "do not fit"),
    "msh cut": ("a.msh", _MSH[:-20], "not whole|ends|has no"),
}


@pytest.mark.parametrize("case", _BAD)
def test_what_is_wrong_is_told_in_one_line(case: str, tmp_path: Path) -> None:
    name, content, word = _BAD[case]
    (tmp_path / name).write_text(content)
    with pytest.raises(InputError, match=word) as caught:
        read_labeled_mesh(tmp_path / name)[0]
    assert "\n" not in str(caught.value)


def test_the_good_ones_are_good(tmp_path: Path) -> None:
    """What the bad cases are made of can be read, with sparse tags, too."""
    for name, content in (("a.vtk", _TEXT), ("a.msh", _MSH)):
        (tmp_path / name).write_text(content)
        np.testing.assert_array_equal(read_labeled_mesh(tmp_path / name)[0].nodes, np.vstack([np.zeros(3), np.eye(3)]))
