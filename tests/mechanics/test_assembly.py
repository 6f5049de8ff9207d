"""The assembled sum. Oracle: the same sum over terms by plain loops into dense arrays."""

import numpy as np
import pytest
from states import CONTROLS, LAW, deform, rough_mesh

from hydrostat.geometry import locate
from hydrostat.mechanics import Assembly, CableEnergy, CableSegments, DeadLoadEnergy, NeoHookean, PinEnergy
from hydrostat.mechanics.energy import nearest_semidefinite
from hydrostat.mechanics.sparsity import SparsityPattern


def energies(dim: int, seed: int) -> tuple[Assembly, np.ndarray, np.ndarray]:
    random = np.random.default_rng([dim, seed])
    mesh = rough_mesh(dim, random)
    anchors = locate(mesh, mesh.nodes[:3] * 0.9 + 0.005)
    parts = [
        NeoHookean(mesh.nodes, mesh.elements, mu=11e3, lame=17e3),
        PinEnergy(
            stencils=anchors.stencils, weights=anchors.weights, targets=mesh.nodes[:3], stiffness=np.full(3, 1e3)
        ),
    ]
    for control in (2, 0):
        stencils = np.array([random.choice(len(mesh.nodes), 5, replace=False) for _ in range(2)])
        parts.append(
            CableEnergy(
                mesh.nodes,
                segments=CableSegments(
                    stencils=stencils,
                    weights=random.dirichlet(np.ones(5), 2) - random.dirichlet(np.ones(5), 2),
                    offsets=np.zeros((2, dim)),
                    cables=np.array([0, 0]),
                ),
                law=LAW,
                winches=np.array([control]),
                slack=np.zeros(1),
            )
        )
    assembly = Assembly(parts, rest=mesh.nodes, control_count=CONTROLS)
    return assembly, deform(mesh, random), np.array([0.05, 0.0, 0.05])


def dense(
    assembly: Assembly, nodes: np.ndarray, controls: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    dim, size = nodes.shape[1], nodes.size
    value, gradient, hessian = 0.0, np.zeros(size), np.zeros((size, size))
    mixed = np.zeros((size, len(controls)))
    for energy in assembly.energies:
        value += energy.value(nodes, controls)
        blocks, seconds = energy.gradient(nodes, controls), energy.hessian(nodes, controls)
        for term, stencil in enumerate(energy.stencils):
            dofs = [int(node) * dim + axis for node in stencil for axis in range(dim)]
            for i, row in enumerate(dofs):
                gradient[row] += blocks[term].ravel()[i]
                for j, column in enumerate(dofs):
                    hessian[row, column] += seconds[term, i, j]
                if energy.controls is not None:
                    mixed[row, energy.controls[term]] += energy.control_gradient(nodes, controls)[term].ravel()[i]
    return value, gradient, hessian, mixed


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_the_sum_is_that_of_plain_loops(dim: int, seed: int) -> None:
    assembly, nodes, controls = energies(dim, seed)
    value, gradient, hessian, mixed = dense(assembly, nodes, controls)
    found = assembly.hessian(nodes, controls)
    assert assembly.value(nodes, controls) == pytest.approx(value, rel=1e-13)
    assert assembly.gradient(nodes, controls) == pytest.approx(gradient, abs=1e-12 * np.abs(gradient).max())
    assert found.toarray() == pytest.approx(hessian, abs=1e-12 * np.abs(hessian).max())
    assert found.has_sorted_indices
    springs = assembly.low_rank_hessian(nodes, controls)
    columns, weights = springs.columns, springs.weights
    parts = assembly.low_rank_hessians(nodes, controls)
    assert [part is None for part in parts] == [True, True, False, False]
    expected = sum(part.columns @ part.weights @ part.columns.T for part in parts if part is not None)
    assert np.linalg.matrix_rank(expected) == 2
    assert columns @ weights @ columns.T == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())
    derivative = assembly.control_derivative(nodes, controls).toarray()
    assert derivative == pytest.approx(mixed, abs=1e-12 * np.abs(mixed).max())
    assert mixed[:, [0, 2]].any(axis=0).all()
    assert not mixed[:, 1].any()


@pytest.mark.parametrize("dim", [2, 3])
def test_the_projected_sum_has_no_negative_eigenvalue(dim: int) -> None:
    """The state is chosen indefinite, so that the projection has something to do."""
    assembly, nodes, controls = energies(dim, 0)
    nodes = nodes * 0.4
    before = np.linalg.eigvalsh(assembly.hessian(nodes, controls).toarray())
    after = np.linalg.eigvalsh(assembly.hessian(nodes, controls, projection=1.0).toarray())
    assert before[0] < -1e-3 * before[-1]
    assert after[0] > -1e-12 * after[-1]


def test_without_controls_the_control_derivative_is_empty() -> None:
    assembly, nodes, controls = energies(2, 0)
    bare = Assembly(assembly.energies[:2], rest=nodes, control_count=CONTROLS)
    assert bare.control_derivative(nodes, controls).shape == (nodes.size, CONTROLS)
    assert bare.control_derivative(nodes, controls).nnz == 0


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_the_stiffness_solves_with_the_whole_hessian(dim: int, shift: float) -> None:
    """Oracle: a dense solve with blocks, part of low rank and shift, a fraction of the largest diagonal entry."""
    assembly, nodes, controls = energies(dim, 0)
    springs = assembly.low_rank_hessian(nodes, controls)
    columns, weights = springs.columns, springs.weights
    matrix = assembly.hessian(nodes, controls, projection=0.5).toarray()
    matrix += shift * matrix.diagonal().max() * np.eye(len(matrix)) + columns @ weights @ columns.T
    right = np.random.default_rng(0).standard_normal(nodes.size)
    found = assembly.stiffness(nodes, controls, projection=0.5, shift=shift)
    expected = np.linalg.solve(matrix, right)
    assert found.solve(right) == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())
    assert found.definite == bool(np.linalg.eigvalsh(matrix)[0] > 0)


def test_other_energies_on_the_same_stencils() -> None:
    """Oracle: an assembly made afresh. Those on other stencils are refused, and the first assembly stays as it is."""
    assembly, nodes, controls = energies(2, 0)
    body, pins, *cables = assembly.energies
    assert isinstance(body, NeoHookean)
    stiffer = NeoHookean(nodes, body.stencils, mu=3e3, lame=5e3)
    before = assembly.hessian(nodes, controls).toarray()
    found = assembly.with_energies([stiffer, pins, *cables])
    fresh = Assembly([stiffer, pins, *cables], rest=nodes, control_count=CONTROLS)
    assert found.value(nodes, controls) == fresh.value(nodes, controls)
    assert (found.hessian(nodes, controls).toarray() == fresh.hessian(nodes, controls).toarray()).all()
    assert (assembly.hessian(nodes, controls).toarray() == before).all()
    with pytest.raises(ValueError, match="stencils"):
        assembly.with_energies([DeadLoadEnergy(nodes, nodes), pins, *cables])


def test_the_value_is_infinite_where_one_energy_is() -> None:
    assembly, nodes, controls = energies(2, 0)
    assert assembly.value(nodes * [1, -1], controls) == np.inf


def test_nearest_semidefinite_only_lifts_negative_eigenvalues() -> None:
    """Closed form: known eigenvectors, eigenvalues clipped at 0; a definite block stays as it is, to the bit."""
    random = np.random.default_rng(0)
    values = np.array([[-3.0, -1e-3, 0.5, 2.0], [0.0, 1e-3, 1.0, 5.0], [-4.0, -3.0, -2.0, -1.0]])
    vectors = np.linalg.qr(random.standard_normal((3, 4, 4)))[0]
    blocks = (vectors * values[:, None, :]) @ np.swapaxes(vectors, 1, 2)
    blocks = 0.5 * (blocks + np.swapaxes(blocks, 1, 2))
    expected = (vectors * np.maximum(values, 0)[:, None, :]) @ np.swapaxes(vectors, 1, 2)
    found = nearest_semidefinite(blocks)
    assert found == pytest.approx(expected, abs=1e-13)
    definite = blocks[1:2] + np.eye(4)
    assert (nearest_semidefinite(definite) == definite).all()


def test_patterns_of_terms_that_come_and_go_keep_one_other() -> None:
    """However many are made before one is factorized: no chain of them."""
    rest = np.random.default_rng(0).normal(size=(40, 2))
    pattern = begun = SparsityPattern([np.array([[0, 1]])], rest)
    for number in range(2000):
        pattern = pattern.with_replaced_stencils([np.array([[number % 40, (number + 1) % 40]])])
    pattern.settle()
    wanted = {0 * 40 + 1, 1 * 40 + 0, 39 * 40 + 0, 0 * 40 + 39, *range(0, 1600, 41)}
    assert set(pattern.entries.tolist()) == wanted
    assert pattern.with_replaced_stencils([np.array([[3, 4]])]).analysis is not begun.analysis
