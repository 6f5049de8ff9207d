"""Meshes, and how good they are. Oracles: closed forms, Green's theorem, angles measured along an edge."""

from itertools import combinations

import numpy as np
import pytest
from builders import box_mesh, strip_mesh
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial.transform import Rotation

from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.geometry.mesh import dihedral_angles, joined_groups

TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


def test_boundary_in_the_plane_has_the_body_on_its_left() -> None:
    """Oracle: Green's theorem: the integral of x dy around the body is its area."""
    mesh = strip_mesh(5, 3)
    start, end = mesh.nodes[mesh.boundary[:, 0]], mesh.nodes[mesh.boundary[:, 1]]
    area = (0.5 * (start[:, 0] + end[:, 0]) * (end[:, 1] - start[:, 1])).sum()
    assert area == pytest.approx(0.2 * 0.05)
    assert mesh.volumes.sum() == pytest.approx(area)
    assert len(mesh.boundary) == 2 * (5 + 3)


def test_boundary_in_space_points_outwards() -> None:
    """Oracle: the divergence theorem: a third of the flux of x through the surface is the volume."""
    mesh = box_mesh((3, 2, 2))
    corners = mesh.nodes[mesh.boundary]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    volume = np.einsum("fd,fd->", corners.mean(axis=1), normals) / 3
    assert volume == pytest.approx(0.1 * 0.05 * 0.05)
    outward = corners.mean(axis=1) - mesh.nodes[mesh.elements[mesh.boundary_elements]].mean(axis=1)
    assert np.einsum("fd,fd->f", outward, normals).min() > 0
    assert len(mesh.boundary) == 4 * (3 * 2 + 3 * 2 + 2 * 2)


@pytest.mark.parametrize("mesh", [strip_mesh(4, 3), box_mesh((2, 2, 2))], ids=["flat", "solid"])
def test_counts(mesh: Mesh) -> None:
    """Oracle: every boundary facet lies in the element named for it; edges are unique and sorted."""
    for facet, element in zip(mesh.boundary, mesh.elements[mesh.boundary_elements], strict=True):
        assert set(facet) <= set(element)
    assert np.array_equal(mesh.edges, np.unique(mesh.edges, axis=0))
    assert (mesh.edges[:, 0] < mesh.edges[:, 1]).all()
    assert mesh.size == pytest.approx(float(np.ptp(mesh.nodes, axis=0).max()))


def test_keeps_a_copy() -> None:
    """Oracle: the mesh does not change with the caller's array, nor freezes it."""
    nodes = TRIANGLE.copy()
    mesh = Mesh(nodes, np.array([[0, 1, 2]]))
    nodes[0] = 9.0
    assert mesh.nodes[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        mesh.nodes[0] = 1.0


@pytest.mark.parametrize(
    ("nodes", "elements", "message"),
    [
        (TRIANGLE, [[0, 1, 3]], "names a node that it does not have"),
        (TRIANGLE, [[0, 1, -1]], "names a node that it does not have"),
        (TRIANGLE, [[0, 2, 1]], "1 mesh elements have no positive volume, the first is number 0"),
        (TRIANGLE, [[0, 1, 1]], "no positive volume"),
        (TRIANGLE, [[0, 1]], "needs 3 nodes an element, not 2"),
        (TRIANGLE * np.nan, [[0, 1, 2]], "finite nodes"),
        (np.zeros((3, 1)), [[0, 1]], "in the plane or in space"),
    ],
)
def test_refused(nodes: np.ndarray, elements: list[list[int]], message: str) -> None:
    """Oracle: one line that says what is wrong."""
    with pytest.raises(InputError, match=message):
        Mesh(nodes, np.array(elements))


REGULAR = [[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
CORNER = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
LATTICE = [[0.0, 0, 0], [2, 0, 0], [1, 1, 1], [1, 1, -1]]
"""Sommerville's: two middles of cells of the body-centered lattice and an edge between them."""


def upright(nodes: np.ndarray) -> np.ndarray:
    """The corners in the order in which their volume is positive."""
    return nodes if np.linalg.det(nodes[1:] - nodes[0]) > 0 else nodes[[1, 0, 2, 3]]


def along_edges(nodes: np.ndarray) -> float:
    """Smallest dihedral angle [degrees], measured between the two other corners as seen along each edge."""
    found = []
    for one, two in combinations(range(4), 2):
        along = (nodes[two] - nodes[one]) / np.linalg.norm(nodes[two] - nodes[one])
        others = np.delete(nodes, [one, two], axis=0) - nodes[one]
        seen = others - np.outer(others @ along, along)
        found.append(np.arctan2(np.linalg.norm(np.cross(seen[0], seen[1])), seen[0] @ seen[1]))
    return float(np.degrees(min(found)))


@pytest.mark.parametrize(
    ("corners", "smallest"),
    [(REGULAR, np.arccos(1 / 3)), (CORNER, np.arccos(1 / np.sqrt(3))), (LATTICE, np.pi / 3)],
)
def test_dihedral_angles_in_closed_form(corners: list, smallest: float) -> None:
    """Oracle: 70.53, 54.74 and 60 degrees, at any size, place and turn."""
    for size in (1e-4, 1.0, 1e3):
        nodes = size * (upright(np.array(corners)) @ Rotation.from_euler("xyz", [1, 2, 3]).as_matrix().T + 5.0)
        assert dihedral_angles(nodes, np.array([[0, 1, 2, 3]])) == pytest.approx([np.degrees(smallest)], rel=1e-9)


def test_dihedral_angles_of_any_tetrahedra() -> None:
    """Oracle: the angle between the other two corners, seen along each edge."""
    rng = np.random.default_rng(0)
    tetrahedra = np.array([upright(nodes) for nodes in rng.normal(size=(200, 4, 3))])
    found = dihedral_angles(tetrahedra.reshape(-1, 3), np.arange(800).reshape(-1, 4))
    assert found == pytest.approx([along_edges(nodes) for nodes in tetrahedra], rel=1e-7)
    assert found.min() < 10  # it can tell


def test_flat_and_inverted_tetrahedra_have_none() -> None:
    """Oracle: by definition 0, without a warning; no tetrahedra, no angles."""
    nodes = np.array([*CORNER, [0.3, 0.3, 0.0]])
    elements = np.array([[0, 1, 2, 4], [1, 0, 2, 3], [0, 0, 1, 2]])
    assert dihedral_angles(nodes, elements).tolist() == [0.0, 0.0, 0.0]
    assert dihedral_angles(nodes, elements[:0]).shape == (0,)


@pytest.mark.parametrize(("count", "joins"), [(1, 0), (7, 0), (40, 25), (300, 250), (300, 2000)])
def test_groups_are_connected_components(count: int, joins: int) -> None:
    """Oracle: SciPy's connected components, which are numbered by their first members too."""
    pairs = np.random.default_rng(count + joins).integers(0, count, (2, joins))
    graph = coo_array((np.ones(joins), pairs), shape=(count, count))
    np.testing.assert_array_equal(joined_groups(pairs, count), connected_components(graph, directed=False)[1])


def test_an_element_of_denormal_height_has_no_volume() -> None:
    """A height of 5e-312: its volume is above 0, and no number can be divided by the area of its sides."""
    nodes = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 5e-312]])
    with pytest.raises(InputError, match="no positive volume"):
        Mesh(nodes, np.array([[0, 1, 2, 3]]))
