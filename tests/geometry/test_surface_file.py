"""Surface files: what is written is read, by other programs' writers too; what is wrong is told in one line."""

from io import BytesIO

import numpy as np
import pytest
from geometry.dirty import cuboid, sphere, torus
from geometry.surface_writers import (
    archive,
    mesh_xml,
    model_xml,
    obj,
    off,
    ply_big,
    ply_text,
    stl,
    stl_text,
    threemf,
)  # fmt: skip

from hydrostat.errors import SurfaceError
from hydrostat.geometry.files.soup import MAX_BYTES, MAX_TEXT_BYTES
from hydrostat.geometry.files.surface_file import SURFACE_SUFFIXES, read_surface, write_ply
from hydrostat.geometry.healing.heal import heal
from hydrostat.geometry.surface import Surface

WRITERS = {
    "a.stl": stl, "b.STL": stl_text, "c.obj": obj, "d.off": off, "e.ply": ply_text, "f.ply": ply_big, "g.3mf": threemf,
    "h.ply": write_ply,
}  # fmt: skip
_BALL = sphere(divisions=2)


def _same(one: Surface, two: Surface) -> None:
    """The same corners of the same triangles in the same order, as far as float32 in millimeters keeps them."""
    assert len(one.vertices) == len(two.vertices)
    np.testing.assert_allclose(one.vertices[one.triangles], two.vertices[two.triangles], atol=3e-6 * two.size)
    assert one.volume == pytest.approx(two.volume, rel=1e-5)


@pytest.mark.parametrize("name", WRITERS)
def test_what_is_written_is_read(name: str) -> None:
    _same(read_surface(WRITERS[name](_BALL), name=name), _BALL)


@pytest.mark.parametrize("kind", ["stl", "stl_ascii", "obj", "ply", "off", "3mf"])
def test_what_trimesh_writes_is_read(kind: str) -> None:
    trimesh = pytest.importorskip("trimesh")
    if kind == "3mf":
        pytest.importorskip("lxml")
        pytest.importorskip("networkx")
    mesh = trimesh.Trimesh(1e3 * _BALL.vertices, _BALL.triangles, process=False)
    content = mesh.export(file_type=kind)
    content = content.encode() if isinstance(content, str) else content
    name = f"ball.{kind.removesuffix('_ascii')}"
    surface = read_surface(content, name=name)
    assert surface.volume == pytest.approx(_BALL.volume, rel=1e-5)
    assert len(surface.vertices) == len(_BALL.vertices)


@pytest.mark.parametrize(("kind", "binary"), [("stl", True), ("stl", False), ("ply", True), ("ply", False), ("obj", 0)])
def test_what_meshio_writes_is_read(kind: str, binary: bool, tmp_path) -> None:
    import meshio

    path = tmp_path / f"ball.{kind}"
    options = {} if kind == "obj" else {"binary": binary}
    meshio.Mesh(1e3 * _BALL.vertices, [("triangle", _BALL.triangles)]).write(path, **options)
    _same(read_surface(path.read_bytes(), name=path.name), _BALL)


def test_what_we_write_is_read_by_trimesh() -> None:
    """Oracle: an independent reader of PLY."""
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.load(BytesIO(write_ply(_BALL)), file_type="ply", process=False)
    np.testing.assert_allclose(mesh.vertices, 1e3 * _BALL.vertices, atol=1e-5)
    np.testing.assert_array_equal(mesh.faces, _BALL.triangles)


_QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
_CORNERS = [(x, y, z) for x in (0, 10) for y in (0, 20) for z in (0, 30)]


def _quads(kind: str) -> bytes:
    """A box of 10 x 20 x 30 mm of quads; in OBJ counted from the end, over two lines, between vertices."""
    places = [" ".join(map(str, corner)) for corner in _CORNERS]
    faces = [" ".join(map(str, quad)) for quad in _QUADS]
    if kind == "obj":
        faces = ["f " + " ".join(f"{corner - 8}/1/{corner + 1}" for corner in quad) for quad in _QUADS]
        return "\r\n".join([*(f"v {place} 1.0" for place in places), faces[0].replace(" -", " \\\r\n -", 1), *faces[1:]]
                           ).encode()  # fmt: skip
    if kind == "off":
        return "\n".join(["COFF", "8 6 12", *(f"{p} 1 0 0 1" for p in places), *(f"4 {f} 9" for f in faces)]).encode()
    head = ["ply", "format ascii 1.0", "element vertex 8", *(f"property float {axis}" for axis in "xyz")]
    head += ["element face 6", "property list uchar int vertex_indices", "end_header"]
    return "\n".join([*head, *places, *(f"4 {face}" for face in faces)]).encode()


@pytest.mark.parametrize("kind", ["obj", "off", "ply"])
def test_polygons_become_triangles_of_the_same_volume(kind: str) -> None:
    surface = read_surface(_quads(kind), name=f"box.{kind}")
    assert len(surface.triangles) == 12
    assert surface.volume == pytest.approx(10 * 20 * 30 * 1e-9)


@pytest.mark.parametrize("start", range(4))
def test_a_quad_with_a_notch_is_cut_from_the_notch(start: int) -> None:
    """Its area is that of the polygon only if no half of it is folded over the other."""
    notched = np.roll([(0, 0), (10, 0), (2, 2), (0, 10)], start, axis=0)
    text = "".join(f"v {x} {y} 0\n" for x, y in notched) + "f 1 2 3 4\n"
    assert read_surface(text.encode(), name="notch.obj").area == pytest.approx(20e-6)


def test_unit_and_size() -> None:
    content = stl(cuboid((0, 0, 0), (0.01, 0.02, 0.03)))
    assert read_surface(content, name="a.stl").size == pytest.approx(0.03)
    assert read_surface(content, name="a.stl", unit=0.0254).size == pytest.approx(30 * 0.0254)
    assert read_surface(content, name="a.stl", unit=5.0, size=0.19).size == pytest.approx(0.19)


@pytest.mark.parametrize(("unit", "meters"), [("micron", 1e-6), ("inch", 0.0254), ("meter", 1.0), ("foot", 0.3048)])
def test_3mf_has_a_unit_of_its_own(unit: str, meters: float) -> None:
    content = threemf(_BALL, unit, 1 / meters)
    _same(read_surface(content, name="a.3mf"), _BALL)
    assert read_surface(content, name="a.3mf", size=0.5).size == pytest.approx(0.5)


def test_3mf_objects_are_where_they_are_built() -> None:
    """A box, the same mirrored beside it, and one in another part by way of a component: three volumes, one size."""
    box = mesh_xml(cuboid((0, 0, 0), (0.01, 0.01, 0.01)))
    path = 'p:path="/3D/more.model"'
    objects = (
        f'<object id="1">{box}</object><object id="2"><components>'
        f'<component {path} objectid="7" transform="1 0 0 0 1 0 0 0 2 100 0 0"/></components></object>'
        f'<object id="3">{box}</object>'
    )
    items = (
        '<item objectid="1"/><item objectid="1" transform="-1 0 0 0 1 0 0 0 1 -20 0 0"/><item objectid="2" '
        'transform="1 0 0 0 1 0 0 0 1 0 0 5"/>'
    )
    more = model_xml(f'<object id="7">{box}</object>', '<item objectid="7"/>')
    content = archive({"3D/3dmodel.model": model_xml(objects, items), "3D/more.model": more})
    surface = read_surface(content, name="a.3mf")
    assert len(surface.triangles) == 36
    assert surface.volume == pytest.approx((1 + 1 + 2) * 1e-6)
    np.testing.assert_allclose(surface.box, [[-0.03, 0.0, 0.0], [0.11, 0.01, 0.025]], atol=1e-12)


def test_strips_remarks_and_supports() -> None:
    """Oracle: a tetrahedron of 90 x 75 x 60 mm as one strip, and as two; a box without its support."""
    head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    places = "0 0 0\n90 0 0\n45 75 0\n45 25 60\n"
    for strip in ("6 0 2 1 3 0 2", "9 0 2 1 3 -1 1 3 0 2"):
        surface = read_surface(f"{head}{places}{strip}\n".encode(), name="a.ply")
        assert surface.volume == pytest.approx(90 * 75 * 60 / 6 * 1e-9)
    ball = b"# made by hand\n\n# OFF\n" + off(_BALL)
    _same(read_surface(ball, name="a.off"), _BALL)
    _same(read_surface(b"\xef\xbb\xbf" + ball, name="a.off"), _BALL)
    more = read_surface(stl(_BALL) + b"a slicer's words" * 5, name="a.stl")
    _same(more, _BALL)
    assert "found: 80 bytes after the last triangle, left out" in heal(more, resolution=1e-3).lines()
    box, pillar = (mesh_xml(cuboid((0, 0, 0), (0.01, 0.01, height))) for height in (0.01, 0.05))
    for kind in ("support", "solidsupport"):
        objects = f'<object id="1" type="model">{box}</object><object id="2" type="{kind}">{pillar}</object>'
        items = '<item objectid="1"/><item objectid="2"/>'
        content = archive({"3D/3dmodel.model": model_xml(objects, items)})
        surface = read_surface(content, name="a.3mf")
        assert surface.volume == pytest.approx(1e-6)
        healed = heal(surface, resolution=1e-3)
        assert healed.clean
        assert "found: 1 object of type support, left out" in healed.lines()
    objects = objects.replace(' type="solidsupport"', "")
    items = '<item objectid="1"/><item objectid="2" printable="0"/>'
    surface = read_surface(archive({"3D/3dmodel.model": model_xml(objects, items)}), name="a.3mf")
    assert surface.volume == pytest.approx(1e-6)
    assert "found: 1 object not to be printed, left out" in heal(surface, resolution=1e-3).lines()


def test_numbers_in_stl_that_are_the_same_place_are_one_vertex() -> None:
    surface = read_surface(stl(torus()), name="a.stl")
    assert len(surface.vertices) == len(surface.triangles) / 2  # Euler: 0 = V - 3/2 T + T


def _plain(old: str, new: str) -> bytes:
    """Text PLY of one triangle, with one change."""
    return ply_text(Surface(np.eye(3), np.array([[0, 1, 2]]))).replace(old.encode(), new.encode())


_STL, _STL_TEXT, _PLY, _3MF = stl(_BALL), stl_text(_BALL), write_ply(_BALL), threemf(_BALL)
_BOX_XML = mesh_xml(cuboid((0, 0, 0), (0.01, 0.01, 0.01)))


def _model(objects: str, items: str = '<item objectid="1"/>', **options: str) -> bytes:
    return archive({"3D/3dmodel.model": model_xml(objects, items, **options)})


_BAD = {
    "no such format": ("a.iges", b"S      1", "export it as STL"),
    "no suffix": ("body", _STL, "stl, .obj"),
    "empty": ("a.stl", b" \n", "is empty"),
    "too large": ("a.stl", b"x" * (MAX_BYTES + 1), "at most 120 MB"),
    "step as stl": ("a.stl", b"ISO-10303-21;" * 20, "rename it to end with .step"),
    "gltf": ("a.obj", b"glTF\2\0\0\0", "glTF"),
    "ply as stl": ("a.stl", _PLY, "rename it"),
    "3mf as obj": ("a.obj", _3MF, "rename it"),
    "stl as obj": ("a.obj", _STL_TEXT, "rename it"),
    "stl as 3mf": ("a.3mf", _STL, "no 3MF"),
    "off as ply": ("a.ply", off(_BALL), "rename it"),
    "stl cut": ("a.stl", _STL[:-30], "cut short"),
    "stl of no triangles": ("a.stl", _STL[:80] + b"\0" * 4 + _STL[84:], "bytes for"),
    "stl head only": ("a.stl", b"\0" * 50, "too few"),
    "stl none": ("a.stl", b"\0" * 84, "cut short|no triangles"),
    "stl huge": ("a.stl", b"\0" * 80 + b"\xff" * 4 + b"\0" * 50, "declares 4294967295"),
    "stl nan": ("a.stl", _STL[:96] + b"\xff\xff\xff\x7f" + _STL[100:], "not finite"),
    "stl text cut": ("a.stl", _STL_TEXT[:-300], "endsolid"),
    "stl text word": ("a.stl", _STL_TEXT.replace(b"vertex ", b"vertex x", 1), "no number"),
    "stl text long word": ("a.stl", _STL_TEXT.replace(b"vertex ", b"vertex " + b"1" * 100, 1), "three numbers"),
    "stl text two": ("a.stl", b"solid\nfacet\nvertex 0 0 0\nvertex 1 1 1\nendsolid", "no triangles"),
    "stl text none": ("a.stl", b"solid\n" + b" " * 100 + b"endsolid", "no triangles"),
    "obj none": ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no triangles"),
    "obj zero": ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "line 4"),
    "obj range": ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "names vertex 3"),
    "obj back": ("a.obj", b"v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n", "line 3"),
    "obj word": ("a.obj", b"v 0 0 zero\n", "line 1"),
    "obj short": ("a.obj", b"v 0 0\n", "line 1"),
    "obj nan": ("a.obj", b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3", "not finite"),
    "obj line": ("a.obj", b"f" + b" 1" * 600_000, "longer than"),
    "no size": ("a.obj", b"v 5 5 5\nv 5 5 5\nv 5 5 5\nf 1 2 3", "no size"),
    "too far": ("a.obj", b"v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3", "no robot"),
    "too small": ("a.obj", b"v 0 0 0\nv 1e-9 0 0\nv 0 1e-9 0\nf 1 2 3", "no robot"),
    "ply no head": ("a.ply", b"ply\nformat ascii 1.0\n", "head"),
    "ply cut": ("a.ply", _PLY[:-3], "bytes for|cut short"),
    "ply huge": ("a.ply", _PLY.replace(b"element vertex ", b"element vertex 99999999"), "bytes for"),
    "ply huge text": ("a.ply", _plain("element vertex 3", "element vertex 3000000000"), "bytes for"),
    "ply huge list": ("a.ply", _plain("3 0 1 2", "3000000000 0 1 2"), "face 0 of 1"),
    "ply negative": ("a.ply", _plain("element vertex 3", "element vertex -3"), "its head says"),
    "ply twice": ("a.ply", _plain("property double y", "property double x"), "twice"),
    "ply no z": ("a.ply", _plain("property double z", "property double w"), "no x, y and z"),
    "ply points": ("a.ply", _plain("element face 1", "element fact 1"), "cloud of points"),
    "ply strips": ("a.ply", _plain("vertex_indices", "strips"), "vertex_indices"),
    "ply type": ("a.ply", _plain("property double x", "property real x"), "its head says"),
    "ply index nan": ("a.ply", _plain("3 0 1 2", "3 0 1 nan"), "names vertex -1"),
    "ply index far": ("a.ply", _plain("3 0 1 2", "3 0 1 1e300"), "names vertex -1"),
    "off counts": ("a.off", b"OFF\nmany\n", "counts"),
    "off huge": ("a.off", b"OFF\n999999999 999999999 0\n0 0 0\n", "bytes for"),
    "off cut": ("a.off", off(_BALL)[:-60], "ends before|is no face"),
    "off binary": ("a.off", b"OFF BINARY\n\0\0\0\1", "text"),
    "off word": ("a.off", b"OFF 3 1 0\n0 0 0\n1 0 0\n0 one 0\n3 0 1 2\n", "line 4 is no vertex"),
    "3mf cut": ("a.3mf", _3MF[:-40], "no archive"),
    "3mf damaged": ("a.3mf", _3MF[:400] + b"\0" * 200 + _3MF[600:], "no archive|broken"),
    "3mf not one": ("a.3mf", archive({}), "without a 3D model"),
    "3mf xml": ("a.3mf", archive({"3D/3dmodel.model": "<model>"}), "broken"),
    "3mf unit": ("a.3mf", _model(f'<object id="1">{_BOX_XML}</object>', unit="parsec"), "parsec"),
    "3mf entity": ("a.3mf", _model("", extra='<!DOCTYPE model [<!ENTITY a "b">]>'), "entities"),
    "3mf itself": ("a.3mf", _model('<object id="1"><components><component objectid="1"/></components></object>'),
                   "themselves"),
    "3mf missing": ("a.3mf", _model(""), "does not hold"),
    "3mf builds nothing": ("a.3mf", _model("", ""), "builds nothing"),
    "3mf part": ("a.3mf", _model("", '<item objectid="1" p:path="/x.model"/>'), "does not hold"),
    "3mf range": ("a.3mf", _model(f'<object id="1">{_BOX_XML.replace(chr(34) + "7" + chr(34), chr(34) + "9" + chr(34))}'
                                  "</object>"), "does not have"),
    "3mf transform": ("a.3mf", _model(f'<object id="1">{_BOX_XML}</object>',
                                      '<item objectid="1" transform="1 2 3"/>'), "item"),
    "3mf deep": ("a.3mf", _model("<a>" * 60 + "</a>" * 60), "deeper"),
    "3mf bomb": ("a.3mf", _model(" " * (MAX_TEXT_BYTES + 10)), "unpacks to more"),
    "too much text": ("a.obj", b"v 0 0 0\n" * (MAX_TEXT_BYTES // 8 + 1), "MB of text"),
}  # fmt: skip


@pytest.mark.parametrize("case", _BAD)
def test_what_is_wrong_is_told_in_one_line(case: str) -> None:
    name, content, word = _BAD[case]
    with pytest.raises(SurfaceError, match=word) as caught:
        read_surface(content, name=name)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300
    assert str(caught.value).startswith(f"{name}: ")


def _laughs() -> bytes:
    """Objects that hold the one before ten times: a thousand million boxes from a kilobyte."""
    objects = f'<object id="0">{_BOX_XML}</object>'
    for level in range(1, 10):
        parts = f'<component objectid="{level - 1}"/>' * 10
        objects += f'<object id="{level}"><components>{parts}</components></object>'
    return _model(objects, '<item objectid="9"/>')


def test_a_3mf_that_repeats_itself_without_end_is_refused() -> None:
    with pytest.raises(SurfaceError, match=r"too many others|at most 2000000"):
        read_surface(_laughs(), name="a.3mf")


@pytest.mark.parametrize(("unit", "size"), [(0.0, None), (1e-3, -1.0), (float("nan"), None), (1e-3, float("inf"))])
def test_units_and_sizes_are_above_0(unit: float, size: float | None) -> None:
    with pytest.raises(SurfaceError, match="above 0"):
        read_surface(_STL, name="a.stl", unit=unit, size=size)


def test_all_formats_are_named() -> None:
    assert set(SURFACE_SUFFIXES) == {".stl", ".obj", ".ply", ".off", ".3mf"}
