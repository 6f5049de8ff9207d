"""How well a mesh follows a surface. Oracles: closed forms, and trimesh's own nearest points."""

import numpy as np
import pytest
from builders import box_mesh
from solids import ball, boundary, brick, moved

from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.surface import Solid, Surface, covering_points
from hydrostat.geometry.tetrahedra.tetrahedralize import fit


def _star(outer: Surface) -> Mesh:
    """Tetrahedra from the origin to each triangle."""
    corners = np.column_stack([np.zeros(len(outer.triangles), dtype=int), 1 + outer.triangles])
    return Mesh(np.concatenate([[[0.0, 0, 0]], outer.vertices]), corners)


def test_two_balls_about_one_point() -> None:
    """Closed form: apart by the difference of the radii, to what flat triangles lack; volumes as the cubes."""
    found = fit(_star(ball(0.04)), Solid(ball(0.05)), 0.004)
    np.testing.assert_allclose(found.distances, 0.01, atol=2e-4)
    assert found.largest == pytest.approx(0.01, abs=2e-4)
    assert found.volume == pytest.approx(0.8**3, rel=1e-9)
    assert len(found.places) == len(found.distances)
    radii = np.linalg.norm(found.places, axis=1)
    assert set(np.round(radii, 2)) == {0.04, 0.05}
    assert radii[0] == pytest.approx(0.04, abs=1e-4)  # those of the mesh first


def test_a_mesh_of_the_surface_itself_fits() -> None:
    mesh = box_mesh((3, 2, 2), size=(0.06, 0.04, 0.02))
    found = fit(mesh, Solid(moved(brick(0.06, 0.04, 0.02), shift=(0.03, 0.02, 0.01))), 0.003)
    assert found.largest < 1e-12
    assert found.volume == pytest.approx(1)


def test_what_is_missing_is_seen_and_what_is_too_much() -> None:
    """Closed form: a box that is 10 mm longer than the mesh, and the other way round."""
    mesh = box_mesh((5, 4, 4), size=(0.05, 0.04, 0.04))
    for length in (0.06, 0.04):
        box = moved(brick(length, 0.04, 0.04), shift=(length / 2, 0.02, 0.02))
        found = fit(mesh, Solid(box), 0.002)
        assert found.largest == pytest.approx(0.01, abs=1e-9)
        assert found.volume == pytest.approx(0.05 / length)
        far = found.places[found.distances > 0.0099]
        assert set(np.round(far[:, 0], 3)) == {length, 0.05}


def test_distances_are_those_of_trimesh() -> None:
    import trimesh

    inner, outer = ball(0.03, 2), moved(brick(0.09, 0.08, 0.07), turned=0.5)
    found = fit(_star(inner), Solid(outer), 0.01)
    sides = [trimesh.Trimesh(one.vertices, one.triangles, process=False) for one in (outer, inner)]
    count = len(covering_points(boundary(_star(inner)), 0.01))
    halves = [found.places[:count], found.places[count:]]
    expected = [_away(side, points) for side, points in zip(sides, halves, strict=True)]
    np.testing.assert_allclose(found.distances, np.concatenate(expected), atol=1e-9)


def _away(made: object, points: np.ndarray) -> np.ndarray:
    """Least distance over all triangles, by trimesh's nearest point of a triangle."""
    from trimesh.triangles import closest_point

    triangles = made.triangles  # pyright: ignore[reportAttributeAccessIssue]
    return np.array(
        [np.linalg.norm(closest_point(triangles, np.tile(p, (len(triangles), 1))) - p, axis=1).min() for p in points]
    )


def test_points_are_spread_evenly() -> None:
    """Closed forms: as many as area by spacing squared, all on the triangle, quarters of it with a quarter of them."""
    triangle = Surface(np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 1]]), np.array([[0, 1, 2]]))
    points = covering_points(triangle, 0.02)
    np.testing.assert_array_equal(points[:3], triangle.vertices)
    inner = points[3:]
    assert len(inner) == 1250
    assert (inner[:, :2] > 0).all()
    assert (inner[:, :2].sum(axis=1) < 1).all()
    np.testing.assert_array_equal(inner[:, 2], 1)
    for chosen in (inner[:, 0] > 0.5, inner[:, 1] > 0.5, inner[:, :2].sum(axis=1) < 0.5):
        assert chosen.mean() == pytest.approx(0.25, abs=0.01)
    assert (inner[:, 0] > inner[:, 1]).mean() == pytest.approx(0.5, abs=0.01)
    np.testing.assert_allclose(inner.mean(axis=0), [1 / 3, 1 / 3, 1], atol=0.005)


def test_each_triangle_has_its_own_points_and_vertices_that_none_uses_do_not_count() -> None:
    """By hand: a large and a small triangle and a lone vertex."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 0, 0], [5.01, 0, 0], [5, 0.01, 0], [9, 9, 9]])
    points = covering_points(Surface(corners, np.array([[0, 1, 2], [3, 4, 5]])), 0.1)
    assert len(points) == 6 + 50 + 1
    assert points[:, 0].max() < 6
    assert (points[:, 0] > 4.9).sum() == 3 + 1
