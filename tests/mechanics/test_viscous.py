"""Viscous branches: their contract, their stress, what they store."""

import numpy as np
import pytest
from states import deform, rough_mesh

from hydrostat.mechanics import NeoHookean
from hydrostat.mechanics.viscous import MaxwellBranches, ViscousEnergy, roots
from hydrostat.testing import check_energy

ETA = 300.0


def metrics(count: int, dim: int, random: np.random.Generator) -> np.ndarray:
    """Positive definite matrices with eigenvalues of 0.4 to 2."""
    turns = np.linalg.qr(random.standard_normal((count, dim, dim)))[0]
    return (turns * random.uniform(0.4, 2.0, (count, 1, dim))) @ np.swapaxes(turns, 1, 2)


def memory(
    dim: int, random: np.random.Generator, *, time: float = 0.0
) -> tuple[MaxwellBranches, NeoHookean, np.ndarray]:
    """One branch on a small body, the body, and a deformed state."""
    mesh = rough_mesh(dim, random)
    body = NeoHookean(mesh.nodes, mesh.elements, mu=1e4, lame=1e4)
    branch = MaxwellBranches(mesh.nodes, body, viscosities=np.array([ETA]), times=np.array([time]))
    return branch, body, deform(mesh, random)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("dim", [2, 3])
def test_viscous_energy_keeps_the_contract_of_energies(dim: int, seed: int) -> None:
    """Oracle: central differences."""
    random = np.random.default_rng([seed, dim])
    mesh = rough_mesh(dim, random)
    body = NeoHookean(mesh.nodes, mesh.elements, mu=1.0, lame=0.0)
    energy = ViscousEnergy(
        mesh.nodes,
        mesh.elements,
        volumes=body.volumes,
        metrics=metrics(len(mesh.elements), dim, random),
        modulus=ETA,
    )
    check_energy(energy, deform(mesh, random), np.zeros(0), seed=seed)


@pytest.mark.parametrize("dim", [2, 3])
def test_lifted_blocks_have_no_negative_eigenvalue(dim: int) -> None:
    """Oracle: eigenvalues of the blocks; the same blocks not lifted have some, so this can fail."""
    random = np.random.default_rng(dim)
    mesh = rough_mesh(dim, random)
    volumes = NeoHookean(mesh.nodes, mesh.elements, mu=1.0, lame=0.0).volumes
    stretched = metrics(len(mesh.elements), dim, random)
    energy = ViscousEnergy(mesh.nodes, mesh.elements, volumes=volumes, metrics=stretched, modulus=ETA)
    nodes = deform(mesh, random)
    blocks = energy.hessian(nodes, np.zeros(0))
    lifted = energy.projected_hessian(nodes, np.zeros(0), 1.0)
    assert np.linalg.eigvalsh(blocks).min() < -1e-3 * np.abs(blocks).max()
    assert np.linalg.eigvalsh(lifted).min() > -1e-9 * np.abs(blocks).max()


@pytest.mark.parametrize("dim", [2, 3])
def test_a_dashpot_is_a_newtonian_fluid(dim: int) -> None:
    """Oracle: P = 2 eta D F^-T of a body that moves evenly; the step of a dashpot comes to it at first order."""
    random = np.random.default_rng(dim)
    branch, body, nodes = memory(dim, random)
    velocities = random.standard_normal(nodes.shape) * nodes.std()
    gradients = body.deformation_gradients(nodes)
    inverse = np.linalg.inv(gradients)
    rate = body.deformation_gradients(velocities) @ inverse
    stress = ETA * (rate + np.swapaxes(rate, 1, 2)) @ np.swapaxes(inverse, 1, 2)
    expected = body.volumes[:, None, None] * (body.shape_gradients @ np.swapaxes(stress, 1, 2))
    errors = []
    for step in (1e-3, 5e-4, 2.5e-4):
        energy = branch.energy(branch.relax_fully(nodes - step * velocities), step)
        errors.append(np.abs(energy.gradient(nodes, np.zeros(0)) - expected).max() / np.abs(expected).max())
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(1.0, abs=0.05)
    assert errors[-1] < 0.02


@pytest.mark.parametrize("dim", [2, 3])
def test_branches_turn_with_the_body(dim: int) -> None:
    """Oracle: a rotation of the body changes neither the potential of a step, nor the metrics, nor what is stored."""
    random = np.random.default_rng(dim)
    branch, _, nodes = memory(dim, random, time=0.1)
    turn = np.linalg.qr(random.standard_normal((dim, dim)))[0]
    turn *= np.linalg.det(turn) if dim == 3 else np.array([[1.0], [np.linalg.det(turn)]])
    before = metrics(len(branch.relax_fully(nodes)[0]), dim, random)[None]
    energy = branch.energy(before, 0.02)
    none = np.zeros(0)
    assert energy.value(nodes @ turn.T, none) == pytest.approx(energy.value(nodes, none), rel=1e-12)
    assert branch.relax_step(before, nodes @ turn.T, 0.02) == pytest.approx(
        branch.relax_step(before, nodes, 0.02), rel=1e-11
    )
    assert branch.compute_stored_energy(before, nodes @ turn.T) == pytest.approx(
        branch.compute_stored_energy(before, nodes), rel=1e-11
    )


@pytest.mark.parametrize("dim", [2, 3])
def test_a_held_branch_forgets(dim: int) -> None:
    """Oracle: second law: in a body that is held, what a branch stores falls in every step, of any size, to nothing."""
    random = np.random.default_rng(dim)
    branch, _, nodes = memory(dim, random, time=0.1)
    now = metrics(len(branch.relax_fully(nodes)[0]), dim, random)[None]
    stored = [branch.compute_stored_energy(now, nodes)]
    for step in (1e-3, 0.01, 0.1, 1.0, 1e3):
        now = branch.relax_step(now, nodes, step)
        stored.append(branch.compute_stored_energy(now, nodes))
    assert (np.diff(stored) < 0).all()
    assert stored[-1] < 1e-6 * stored[0]
    assert branch.compute_stored_energy(branch.relax_fully(nodes), nodes) == pytest.approx(0.0, abs=1e-12 * stored[0])


def test_roots_and_what_has_none() -> None:
    """Oracle: L L^T; and eigenvalues below 0."""
    random = np.random.default_rng(0)
    for dim in (2, 3):
        given = metrics(20, dim, random)
        lower = roots(given)
        assert lower @ np.swapaxes(lower, 1, 2) == pytest.approx(given, rel=1e-12, abs=1e-12)
        given[3] -= 1.2 * np.linalg.eigvalsh(given[3])[0] * np.eye(dim)
        assert np.flatnonzero(np.isnan(roots(given)[:, -1, -1])).tolist() == [3]


def test_an_extrapolated_metric_that_is_not_positive_definite_is_not_used() -> None:
    random = np.random.default_rng(0)
    branch, _, nodes = memory(2, random, time=0.1)
    good = branch.relax_fully(nodes)
    wrong = good.copy()
    wrong[0, 2] *= -1
    mended = branch.sound(wrong, 2 * good)
    assert (mended[0, 2] == 2 * good[0, 2]).all()
    assert (np.delete(mended, 2, axis=1) == np.delete(good, 2, axis=1)).all()
