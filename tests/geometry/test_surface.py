"""The inside of a surface. Oracles: closed forms of a ball and a box, igl.signed_distance."""

import pickle

import numpy as np
import pytest
from solids import ball, brick, hollow, moved, two_fingers

from hydrostat.geometry.surface import Solid, Surface

RANDOM = np.random.default_rng(0)


def test_distances_of_a_box_are_the_closed_form() -> None:
    half = np.array([0.03, 0.02, 0.01])
    solid = Solid(brick(0.06, 0.04, 0.02))
    points = RANDOM.uniform(-0.06, 0.06, (500, 3))
    beyond = np.abs(points) - half
    expected = np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)
    np.testing.assert_allclose(solid.distances(points), expected, atol=1e-12)
    np.testing.assert_array_equal(solid.inside(points), expected < 0)
    places, triangles = solid.nearest(points)
    np.testing.assert_allclose(np.linalg.norm(places - points, axis=1), np.abs(expected), atol=1e-12)
    corners = solid.surface.vertices[solid.surface.triangles[triangles]]
    heights = np.einsum("nd,nd->n", places - corners[:, 0], solid.normals[triangles])
    np.testing.assert_allclose(heights, 0, atol=1e-12)


def test_distances_of_a_ball_are_the_closed_form_to_what_its_triangles_lack() -> None:
    points = RANDOM.normal(size=(400, 3)) * 0.04
    distances = Solid(ball(0.05)).distances(points)
    np.testing.assert_allclose(distances, np.linalg.norm(points, axis=1) - 0.05, atol=0.05 * 2e-3)


@pytest.mark.parametrize("maker", [hollow, lambda: moved(two_fingers(0.004), turned=0.5, shift=(3, -4, 5))])
def test_distances_are_those_of_libigl(maker) -> None:
    import igl

    body = maker()
    points = RANDOM.uniform(body.box[0] - 0.01, body.box[1] + 0.01, (400, 3))
    kind = igl.SIGNED_DISTANCE_TYPE_WINDING_NUMBER
    expected = igl.signed_distance(points, body.vertices, body.triangles, kind)[0]
    np.testing.assert_allclose(Solid(body).distances(points), expected, atol=1e-12)


def test_winding_number_is_one_inside_none_outside_and_none_in_a_hollow() -> None:
    solid = Solid(hollow(0.05, 0.03))
    points = np.array([[0.04, 0, 0], [0, -0.041, 0], [0, 0, 0], [0.02, 0, 0], [0.06, 0, 0], [1, 1, 1]])
    np.testing.assert_allclose(solid.winding(points), [1, 1, 0, 0, 0, 0], atol=0.02)
    np.testing.assert_array_equal(solid.inside(points), [True, True, False, False, False, False])


def test_half_way_at_a_hole() -> None:
    """Closed form: the solid angle of a box without its top, seen from the middle of where that was: half of all."""
    body = brick(2.0, 2.0, 2.0)
    open_above = body.triangles[~(body.vertices[body.triangles][..., 2] > 0.9).all(axis=1)]
    winding = Solid(Surface(body.vertices, open_above)).winding(np.array([[0.0, 0, 1], [0, 0, 0]]))
    np.testing.assert_allclose(winding, [0.5, 5 / 6], atol=0.01)


def test_normals_point_outward_and_are_none_without_area() -> None:
    """Closed form of a ball; a triangle with two equal corners."""
    solid = Solid(ball(0.05))
    middles = solid.surface.vertices[solid.surface.triangles].mean(axis=1)
    np.testing.assert_allclose(solid.normals, middles / np.linalg.norm(middles, axis=1, keepdims=True), atol=2e-2)
    np.testing.assert_allclose(np.linalg.norm(solid.normals, axis=1), 1)
    flat = Solid(Surface(np.eye(3), np.array([[0, 1, 2], [0, 1, 1]])))
    np.testing.assert_allclose(flat.normals, [np.full(3, 3**-0.5), np.zeros(3)])


def test_a_solid_that_was_asked_can_be_sent_to_another_process() -> None:
    solid, points = Solid(ball(0.05)), RANDOM.normal(size=(20, 3)) * 0.04
    expected = solid.distances(points)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(solid)).distances(points), expected)
