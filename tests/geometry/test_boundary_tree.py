"""Pairs of a boundary, their distances and admissible moves. Oracles: all pairs by brute force, ipctk, samples."""

from itertools import combinations

import numpy as np
import pytest
from touching import fork_mesh

from hydrostat.geometry.boundary_tree import BoundaryTree
from hydrostat.geometry.mesh import Mesh
from hydrostat.kernel import native


def bent(mesh: Mesh, amount: float, seed: int = 0) -> np.ndarray:
    """Nodes of a body bent at random, smoothly."""
    waves = np.random.default_rng(seed).normal(size=(3, mesh.dim, mesh.dim))
    x = mesh.nodes / mesh.size
    return mesh.nodes + amount * mesh.size * sum(np.sin(3.0 * x @ wave + number) for number, wave in enumerate(waves))


def surface(mesh: Mesh) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
    """All nodes and edges of the boundary."""
    facets = mesh.boundary
    edges = {tuple(sorted(pair)) for facet in facets for pair in combinations(facet.tolist(), 2)}
    return [(int(node),) for node in np.unique(facets)], sorted(edges)


def samples(features: np.ndarray, count: int) -> np.ndarray:
    """Points of a feature, (points, dim), by its corners."""
    corners = len(features)
    if corners == 1:
        return features
    shares = np.linspace(0, 1, count)
    if corners == 2:
        return features[0] + shares[:, None] * (features[1] - features[0])
    one, two = (grid.ravel() for grid in np.meshgrid(shares, shares))
    inside = one + two <= 1 + 1e-12
    weights = np.column_stack([1 - one - two, one, two])[inside]
    return weights @ features


def all_pairs(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Every pair of features without a common node, and whether both are edges."""
    points, edges = surface(mesh)
    facets = [tuple(facet) for facet in mesh.boundary.tolist()]
    others = [(point, facet) for point in points for facet in facets]
    others += list(combinations(edges, 2)) if mesh.dim == 3 else []
    apart = [(one + other, len(one) == 2) for one, other in others if not set(one) & set(other)]
    return np.array([pair for pair, _ in apart]), np.array([edges for _, edges in apart])


def as_set(stencils: np.ndarray, edges: np.ndarray) -> set[frozenset[tuple[int, ...]]]:
    """Pairs, whichever feature and whichever node of it is told first."""
    splits = zip(stencils.tolist(), np.where(edges, 2, 1), strict=True)
    return {frozenset((tuple(sorted(pair[:first])), tuple(sorted(pair[first:])))) for pair, first in splits}


@pytest.mark.parametrize("dim", [2, 3])
def test_all_pairs_within_reach_are_found(dim: int) -> None:
    mesh = fork_mesh(dim, columns=6)
    nodes, reach = bent(mesh, 0.05), 0.012
    stencils, edges = all_pairs(mesh)
    squared = np.empty(len(edges))
    native.squared_distances(nodes, stencils, edges, 0.0, squared)
    wanted = as_set(stencils[squared < reach**2], edges[squared < reach**2])
    found = BoundaryTree(mesh).pairs(nodes, reach)
    assert len(wanted) > 10
    assert as_set(*found) == wanted
    assert len(found.edges) == len(wanted)


@pytest.mark.parametrize("amount", [0.01, 0.4])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_sweep_is_that_of_all_pairs(dim: int, amount: float) -> None:
    """No shortcut changes how far a move may go, nor what is near at its end."""
    mesh = fork_mesh(dim, columns=6)
    stencils, edges = all_pairs(mesh)
    reach, least = 0.012, 1.0
    for seed in range(4):
        nodes, move = bent(mesh, 0.02, 9 + seed), bent(mesh, amount, seed) - mesh.nodes
        share, found = BoundaryTree(mesh).sweep(nodes, move, mesh.nodes, kept=0.1, reach=reach)
        assert share == pytest.approx(native.admissible_share(nodes, move, mesh.nodes, stencils, edges, 0.1), rel=1e-12)
        squared = np.empty(len(edges))
        native.squared_distances(nodes + share * move, stencils, edges, 0.0, squared)
        assert as_set(*found) == as_set(stencils[squared < reach**2], edges[squared < reach**2])
        least = min(least, share)
    assert (least < 1.0) == (amount == 0.4)


@pytest.mark.parametrize("kind", ["node and edge", "node and triangle", "edges"])
def test_distances_are_those_of_the_nearest_samples(kind: str) -> None:
    dim, first, random = (2, 1, 0) if kind == "node and edge" else (3, 2 if kind == "edges" else 1, 1), 0, 0
    dim, first = dim[0], dim[1]
    points = np.random.default_rng(random).normal(size=(60, dim + 1, dim))
    stencils = np.arange(60 * (dim + 1)).reshape(60, dim + 1)
    squared = np.empty(60)
    native.squared_distances(points.reshape(-1, dim), stencils, np.full(60, first == 2), 0.0, squared)
    for corners, found in zip(points, squared, strict=True):
        one, other = samples(corners[:first], 201), samples(corners[first:], 201)
        nearest = np.linalg.norm(one[:, None] - other[None], axis=2).min()
        assert nearest - 0.02 <= found**0.5 <= nearest + 1e-12


@pytest.mark.parametrize("seed", range(8))
def test_no_move_passes_through(seed: int) -> None:
    """As far as a move is admitted the body does not cross itself by ipctk; beyond the first touch it does."""
    ipctk = pytest.importorskip("ipctk")
    mesh = fork_mesh(3)
    move = bent(mesh, 0.4, seed) - mesh.nodes
    share, _ = BoundaryTree(mesh).sweep(mesh.nodes, move, mesh.nodes, kept=0.1, reach=0.0)
    points, edges = surface(mesh)
    outer = np.concatenate(points)
    place = {int(node): number for number, node in enumerate(outer)}
    mapped = [np.array([[place[int(node)] for node in each] for each in some]) for some in (edges, mesh.boundary)]
    collisions = ipctk.CollisionMesh(mesh.nodes[outer], *mapped)
    assert 0 < share < 1
    for part in np.linspace(0, share, 7):
        assert not ipctk.has_intersections(collisions, (mesh.nodes + part * move)[outer])
    assert any(
        ipctk.has_intersections(collisions, (mesh.nodes + part * move)[outer])
        for part in np.linspace(share, min(3 * share, 1), 30)
    )


def test_a_move_as_a_whole_is_admitted_whole() -> None:
    mesh = fork_mesh(3)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    for move in (np.full(mesh.nodes.shape, 0.3), 0.01 * mesh.nodes @ turn.T):
        assert BoundaryTree(mesh).sweep(mesh.nodes, move, mesh.nodes, kept=0.1, reach=0.0)[0] == 1.0


def test_pairs_that_touch_at_rest_may_move() -> None:
    """Two triangles that stand on one place without a common node, and move apart."""
    nodes = np.array([[0.0, 0], [1, 0], [0, 1], [0, 0], [-1, 0], [0, -1]])
    move = np.where(np.arange(6)[:, None] < 3, 0.0, -0.5) * np.ones(2)
    stencils = np.array([[0, 3, 4], [3, 0, 1]])
    still, apart = np.zeros(2, np.bool_), np.repeat([[0.0], [9.0]], 3, axis=0)
    assert native.admissible_share(nodes, move, nodes, stencils, still, 0.1) == 1.0
    assert native.admissible_share(nodes, -move, nodes + apart, stencils, still, 0.1) < 1e-6


@pytest.mark.parametrize("dim", [2, 3])
def test_areas_are_those_of_the_boundary(dim: int) -> None:
    """The box less its slot, counted by hand [mm]."""
    areas, around = fork_mesh(dim).facet_areas()
    slot, rim = 2 * 90 + 40 / 3, 2 * (120 + 40) - 40 / 3
    plate = (120 * 40 - 90 * 40 / 3) * 2e-6
    wanted = 1e-3 * (slot + rim) if dim == 2 else 1e-3 * (slot + rim) * 0.02 + plate
    np.testing.assert_allclose([areas.sum(), around.sum()], wanted, rtol=1e-12)
