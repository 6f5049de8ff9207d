"""`FactorizedHessian`: a factorized body with cables of low rank. Oracle: the same matrix, dense, by numpy."""

import numpy as np
import pytest
from builders import strip_mesh
from scipy.sparse import csc_array

from hydrostat.mechanics import FactorizedHessian, SymbolicFactorization
from hydrostat.mechanics.energy import LowRankStiffness
from hydrostat.mechanics.tension_law import TensionLaw

MESH = strip_mesh(5, 2)
SIZE = MESH.nodes.size
RANK = 3


def body(shift: float, seed: int = 0) -> np.ndarray:
    """A symmetric matrix on the pattern of the mesh, positive definite but for the shift of its least eigenvalue."""
    random = np.random.default_rng(seed)
    matrix = np.zeros((SIZE, SIZE))
    for element in MESH.elements:
        dofs = (2 * element[:, None] + np.arange(2)).ravel()
        half = random.standard_normal((6, 6))
        matrix[np.ix_(dofs, dofs)] += half @ half.T
    least, second = np.linalg.eigvalsh(matrix)[:2]
    assert second > least + 1e-3
    return matrix + (shift - least) * np.eye(SIZE)


def made(matrix: np.ndarray, columns: np.ndarray, weights: np.ndarray) -> FactorizedHessian:
    pattern = csc_array(np.ones_like(matrix) * (body(1.0) != 0))
    pattern.sort_indices()
    values = matrix.T[pattern.T.toarray() != 0]
    analysis = SymbolicFactorization(pattern.indptr, pattern.indices, dim=2, points=MESH.nodes)
    return FactorizedHessian(analysis.factorize(values), LowRankStiffness(columns=columns, weights=weights))


def weights_of(kind: str, random: np.random.Generator) -> np.ndarray:
    if kind == "diagonal":
        return np.diag([3.0, 0.0, 50.0])
    if kind == "full":
        half = random.standard_normal((RANK, RANK))
        return half @ half.T
    if kind == "rank one":
        half = random.standard_normal((RANK, 1))
        return half @ half.T
    return np.zeros((RANK, RANK))


@pytest.mark.parametrize("kind", ["diagonal", "full", "rank one", "none"])
@pytest.mark.parametrize("shift", [0.5, -0.5])
@pytest.mark.parametrize("seed", range(3))
def test_it_solves_and_knows_its_inertia(kind: str, shift: float, seed: int) -> None:
    random = np.random.default_rng(seed)
    matrix, columns, weights = body(shift, seed), random.standard_normal((SIZE, RANK)), weights_of(kind, random)
    found, whole = made(matrix, columns, weights), matrix + columns @ weights @ columns.T
    right = random.standard_normal((SIZE, 2))
    for given in (right, right[:, 0]):
        expected = np.linalg.solve(whole, given)
        assert found.solve(given) == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    assert found.definite == bool(np.linalg.eigvalsh(whole)[0] > 0)
    assert found.body_definite == (shift > 0)
    assert not found.singular


@pytest.mark.parametrize(("pull", "definite"), [(0.9, False), (1.1, True), (1e6, True)])
def test_a_cable_along_the_soft_mode_holds_the_body(pull: float, definite: bool) -> None:
    """K has one eigenvalue of -0.5, and the cable adds `pull` halves along its vector: the sign of the sum decides."""
    matrix = body(-0.5)
    soft = np.linalg.eigh(matrix)[1][:, :1]
    found = made(matrix, soft, np.array([[0.5 * pull]]))
    assert found.definite == definite
    assert not found.body_definite
    assert found.definite == bool(np.linalg.eigvalsh(matrix + 0.5 * pull * soft @ soft.T)[0] > 0)


def test_two_soft_modes_are_not_held_by_one_cable() -> None:
    """Inertia by number, not by sign alone: K has two negative eigenvalues, the cable mends one."""
    matrix = body(0.5)
    values, vectors = np.linalg.eigh(matrix)
    shifted = matrix - (values[1] + 0.3) * np.eye(SIZE)
    for rank, definite in ((1, False), (2, True)):
        columns, weights = vectors[:, :rank], 1e3 * np.eye(rank)
        assert made(shifted, columns, weights).definite == definite
        assert bool(np.linalg.eigvalsh(shifted + columns @ weights @ columns.T)[0] > 0) == definite


def test_other_weights_are_as_if_made_with_them() -> None:
    """And the first stays as it was."""
    random = np.random.default_rng(4)
    matrix, columns = body(-0.5), random.standard_normal((SIZE, RANK))
    right = random.standard_normal(SIZE)
    first = made(matrix, columns, weights_of("diagonal", random))
    before = first.solve(right)
    for kind in ("full", "none", "diagonal"):
        weights = weights_of(kind, random)
        changed, fresh = first.with_weights(weights), made(matrix, columns, weights)
        assert changed.solve(right) == pytest.approx(fresh.solve(right), rel=1e-12)
        assert (changed.definite, changed.singular) == (fresh.definite, fresh.singular)
        assert changed.weights is weights
    assert (first.solve(right) == before).all()


def test_moves_and_compliance_are_what_they_say() -> None:
    random = np.random.default_rng(5)
    matrix, columns = body(0.5), random.standard_normal((SIZE, RANK))
    found = made(matrix, columns, np.eye(RANK))
    expected = np.linalg.solve(matrix, columns)
    assert found.moves == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    assert found.compliance == pytest.approx(columns.T @ expected, rel=1e-9, abs=1e-9)
    others = random.standard_normal((SIZE, 5))
    expected = np.linalg.solve(matrix, others)
    given = found.compliance_to(others)
    assert given.moves == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    assert given.compliance == pytest.approx(others.T @ expected, rel=1e-9, abs=1e-9)


def test_springs_that_came_since_count_whole() -> None:
    """Springs without a law may be others, and more: then it is as if made with them (inverse of the dense sum)."""
    random = np.random.default_rng(6)
    matrix, columns = body(0.5), random.standard_normal((SIZE, RANK + 2))
    found = made(matrix, columns[:, :RANK], np.eye(RANK))
    other = found.with_low_rank(LowRankStiffness(columns=columns, weights=2.0 * np.eye(RANK + 2)))
    right = random.standard_normal(SIZE)
    expected = np.linalg.solve(matrix + 2.0 * columns @ columns.T, right)
    assert other.solve(right) == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("seed", range(3))
def test_a_move_knows_that_cables_go_slack_and_taut(seed: int) -> None:
    """Balance of forces at its end, by the law itself: K x + G T(s + G^T x) = f, some cables slack and some taut."""
    random = np.random.default_rng(seed)
    matrix, columns = body(0.5, seed), random.standard_normal((SIZE, RANK))
    law = TensionLaw(stiffness=np.full(RANK, 50.0), smoothing=np.full(RANK, 1e-3))
    springs = LowRankStiffness(
        columns=columns, weights=np.zeros((RANK, RANK)), elongations=np.array([-2.0, -0.1, 1.0]), law=law
    )
    forces = random.standard_normal(SIZE)
    moved = made(matrix, columns, np.eye(RANK)).move(forces, springs)
    assert moved is not None
    tensions = law.tension(springs.elongations + columns.T @ moved)
    assert matrix @ moved + columns @ tensions == pytest.approx(forces, abs=1e-8)
    assert 0 < np.count_nonzero(tensions) < RANK


def test_a_singular_body_is_named() -> None:
    """A node that no stiffness holds."""
    matrix = body(0.5)
    matrix[:2], matrix[:, :2] = 0.0, 0.0
    found = made(matrix, np.ones((SIZE, 1)), np.ones((1, 1)))
    assert found.singular
    assert not found.definite


def test_a_sum_that_is_singular_is_named() -> None:
    """The cable takes an entry of -0.5 exactly to 0: K can be solved with, H cannot."""
    matrix, columns = np.eye(SIZE), np.zeros((SIZE, 2))
    matrix[0, 0], columns[0, 0], columns[3, 1] = -0.5, 1.0, 1.0
    found = made(matrix, columns, np.diag([0.5, 8.0]))
    assert found.singular
    assert not found.definite
    held = found.with_weights(np.diag([0.75, 8.0]))
    assert held.definite
    assert not held.singular


@pytest.mark.parametrize("kind", ["diagonal", "none"])
@pytest.mark.parametrize("seed", range(3))
def test_springs_push(kind: str, seed: int) -> None:
    """The dense matrix balances the springs' tensions at the elongations that are left; slack ones do not pull."""
    random = np.random.default_rng(seed)
    matrix, columns, weights = body(0.5, seed), random.standard_normal((SIZE, RANK)), weights_of(kind, random)
    springs, elongations = random.standard_normal((SIZE, 6)), random.standard_normal(6)
    law = TensionLaw(stiffness=np.full(6, 40.0), smoothing=np.full(6, 1e-3))
    move = made(matrix, columns, weights).push(springs, elongations, law)
    assert move is not None
    tensions = law.tension(elongations + springs.T @ move)
    assert 0 < (tensions > 0).sum() < 6
    whole = matrix + columns @ weights @ columns.T
    assert whole @ move == pytest.approx(-springs @ tensions, abs=1e-8 * np.abs(springs @ tensions).max())
