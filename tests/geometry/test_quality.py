"""How good a mesh is. Oracle: tetrahedra whose angles are known in closed form, and angles measured along an edge."""

from itertools import combinations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from hydrostat.geometry.mesh import dihedral_angles

REGULAR = [[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
CORNER = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
LATTICE = [[0.0, 0, 0], [2, 0, 0], [1, 1, 1], [1, 1, -1]]
"""Sommerville's: two middles of cells of the body-centred lattice and an edge between them."""


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
