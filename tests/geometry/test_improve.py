"""Improvement. Oracles: the sum of the docstring in NumPy, finite differences, closed forms of symmetric shapes."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pytest
from builders import box_mesh
from solids import ball, boundary, brick

from hydrostat.geometry.mesh import Mesh, dihedral_angles
from hydrostat.geometry.surface import Solid, Surface, covering_points
from hydrostat.geometry.tetrahedra import tetrahedralize as module
from hydrostat.geometry.tetrahedra.stuffing import signed_volumes
from hydrostat.geometry.tetrahedra.tetrahedralize import ImproveStage, improve, tetrahedralize
from hydrostat.kernel import native

REGULAR = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])[[0, 2, 1, 3]]


@dataclass
class Case:
    """A block with its nodes shaken, and a plane for each sample of its facets."""

    nodes: np.ndarray
    mesh: Mesh
    normals: np.ndarray
    offsets: np.ndarray
    power: float
    pull: float

    @classmethod
    def random(cls, seed: int, power: float, cells: tuple[int, int, int] = (2, 2, 2)) -> "Case":
        random = np.random.default_rng(seed)
        mesh = box_mesh(cells, size=(2.0, 2.0, 2.0))
        nodes = mesh.nodes + random.uniform(-0.12, 0.12, mesh.nodes.shape)
        normals = random.normal(size=(len(mesh.boundary), 3, 3))
        normals /= np.linalg.norm(normals, axis=2, keepdims=True)
        return cls(nodes, mesh, normals, random.normal(size=normals.shape[:2]), power, random.uniform(0.5, 4))

    @property
    def lists(self) -> tuple:
        """The arguments of the compiled functions, from the elements on."""
        star, ring = (
            module._stars(simplices, len(self.nodes)) for simplices in (self.mesh.elements, self.mesh.boundary)
        )
        planes = (self.normals, self.offsets, module._SAMPLES, self.power, self.pull)
        return (self.mesh.elements, *star, self.mesh.boundary, *ring, *planes)

    def energy(self, nodes: np.ndarray, node: int | None = None) -> float:
        """The sum of the docstring, of all or of what has a node."""
        elements, facets = self.mesh.elements, self.mesh.boundary
        own = slice(None) if node is None else (elements == node).any(axis=1)
        faced = slice(None) if node is None else (facets == node).any(axis=1)
        corners = nodes[elements[own]]
        squares = sum(((corners[:, a] - corners[:, b]) ** 2).sum(axis=1) for a, b in combinations(range(4), 2))
        volumes = signed_volumes(nodes, elements[own])
        if not (volumes > 0).all():
            return np.inf
        shapes = squares / (6 * (6 * np.sqrt(2) * volumes) ** (2 / 3))
        places = np.einsum(
            "sc,fcd->fsd", [[2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]], nodes[facets[faced]]
        )
        gaps = (places * self.normals[faced]).sum(axis=2) - self.offsets[faced]
        return float((shapes**self.power).sum() + self.pull * (gaps**2).sum())


@pytest.mark.parametrize("power", [1.0, 2.0, 4.0])
@pytest.mark.parametrize("node", [13, 0, 4], ids=["inside", "at a corner", "on a side"])
def test_energy_gradient_and_hessian_of_a_node(node: int, power: float) -> None:
    """By the sum itself and by central differences."""
    case = Case.random(node, power)

    def derivatives(x: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        nodes, slope, bend = case.nodes.copy(), np.empty(3), np.empty((3, 3))
        nodes[node] = x
        total = native.node_derivatives(node, slope, bend, nodes, *case.lists)
        assert total == pytest.approx(case.energy(nodes, node), rel=1e-12)
        return total, slope, np.triu(bend) + np.triu(bend, 1).T

    x, step = case.nodes[node], 1e-5
    _, gradient, hessian = derivatives(x)
    for axis in range(3):
        (high, rise, _), (low, fall, _) = (derivatives(x + sign * step * np.eye(3)[axis]) for sign in (1, -1))
        assert gradient[axis] == pytest.approx((high - low) / (2 * step), rel=1e-6, abs=1e-6)
        np.testing.assert_allclose(hessian[axis], (rise - fall) / (2 * step), rtol=1e-5, atol=1e-5)
    assert np.linalg.eigvalsh(hessian).min() > 0


def test_shape_is_one_of_a_regular_tetrahedron_and_infinite_of_one_turned_over() -> None:
    for corner in range(4):
        for scale, turned in ((1.0, 1.0), (0.1, 1.0), (1.0, -3.0)):
            nodes = scale * REGULAR
            nodes[corner] *= turned
            mesh = Mesh(REGULAR, np.array([[0, 1, 2, 3]]))
            case = Case(nodes, mesh, np.zeros((4, 3, 3)), np.zeros((4, 3)), 1.0, 0.0)
            total = native.node_derivatives(corner, np.empty(3), np.empty((3, 3)), nodes, *case.lists)
            assert total == (pytest.approx(1) if turned > 0 else np.inf)


@pytest.mark.parametrize("power", [1.0, 4.0])
@pytest.mark.parametrize("seed", range(3))
def test_a_sweep_lowers_the_energy_and_turns_nothing_over(seed: int, power: float) -> None:
    """By the sum itself; strong pulls to random planes would turn elements over, were they let."""
    case = Case.random(seed, power, cells=(3, 3, 3))
    case.pull = 50.0
    nodes, before = case.nodes.copy(), case.energy(case.nodes)
    first = before
    for _ in range(12):
        native.sweep(nodes, *case.lists)
        after = case.energy(nodes)
        assert after <= before * (1 + 1e-12)
        before = after
    assert before < 0.9 * first
    assert (signed_volumes(nodes, case.mesh.elements) > 0).all()


def test_a_regular_tetrahedron_on_its_own_surface_stays() -> None:
    mesh = Mesh(REGULAR, np.array([[0, 1, 2, 3]]))
    assert signed_volumes(REGULAR, mesh.elements) > 0
    stage = ImproveStage(rounds=2, sweeps=2, power=2.0, pull=10.0)
    after = improve(mesh, Solid(Surface(REGULAR, mesh.boundary)), element_size=2.0, stages=(stage,))
    np.testing.assert_allclose(after.nodes, REGULAR, atol=1e-9)


def test_a_node_moved_inside_comes_back_to_the_middle() -> None:
    """By symmetry: of four equal parts of a regular tetrahedron the common node is in the middle."""
    nodes = np.concatenate([REGULAR, [[0.3, -0.2, 0.25]]])
    mesh = Mesh(nodes, np.array([[4, 1, 2, 3], [0, 4, 2, 3], [0, 1, 4, 3], [0, 1, 2, 4]]))
    stage = ImproveStage(rounds=1, sweeps=20, power=2.0, pull=1e6)
    after = improve(
        mesh, Solid(Surface(REGULAR, np.delete(mesh.boundary, [], axis=0))), element_size=2.0, stages=(stage,)
    )
    np.testing.assert_allclose(after.nodes[4], 0, atol=1e-4)
    np.testing.assert_allclose(after.nodes[:4], REGULAR, atol=1e-4)


def test_a_box_that_is_too_small_grows_to_its_surface_with_its_corners() -> None:
    """Closed form: the corners of the box; nothing is promised before."""
    small = box_mesh((5, 4, 3), size=(0.05, 0.04, 0.03))
    inner = Mesh(0.9 * (small.nodes - [0.025, 0.02, 0.015]), small.elements)
    stages = (ImproveStage(rounds=12, sweeps=4, power=1.0, pull=300.0),)
    solid = Solid(brick(0.05, 0.04, 0.03))
    after = improve(inner, solid, element_size=0.01, stages=stages)
    assert after.volumes.sum() == pytest.approx(0.05 * 0.04 * 0.03, rel=0.01)
    assert np.abs(solid.distances(after.nodes[after.boundary_nodes])).max() < 0.05 * 0.01
    assert np.abs(np.abs(after.nodes).max(axis=0) - [0.025, 0.02, 0.015]).max() < 0.03 * 0.01
    np.testing.assert_array_equal(after.elements, inner.elements)


def test_the_signed_distance_is_about_zero_on_average() -> None:
    """Closed form of a ball: so the volume is met though facets are flat."""
    mesh = tetrahedralize(ball(), 0.02)
    away = np.linalg.norm(covering_points(boundary(mesh), 0.002), axis=1) - 0.05
    assert abs(away.mean()) < 0.01 * 0.02
    assert away.min() < -0.01 * 0.02
    assert away.max() > 0.01 * 0.02
    assert dihedral_angles(mesh.nodes, mesh.elements).min() > 25


def test_planes_of_what_faces_another_part_are_left_out() -> None:
    """By hand: the sides of a thin brick of elements inside a thick one face no surface near but their own."""
    solid = Solid(brick(1.0, 1.0, 0.1))
    facets = np.array([[0, 1, 2]])
    flat = np.array([[0.0, 0, 0.06], [0.1, 0, 0.06], [0, 0.1, 0.06]])
    for nodes, normal in (
        (flat, [0, 0, 1]),
        (flat - [0, 0, 0.02], [0, 0, 1]),
        (flat[[1, 0, 2]], [0, 0, 0]),
        (flat[:, [2, 0, 1]] * [0, 1, 1] + [0, 0, -0.04], [0, 0, 0]),
    ):
        normals, offsets = module._planes(nodes, facets, solid, 1.0)
        np.testing.assert_allclose(normals[0], [normal] * 3, atol=1e-9)
        np.testing.assert_allclose(offsets[0], 0.05 * normal[2], atol=1e-9)
