"""The lattice that bodies are cut from. Oracles: closed forms, and random points that lie in one tetrahedron each."""

import numpy as np
import pytest

from hydrostat.geometry.mesh import Mesh, dihedral_angles
from hydrostat.geometry.tetrahedra.lattice import MEAN_EDGE, lattice, signed_volumes, turned_outward

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
