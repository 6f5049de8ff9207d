"""Bodies as solids: oracles are volumes in closed form and sums of tetrahedra."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot, mesh_body, strip_mesh
from manifold3d import Manifold
from mould_robots import blob_body

from hydrostat.errors import InputError
from hydrostat.fabrication.solids.body_solid import body_solid, closed_solid
from hydrostat.fabrication.solids.printed import triangles_of


def test_ready_mesh_in_space_has_the_volume_of_its_tetrahedra() -> None:
    body = blob_body()
    assert body_solid(body).volume() == pytest.approx(1e9 * body.mesh.volumes.sum(), rel=1e-12)


def test_ready_flat_mesh_is_raised_by_its_thickness() -> None:
    body = mesh_body(strip_mesh(6, 3, size=(0.2, 0.05)), thickness=0.03)
    solid = body_solid(body)
    assert solid.volume() == pytest.approx(200 * 50 * 30, rel=1e-9)
    assert np.reshape(solid.bounding_box(), (2, 3))[:, 2] == pytest.approx([-15, 15])


@pytest.mark.slow
def test_gallery_bodies_keep_their_volume() -> None:
    flat, space = gallery_robot("starfish").body, gallery_robot("trunk").body
    assert flat.outline is not None
    assert flat.thickness is not None
    assert space.healing is not None
    assert body_solid(flat).volume() == pytest.approx(1e9 * flat.outline.area * flat.thickness, rel=1e-9)
    assert body_solid(space).volume() == pytest.approx(1e9 * space.healing.surface.volume, rel=1e-12)


def test_surface_in_single_triangles_or_inside_out_is_mended() -> None:
    vertices, triangles = triangles_of(Manifold.cube((10, 20, 30)))
    soup = vertices[triangles].reshape(-1, 3)
    loose = np.arange(len(soup)).reshape(-1, 3)
    assert closed_solid(soup, loose).volume() == pytest.approx(6000)
    assert closed_solid(vertices, triangles[:, ::-1].copy()).volume() == pytest.approx(6000)


def test_open_surface_is_refused() -> None:
    vertices, triangles = triangles_of(Manifold.cube((10, 20, 30)))
    with pytest.raises(InputError, match="not closed"):
        closed_solid(vertices, triangles[1:])


def test_mesh_that_touches_itself_in_a_node_is_refused() -> None:
    mesh = strip_mesh(2, 2)
    kept = np.array([0, 1, 6, 7])
    body = replace(mesh_body(mesh), mesh=type(mesh)(mesh.nodes, mesh.elements[kept]))
    with pytest.raises(InputError, match="single node"):
        body_solid(body)
