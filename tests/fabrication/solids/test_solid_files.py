"""STL and 3MF as other people's programs read them."""

import io
import zipfile

import lib3mf
import numpy as np
import pytest
import trimesh
from manifold3d import Manifold

from hydrostat.fabrication.solids.construct import Box, Cylinder, solid_of
from hydrostat.fabrication.solids.print_files import stl_bytes, three_mf_plates
from hydrostat.fabrication.solids.printed import Printed, file_mesh, loose_edges, triangles_of


def three_mf_bytes(parts: tuple[Printed, ...], title: str) -> bytes:
    """All on one large bed."""
    (content,) = three_mf_plates(parts, title, bed=(2000.0, 2000.0))
    return content


def plate(**others) -> Printed:
    model = Box((40, 30, 3)) - Cylinder(9, 3).move(20, 15, -1)
    return Printed(**{"name": "plate", "title": "Plate <A> & 'B'", "solid": solid_of(model), "model": model} | others)


def ball(radius: float, sides: int = 40) -> Manifold:
    return Manifold.sphere(radius, sides).translate((0, 0, radius))


def skins() -> Manifold:
    """A half ball that keeps a skin of 0.000002 mm on the other half: thinner than 32 bits can tell."""
    off = 2e-6
    return ball(30) - (ball(30).rotate((off, off, 0)).translate((off, 0, off)) ^ Manifold.cube((90, 90, 90), True))


def drilled() -> Manifold:
    body = Manifold.cube((200, 200, 20))
    for number in range(12):
        tool = Manifold.cylinder(30, 3, 3, 48).rotate((3 * number, 7 * number, 0))
        body = body - tool.translate((15 * number + 0.1, 15 * number + 0.2, 5))
    return body


NASTY = {
    "small": Manifold.sphere(0.05, 32),
    "far": (ball(20, 96) - ball(15, 96).translate((3, 2, 4))).translate((900, 900, 0)),
    "drilled": drilled(),
    "lapped": Manifold.cube((10, 10, 10)) + Manifold.cube((10, 10, 10)).translate((10 - 1e-6, 3, 3)),
    "nearly the same twice": ball(30) + ball(30).translate((1e-6, 2e-6, 0)).rotate((1e-5, 0, 1e-5)),
    "ball on ball": ball(30).translate((20, 0, 0)) + ball(30) - ball(30).translate((20 + 3e-6, 3e-6, 0)),
    "touching in an edge": Manifold.cube((10, 10, 10)) + Manifold.cube((10, 10, 10)).translate((10, 10, 0)),
}


@pytest.mark.parametrize("name", NASTY)
@pytest.mark.parametrize("write", ["stl", "3mf"])
def test_what_is_written_is_closed_and_keeps_its_volume(name, write):
    """Oracle: trimesh, which joins corners by their place alone."""
    printed = Printed(name="part", title=name, solid=NASTY[name])
    content = stl_bytes(printed) if write == "stl" else three_mf_bytes((printed,), name)
    seen = trimesh.load_mesh(io.BytesIO(content), file_type=write)
    assert seen.is_watertight
    assert seen.is_winding_consistent
    assert seen.volume == pytest.approx(printed.volume, rel=1e-4)


def test_rounding_opens_what_is_written_carelessly():
    """That the test above can fail: the same balls, rounded and joined by place, are open to the same reader."""
    vertices, triangles = triangles_of(NASTY["ball on ball"])
    careless = trimesh.Trimesh(vertices.astype(np.float32), triangles, process=True)
    assert not careless.is_watertight


def test_no_triangle_without_three_corners_and_no_vertex_twice():
    """Oracle: counting."""
    for solid in NASTY.values():
        vertices, triangles = file_mesh(solid)
        assert len(np.unique(vertices.astype(np.float32), axis=0)) == len(vertices)
        assert all(len(set(triangle)) == 3 for triangle in triangles.tolist())
        assert loose_edges(triangles) == 0


def test_edges_are_counted_with_their_direction():
    """Oracle: a tetrahedron on paper: closed; with a face turned round 3 edges are wrong, without one as many."""
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    assert loose_edges(faces) == 0
    assert loose_edges(np.concatenate([faces[:3], faces[3:, ::-1]])) == 3
    assert loose_edges(faces[:3]) == 3
    assert loose_edges(np.concatenate([faces, faces])) == 6


def test_an_stl_names_its_part_and_points_outwards():
    content = stl_bytes(plate())
    assert content.startswith(b"hydrostat plate [mm]")
    assert len(content) == 84 + 50 * int.from_bytes(content[80:84], "little")
    normals = np.frombuffer(content, dtype=np.dtype([("numbers", "<f4", 12), ("rest", "<u2")]), offset=84)["numbers"]
    seen = trimesh.load_mesh(io.BytesIO(content), file_type="stl", process=False)
    np.testing.assert_allclose(normals[:, :3], seen.face_normals, atol=1e-5)
    np.testing.assert_allclose(seen.extents, [40, 30, 3], rtol=1e-6)


def strictly_read(content: bytes):
    reader_of = lib3mf.get_wrapper()
    model = reader_of.CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromBuffer(content)
    assert reader.GetWarningCount() == 0
    return model


def built(model) -> list:
    items = model.GetBuildItems()
    found = []
    while items.MoveNext():
        found.append(items.GetCurrent())
    return found


def objects(model) -> list:
    every = model.GetMeshObjects()
    found = []
    while every.MoveNext():
        found.append(every.GetCurrentMeshObject())
    return found


def test_a_3mf_reads_strictly_with_titles_counts_and_unit():
    """Oracle: lib3mf, the reader of the 3MF Consortium, strict."""
    pin = Printed(name="pin", title="Pin", solid=solid_of(Cylinder(8, 2)), count=5)
    model = strictly_read(three_mf_bytes((plate(count=2), pin), "Kit & caboodle <1>"))
    assert model.GetUnit() == lib3mf.ModelUnit.MilliMeter
    assert model.GetMetaDataGroup().GetMetaDataByKey("", "Title").GetValue() == "Kit & caboodle <1>"
    seen = objects(model)
    assert [(each.GetName(), each.GetPartNumber()) for each in seen] == [("Plate <A> & 'B'", "plate"), ("Pin", "pin")]
    assert all(each.IsManifoldAndOriented() for each in seen)
    assert [item.GetObjectResource().GetName() for item in built(model)].count("Pin") == 5
    assert len(built(model)) == 7


def boxes_on_bed(content: bytes) -> np.ndarray:
    """Low and high corners of each thing that is built, where it is built."""
    boxes = []
    model = strictly_read(content)
    for item in built(model):
        mesh = item.GetObjectResource()
        points = np.array([list(vertex.Coordinates) for vertex in mesh.GetVertices()])
        transform = np.array([list(row) for row in item.GetObjectTransform().Fields])
        placed = points @ transform[:3] + transform[3]
        boxes.append([placed.min(axis=0), placed.max(axis=0)])
    return np.array(boxes)


def apart(boxes: np.ndarray) -> bool:
    return all(
        (one[0][:2] > other[1][:2]).any() or (other[0][:2] > one[1][:2]).any()
        for number, one in enumerate(boxes)
        for other in boxes[:number]
    )


def test_parts_lie_apart_on_beds_that_hold_them():
    """Oracle: lib3mf's transforms of its vertices; nine plates of 40 x 30 mm and 40 pins of 14 mm on 150 x 100 mm."""
    pin = Printed(name="pin", title="Pin", solid=solid_of(Cylinder(8, 7)), count=40)
    beds = [boxes_on_bed(content) for content in three_mf_plates((pin, plate(count=9)), "kit", bed=(150.0, 100.0))]
    assert sum(map(len, beds)) == 49
    assert len(beds) == 2
    for boxes in beds:
        assert apart(boxes)
        assert (boxes[:, 1, :2].max(axis=0) <= np.array([150, 100]) + 1e-3).all()
        np.testing.assert_allclose(boxes[:, 0].min(axis=0), 0, atol=1e-4)
    assert not apart(np.concatenate([beds[0], beds[0][3:4] + 1.0]))


def test_a_part_is_turned_where_only_so_it_fits():
    """Oracle: lib3mf, and trimesh, which sees the corner that was cut off a quarter turn further counter-clockwise."""
    corner = plate(solid=solid_of(Box((40, 30, 3)) - Box((10, 5, 9)).move(-1, -1, -1)))
    (content,) = three_mf_plates((corner,), "kit", bed=(35.0, 50.0))
    np.testing.assert_allclose(boxes_on_bed(content)[0, :, :2], [[0, 0], [30, 40]], atol=1e-4)
    seen = trimesh.load_scene(io.BytesIO(content), file_type="3mf").to_mesh()
    corners = {(round(x), round(y)) for x, y, _ in seen.vertices}
    assert corners == {(0, 0), (26, 0), (26, 9), (30, 9), (30, 40), (0, 40)}


def test_a_part_larger_than_the_bed_has_a_file_of_its_own():
    assert len(three_mf_plates((plate(count=2),), "kit", bed=(20.0, 20.0))) == 2


def test_a_3mf_without_parts_is_refused():
    with pytest.raises(ValueError, match="needs a part"):
        three_mf_bytes((), "nothing")


def test_the_same_part_gives_the_same_bytes():
    assert stl_bytes(plate()) == stl_bytes(plate())
    assert three_mf_bytes((plate(),), "kit") == three_mf_bytes((plate(),), "kit")
    dates = {entry.date_time for entry in zipfile.ZipFile(io.BytesIO(three_mf_bytes((plate(),), "kit"))).infolist()}
    assert dates == {(1980, 1, 1, 0, 0, 0)}


def test_skins_thinner_than_numbers_are_closed_too():
    """Oracle: trimesh; what is left between the two balls is a leftover of rounding, no body."""
    printed = Printed(name="part", title="Skins", solid=skins())
    seen = trimesh.load_mesh(io.BytesIO(stl_bytes(printed)), file_type="stl")
    assert seen.is_watertight
