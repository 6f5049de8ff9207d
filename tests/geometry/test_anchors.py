from functools import cache

import numpy as np
import pytest
from builders import box_mesh
from geometry.shapes import SHAPES, outline
from scipy.optimize import nnls
from scipy.spatial import Delaunay
from shapely import Polygon, distance, points, union_all

from hydrostat.errors import InputError
from hydrostat.geometry import Mesh, locate, triangulate
from hydrostat.geometry import anchors as module
from hydrostat.geometry.anchors import Anchors


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


def large_mesh(dim: int) -> Mesh:
    """Enough elements for the search by a tree, of very different sizes: many tiny ones, a few as large as the body."""
    random = np.random.default_rng(dim)
    spread = np.concatenate([random.uniform(size=(400, dim)), 0.05 * random.uniform(size=(1600, dim)) ** 3])
    elements = Delaunay(spread).simplices.astype(np.int64)
    spans = spread[elements[:, 1:]] - spread[elements[:, :1]]
    turned = np.linalg.det(spans) < 0
    elements[turned, :2] = elements[turned, 1::-1]
    heights = 1.0 / np.linalg.norm(np.linalg.inv(spans), axis=1).max(axis=1)
    return Mesh(spread, elements[heights > 1e-3 * np.ptp(spread[elements], axis=1).max(axis=1)])


def depths(mesh: Mesh, point: np.ndarray) -> np.ndarray:
    """Least barycentric weight of a point in every element, by solving for the weights: sum one, place the point."""
    corners = mesh.nodes[mesh.elements]
    system = np.concatenate([np.swapaxes(corners, 1, 2), np.ones((len(corners), 1, mesh.dim + 1))], axis=1)
    return np.linalg.solve(system, np.append(point, 1.0)[:, None])[..., 0].min(axis=1)


@pytest.mark.parametrize("dim", [2, 3])
def test_the_deepest_of_all_elements(dim: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: every element tried, for points at random, on nodes, in the middle of edges and facets, and outside."""
    monkeypatch.setattr(module, "_AT_ONCE", 1000)
    mesh = large_mesh(dim)
    random = np.random.default_rng(5)
    some = mesh.elements[random.integers(0, len(mesh.elements), 30)]
    asked = np.concatenate(
        [
            random.uniform(-0.2, 1.2, (30, dim)),
            random.uniform(0.0, 0.05, (30, dim)),
            mesh.nodes[some[:, 0]],
            mesh.nodes[some[:, :2]].mean(axis=1),
            mesh.nodes[some[:, :dim]].mean(axis=1),
        ]
    )
    together = locate(mesh, asked)
    number = {tuple(element): index for index, element in enumerate(mesh.elements)}
    for index, point in enumerate(asked):
        depth = depths(mesh, point)
        assert together.inside[index] == (depth.max() >= -1e-9)
        if together.inside[index]:
            held = number[tuple(together.stencils[index])]
            assert depth[held] == pytest.approx(depth.max(), rel=0, abs=1e-9)
            assert together.weights[index] @ mesh.nodes[together.stencils[index]] == pytest.approx(point, abs=1e-9)
            if np.partition(depth, -2)[-2] < depth.max() - 1e-9:
                assert held == np.argmax(depth)
    assert 0.5 < together.inside.mean() < 1.0


@pytest.mark.parametrize("dim", [2, 3])
def test_many_points_are_as_few(dim: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the same points asked one by one, to the last bit; the tree serves the many only."""
    monkeypatch.setattr(module, "_AT_ONCE", 100_000)
    mesh = large_mesh(dim)
    random = np.random.default_rng(6)
    asked = np.concatenate(
        [random.uniform(-0.2, 1.2, (50, dim)), mesh.nodes[::50], mesh.nodes[mesh.elements[::300]].mean(1)]
    )
    assert len(mesh.elements) < 100_000 < len(asked) * len(mesh.elements)
    together = locate(mesh, asked)
    alone = [locate(mesh, point[None]) for point in asked]
    assert np.array_equal(together.stencils, np.concatenate([one.stencils for one in alone]))
    assert np.array_equal(together.weights, np.concatenate([one.weights for one in alone]))
    assert np.array_equal(together.distances, np.concatenate([one.distances for one in alone]))


def test_of_two_equally_deep_the_first() -> None:
    """Oracle: a square of two triangles, in numbers that do not round; their common edge, in both orders."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    two = np.array([[0, 1, 2], [0, 2, 3]])
    for elements in (two, two[::-1]):
        assert np.array_equal(locate(Mesh(corners, elements), np.array([[0.5, 0.5]])).stencils, elements[:1])


@pytest.mark.parametrize("mesh", [flat_mesh(), large_mesh(3)], ids=["flat", "solid"])
def test_nodes_by_number(mesh: Mesh) -> None:
    """Oracle: the nodes themselves, to the last bit, each in the first element that has it."""
    chosen = np.unique(mesh.elements)[::3]
    anchors = Anchors.at_nodes(mesh, chosen)
    assert np.array_equal(anchors.positions(mesh.nodes), mesh.nodes[chosen])
    assert anchors.inside.all()
    for node, stencil in zip(chosen, anchors.stencils, strict=True):
        assert np.array_equal(stencil, mesh.elements[np.flatnonzero((mesh.elements == node).any(axis=1))[0]])


def test_a_node_of_no_element() -> None:
    """Oracle: `locate`, for such a node is a point like any other."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.25, 0.25], [2.0, 0.0]])
    mesh = Mesh(corners, np.array([[0, 1, 2]]))
    anchors = Anchors.at_nodes(mesh, np.array([1, 3, 4]))
    assert np.allclose(anchors.weights, [[0, 1, 0], [0.5, 0.25, 0.25], [0, 1, 0]])
    assert np.array_equal(anchors.distances, [0, 0, 1])
