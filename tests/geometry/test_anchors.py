from functools import cache

import numpy as np
import pytest
from builders import box_mesh
from geometry.shapes import SHAPES, outline
from scipy.optimize import nnls
from shapely import Polygon, distance, points, union_all

from hydrostat.errors import InputError
from hydrostat.geometry import Mesh, locate, triangulate


@cache
def flat_mesh() -> Mesh:
    """A body with two holes, one of them small."""
    polygon, size = SHAPES["two holes"]
    return triangulate(outline(polygon), 1e-3 * size)


@pytest.mark.parametrize("mesh", [flat_mesh(), box_mesh((3, 2, 2))], ids=["flat", "solid"])
def test_affine_functions_exactly(mesh: Mesh) -> None:
    """Oracle: linear elements carry every affine function; weights are a partition of one, the matrix agrees."""
    random = np.random.default_rng(0)
    corners = mesh.nodes[mesh.elements[random.integers(0, len(mesh.elements), 400)]]
    inside = np.einsum("pc,pcd->pd", random.dirichlet(np.ones(mesh.dim + 1), 400), corners)
    anchors = locate(mesh, inside)
    assert anchors.inside.all()
    assert np.allclose(anchors.weights.sum(axis=1), 1, rtol=0, atol=1e-14)
    assert anchors.weights.min() >= 0
    matrix, shift = random.normal(size=(mesh.dim, mesh.dim)), random.normal(size=mesh.dim)
    moved = mesh.nodes @ matrix + shift
    assert np.abs(anchors.positions(moved) - (inside @ matrix + shift)).max() < 1e-14
    assert np.abs(anchors.matrix(len(mesh.nodes)) @ moved - anchors.positions(moved)).max() < 1e-14


def test_nodes_are_themselves() -> None:
    """Oracle: the nodes; rounding there must not count as outside."""
    mesh = flat_mesh()
    anchors = locate(mesh, mesh.nodes)
    assert anchors.inside.all()
    assert np.abs(anchors.positions(mesh.nodes) - mesh.nodes).max() < 1e-12


def test_outside_in_the_plane() -> None:
    """Oracle: shapely's distance to the union of the triangles, holes and far points included."""
    mesh = flat_mesh()
    asked = np.random.default_rng(1).uniform([-0.05, -0.05], [0.17, 0.1], (500, 2))
    anchors = locate(mesh, asked)
    body = union_all([Polygon(mesh.nodes[element]) for element in mesh.elements])
    assert np.abs(anchors.distances - distance(body, points(asked))).max() < 1e-9
    reached = np.linalg.norm(anchors.positions(mesh.nodes) - asked, axis=1)
    assert np.abs(reached - anchors.distances).max() < 1e-9
    assert 50 < anchors.inside.sum() < 450


def test_outside_in_space() -> None:
    """Oracle: the distance to a box in closed form."""
    mesh = box_mesh((2, 2, 2), size=(0.1, 0.05, 0.05))
    asked = np.random.default_rng(2).uniform(-0.1, 0.2, (200, 3))
    closest = np.clip(asked, 0, [0.1, 0.05, 0.05])
    anchors = locate(mesh, asked)
    assert np.abs(anchors.positions(mesh.nodes) - closest).max() < 1e-12
    assert np.abs(anchors.distances - np.linalg.norm(asked - closest, axis=1)).max() < 1e-12


def test_a_flat_corner() -> None:
    """Oracle: a non-negative least squares projection onto one sliver, where dropping the wrong corner would show."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.45, 0.1, 0.0], [0.5, 0.05, 0.2]])
    mesh = Mesh(corners, np.array([[0, 1, 2, 3]]))
    asked = np.random.default_rng(4).uniform(-2, 2, (100, 3))
    anchors = locate(mesh, asked)
    for point, reached in zip(asked, anchors.distances, strict=True):
        system = np.vstack([corners.T, np.full(4, 1e5)])
        weights, _ = nnls(system, np.append(point, 1e5))
        assert reached == pytest.approx(np.linalg.norm(weights @ corners - point), abs=1e-6)


def test_no_points() -> None:
    """Oracle: empty in, empty out."""
    anchors = locate(flat_mesh(), np.zeros((0, 2)))
    assert anchors.weights.shape == (0, 3)
    assert anchors.positions(flat_mesh().nodes).shape == (0, 2)


@pytest.mark.parametrize("asked", [np.zeros((2, 3)), np.array([[np.nan, 0.0]])])
def test_refused(asked: np.ndarray) -> None:
    """Oracle: one line that says what is allowed."""
    with pytest.raises(InputError, match=r"must be finite, \(points, 2\)"):
        locate(flat_mesh(), asked)
