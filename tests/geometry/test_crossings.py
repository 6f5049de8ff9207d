"""Bodies that pass through themselves. Oracles: shapely's valid polygons, signed volumes of all pairs, by hand."""

from itertools import product

import numpy as np
import pytest
from builders import box_mesh, strip_mesh
from shapely import Polygon

from hydrostat.arrays import Nodes
from hydrostat.geometry.crossings import find_crossings, find_near_pairs
from hydrostat.geometry.mesh import Mesh


def curled(nodes: Nodes, turn: float) -> Nodes:
    """Bent along x to an arc of so many radians."""
    length = np.ptp(nodes[:, 0])
    angles = turn * (nodes[:, 0] - nodes[:, 0].min()) / length
    radius = length / turn - nodes[:, 1]
    return np.column_stack([radius * np.sin(angles), length / turn - radius * np.cos(angles), *nodes.T[2:]])


def ring(mesh: Mesh) -> list[int]:
    """Nodes of the boundary of a flat mesh, in order."""
    after = dict(mesh.boundary.tolist())
    order = [next(iter(after))]
    while after[order[-1]] != order[0]:
        order.append(after[order[-1]])
    return order


@pytest.mark.parametrize("turn", [1.0, 5.0, 6.0, 6.6, 7.5])
def test_a_strip_that_is_rolled_up_crosses_itself_when_its_polygon_is_not_valid(turn: float) -> None:
    mesh = strip_mesh(30, 3, size=(0.3, 0.02))
    nodes = curled(mesh.nodes, turn)
    found = find_crossings(mesh, nodes)
    assert (len(found) > 0) == (not Polygon(nodes[ring(mesh)]).is_valid)
    assert (len(found) > 0) == (turn > 2 * np.pi)


def test_the_place_of_a_crossing_in_the_plane() -> None:
    nodes = np.array([[0, 0], [4, 0], [2, -3], [2, 1], [3, -3], [1, -3.0]])
    mesh = Mesh(nodes, np.array([[0, 2, 1], [3, 5, 4]]))
    found = find_crossings(mesh, nodes)
    assert any(np.allclose(place, (1.75, 0.0)) for place in found.places)
    for place, (one, other) in zip(found.places, found.facets, strict=True):
        for facet in (one, other):
            start, end = nodes[mesh.boundary[facet]]
            assert abs(np.cross([*(end - start), 0], [*(place - start), 0])[2]) < 1e-12


def test_in_space_all_pairs_by_signed_volumes() -> None:
    mesh = box_mesh((16, 2, 2), size=(0.3, 0.02, 0.02))
    nodes = curled(mesh.nodes, 7.0) + np.array([0, 0, 1.0]) * (0.02 * mesh.nodes[:, :1])
    nodes += np.random.default_rng(0).normal(scale=3e-4, size=nodes.shape)  # so that nothing lies in one plane
    found = find_crossings(mesh, nodes)
    edges = {tuple(sorted((int(f[i]), int(f[(i + 1) % 3])))) for f in mesh.boundary for i in range(3)}
    expected = 0
    for (start, end), facet in product(edges, mesh.boundary.tolist()):
        if start in facet or end in facet:
            continue
        p, q, (a, b, c) = nodes[start], nodes[end], nodes[facet]
        if _side(p, a, b, c) * _side(q, a, b, c) > 0:
            continue
        turns = [_side(p, q, a, b) > 0, _side(p, q, b, c) > 0, _side(p, q, c, a) > 0]
        expected += turns[0] == turns[1] == turns[2]
    assert len(found) == expected > 0
    for place, (_, facet) in zip(found.places, found.facets, strict=True):
        a, b, c = nodes[mesh.boundary[facet]]
        assert abs(_side(place, a, b, c)) < 1e-15
    assert len(find_crossings(mesh, curled(mesh.nodes, 5.0))) == 0


def test_boxes_that_meet() -> None:
    """One item lies so far away that the cells of the grid become larger. Oracle: all pairs of boxes."""
    random = np.random.default_rng(1)
    for away in (0.0, 1e9):
        one = random.random((80, 1, 3)) + 0.2 * random.random((80, 2, 3))
        other = random.random((50, 1, 3)) + 0.1 * random.random((50, 3, 3))
        one[3] += away
        apart = (one.min(1)[:, None] > other.max(1)[None]) | (other.min(1)[None] > one.max(1)[:, None])
        assert np.array_equal(find_near_pairs(one, other), np.argwhere(~apart.any(axis=2)))
    assert find_near_pairs(one[:0], other).shape == (0, 2)
    holed = one.copy()
    holed[3, 0, 1] = np.nan
    whole = find_near_pairs(one, other)
    assert np.array_equal(find_near_pairs(holed, other), whole[whole[:, 0] != 3])


def _side(p: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    return float(np.linalg.det([a - p, b - p, c - p]))
