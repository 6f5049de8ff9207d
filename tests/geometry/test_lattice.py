"""The lattice that bodies are cut from, and its halves. Oracles: closed forms, random points, counting by hand."""

import numpy as np
import pytest

from hydrostat.geometry.mesh import Mesh, dihedral_angles
from hydrostat.geometry.tetrahedra.stuffing import (
    MEAN_EDGE,
    bisect,
    edges_of,
    find_edges,
    halves,
    lattice,
    signed_volumes,
    turned_outward,
)

BOX = np.array([[-0.013, 0.2, 0.0], [0.02, 0.241, 0.0501]])
CELL = 0.011


def weights(nodes: np.ndarray, elements: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Barycentric coordinates of each point in each tetrahedron, (points, elements, 4)."""
    corners = nodes[elements]
    inverse = np.linalg.inv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
    inner = np.einsum("eij,pej->pei", inverse, points[:, None] - corners[None, :, 0])
    return np.concatenate([1 - inner.sum(axis=2, keepdims=True), inner], axis=2)


def six_angles(nodes: np.ndarray, elements: np.ndarray) -> np.ndarray:
    """The six dihedral angles of each tetrahedron [degrees], sorted: at each edge, between the ways to the others."""
    angles = []
    for a, b, c, d in ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2), (1, 2, 0, 3), (1, 3, 0, 2), (2, 3, 0, 1)):
        edge = nodes[elements[:, b]] - nodes[elements[:, a]]
        edge /= np.linalg.norm(edge, axis=1, keepdims=True)
        ways = [nodes[elements[:, corner]] - nodes[elements[:, a]] for corner in (c, d)]
        one, two = (way - (way * edge).sum(axis=1, keepdims=True) * edge for way in ways)
        cosine = (one * two).sum(axis=1) / np.linalg.norm(one, axis=1) / np.linalg.norm(two, axis=1)
        angles.append(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
    return np.sort(np.stack(angles, axis=1), axis=1)


def test_tetrahedra_are_all_alike() -> None:
    """Closed form: a twelfth of a cell each, four angles of 60 and two of 90 degrees (Labelle and Shewchuk 2007)."""
    nodes, elements = lattice(BOX, CELL)
    np.testing.assert_allclose(signed_volumes(nodes, elements), CELL**3 / 12, rtol=1e-9)
    np.testing.assert_allclose(six_angles(nodes, elements), [[60, 60, 60, 60, 90, 90]] * len(elements), atol=1e-5)
    np.testing.assert_allclose(dihedral_angles(nodes, elements), 60, atol=1e-5)


def test_it_covers_the_box_and_a_cell_more_once() -> None:
    nodes, elements = lattice(BOX, CELL)
    random = np.random.default_rng(1)
    points = random.uniform(BOX[0] - CELL, BOX[1] + CELL, (200, 3))
    assert ((weights(nodes, elements, points) > 0).all(axis=2).sum(axis=1) == 1).all()
    np.testing.assert_allclose((nodes.min(axis=0) + nodes.max(axis=0)) / 2, BOX.mean(axis=0), atol=1e-12)


def test_faces_are_shared_by_two_and_the_outer_ones_close() -> None:
    nodes, elements = lattice(BOX, CELL)
    faces = np.sort(np.concatenate([np.delete(elements, corner, axis=1) for corner in range(4)]), axis=1)
    assert set(np.unique(faces, axis=0, return_counts=True)[1]) == {1, 2}
    mesh = Mesh(nodes, elements)
    assert mesh.volumes.sum() == pytest.approx(
        np.einsum("fd,fd->", nodes[mesh.boundary[:, 0]], _crosses(mesh)) / 6, rel=1e-9
    )


def _crosses(mesh: Mesh) -> np.ndarray:
    one, two, three = (mesh.nodes[corner] for corner in mesh.boundary.T)
    return np.cross(two - one, three - one)


def test_mean_edge_is_that_of_nodes_inside() -> None:
    """By counting the edges of all nodes a cell inside the lattice."""
    nodes, elements = lattice(np.array([[0.0] * 3, [8.0] * 3]), 1.0)
    edges = Mesh(nodes, elements).edges
    inner = (np.abs(nodes - 4) < 4.4).all(axis=1)
    ends = np.concatenate([edges, edges[:, ::-1]])
    lengths = np.linalg.norm(nodes[ends[:, 1]] - nodes[ends[:, 0]], axis=1)[inner[ends[:, 0]]]
    assert np.unique(ends[:, 0], return_counts=True)[1][inner[np.unique(ends[:, 0])]].tolist() == [14] * inner.sum()
    assert lengths.mean() == pytest.approx(MEAN_EDGE)


def test_inside_out_is_turned() -> None:
    """By a volume with sign; what was right stays."""
    nodes = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    elements = np.array([[0, 1, 2, 3], [1, 0, 2, 3]])
    np.testing.assert_allclose(signed_volumes(nodes, elements), [1 / 6, -1 / 6])
    np.testing.assert_array_equal(turned_outward(nodes, elements), [[0, 1, 2, 3], [0, 1, 2, 3]])


def test_only_what_is_wanted_is_made() -> None:
    """Oracle: the whole lattice, of which those are left that have the middle of a wanted cell."""
    nodes, elements = lattice(BOX, CELL)
    place = BOX.mean(axis=0)

    def wanted(points: np.ndarray) -> np.ndarray:
        return np.linalg.norm(points - place, axis=1) < 0.015

    some, fewer = lattice(BOX, CELL, wanted)
    np.testing.assert_array_equal(some, nodes)
    middles = elements >= _corner_count(nodes)
    left = (wanted(nodes)[elements] & middles).any(axis=1)
    np.testing.assert_array_equal(np.sort(fewer, axis=1), np.sort(elements[left], axis=1))
    assert 0 < len(fewer) < len(elements)


def _corner_count(nodes: np.ndarray) -> int:
    """Corners of cells come first, in planes of ever higher x; then the middles begin again at low x."""
    return int(np.argmin(np.diff(nodes[:, 0]))) + 1


NODES, ELEMENTS = lattice(np.array([[0.0] * 3, [2.0, 1.0, 1.5]]), 1.0)


def _outer_area(mesh: Mesh) -> float:
    one, two, three = (mesh.nodes[corner] for corner in mesh.boundary.T)
    return float(np.linalg.norm(np.cross(two - one, three - one), axis=1).sum() / 2)


def _chosen_near(nodes: np.ndarray, elements: np.ndarray, place: np.ndarray, reach: float) -> np.ndarray:
    return np.linalg.norm(nodes[elements].mean(axis=1) - place, axis=1) < reach


def test_nothing_chosen_is_nothing_done() -> None:
    nodes, elements = bisect(NODES, ELEMENTS, np.zeros(len(ELEMENTS), dtype=bool))
    np.testing.assert_array_equal(nodes, NODES)
    np.testing.assert_array_equal(elements, ELEMENTS)


def test_one_chosen_divides_the_ring_about_its_longest_edge() -> None:
    """By hand: a longest edge of the lattice has four tetrahedra about it, each becomes two; one node is new."""
    middle = int(np.argmin(np.linalg.norm(NODES[ELEMENTS].mean(axis=1) - NODES.mean(axis=0), axis=1)))
    chosen = np.arange(len(ELEMENTS)) == middle
    nodes, elements = bisect(NODES, ELEMENTS, chosen)
    assert len(nodes) == len(NODES) + 1
    assert len(elements) == len(ELEMENTS) + 4
    new = nodes[-1]
    corners = NODES[ELEMENTS[middle]]
    pairs = [(a, b) for a in range(4) for b in range(a) if np.allclose((corners[a] + corners[b]) / 2, new)]
    assert len(pairs) == 1
    assert np.linalg.norm(corners[pairs[0][0]] - corners[pairs[0][1]]) == pytest.approx(1.0)  # of 1 and sqrt(3/4)
    old = {tuple(sorted(element)) for element in ELEMENTS.tolist()}
    kept = {tuple(sorted(element)) for element in elements.tolist()} & old
    assert len(kept) == len(ELEMENTS) - 4
    assert tuple(sorted(ELEMENTS[middle].tolist())) not in kept


@pytest.mark.parametrize("seed", range(3))
def test_random_choices_leave_a_mesh_of_the_same_block(seed: int) -> None:
    """A node left hanging would make two inner faces outer ones, and add to the outer area."""
    random = np.random.default_rng(seed)
    before = Mesh(NODES, ELEMENTS)
    nodes, elements = NODES, ELEMENTS
    for share in (0.02, 0.1, 0.01, 0.05):
        chosen = random.random(len(elements)) < share
        gone = nodes[elements[chosen]].mean(axis=1)
        nodes, elements = bisect(nodes, elements, chosen)
        assert (signed_volumes(nodes, elements) > 0).all()
        after = nodes[elements].mean(axis=1)
        assert min(np.linalg.norm(after - place, axis=1).min() for place in gone) > 1e-6
    mesh = Mesh(nodes, elements)
    assert mesh.volumes.sum() == pytest.approx(before.volumes.sum(), rel=1e-12)
    assert _outer_area(mesh) == pytest.approx(_outer_area(before), rel=1e-12)
    faces = np.sort(np.concatenate([np.delete(elements, corner, axis=1) for corner in range(4)]), axis=1)
    assert np.unique(faces, axis=0, return_counts=True)[1].max() == 2
    assert len(np.unique(np.round(nodes, 9), axis=0)) == len(nodes)
    np.testing.assert_array_equal(nodes[: len(NODES)], NODES)


def test_however_often_there_are_four_shapes_with_angles_of_45_60_and_90_degrees() -> None:
    """Nine rounds about a point leave elements of an eighth of the size there; those far away stay."""
    nodes, elements = NODES, ELEMENTS
    place = np.array([0.9, 0.6, 0.8])
    for turn in range(9):
        nodes, elements = bisect(nodes, elements, _chosen_near(nodes, elements, place, 0.8 / 2 ** (turn / 3)))
    angles = six_angles(nodes, elements)
    shapes = np.unique(np.round(angles, 4), axis=0)
    assert len(shapes) == 4
    assert shapes[:, 0].min() == pytest.approx(45, abs=1e-3)
    assert shapes[:, 5].max() == pytest.approx(120, abs=1e-3)
    volumes = signed_volumes(nodes, elements)
    at_place = np.argmin(np.linalg.norm(nodes[elements].mean(axis=1) - place, axis=1))
    assert volumes[at_place] == pytest.approx(1 / 12 / 2**9, rel=1e-9)
    assert volumes.max() == pytest.approx(1 / 12)


def test_the_longest_edge_is_taken_whatever_the_scale_and_shape() -> None:
    """By hand: a tetrahedron with one longest edge, alone, tiny."""
    nodes = 1e-7 * np.array([[0.0, 0, 0], [3, 0, 0], [0, 2, 0], [0, 0, 1]])
    after, elements = bisect(nodes, np.array([[0, 1, 2, 3]]), np.array([True]))
    np.testing.assert_allclose(after[4], 1e-7 * np.array([1.5, 1, 0]))
    np.testing.assert_allclose(signed_volumes(after, elements), 0.5e-21)


def test_edges_are_those_of_the_mesh() -> None:
    """Oracle: Mesh.edges; and what is found is what was looked for."""
    every, which = edges_of(ELEMENTS)
    np.testing.assert_array_equal(every, Mesh(NODES, ELEMENTS).edges)
    for number in (0, 7, 200):
        ends = {tuple(sorted(pair)) for pair in every[which[number]].tolist()}
        corners = ELEMENTS[number].tolist()
        assert ends == {tuple(sorted((a, b))) for a in corners for b in corners if a != b}
    some = np.random.default_rng(0).permutation(len(every))[:50]
    np.testing.assert_array_equal(find_edges(every, every[some]), some)
    parts = halves(np.array([[3, 5, 6, 8]]), np.array([[5, 8]]), np.array([9]))
    np.testing.assert_array_equal(parts, [[3, 9, 6, 8], [3, 5, 6, 9]])
