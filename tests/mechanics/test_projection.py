"""The lifted Hessian of the body. Oracle: d2Psi/dF2 in full, its negative eigenvalues clipped by numpy, pulled back."""

import numpy as np
import pytest

from hydrostat.mechanics import NeoHookean

MU, LAME = 11e3, 17e3
NONE = np.zeros(0)


def simplex(dim: int) -> np.ndarray:
    """A crooked element."""
    random = np.random.default_rng(dim)
    return 0.01 * (np.vstack([np.zeros(dim), np.eye(dim)]) + 0.2 * random.uniform(-1, 1, (dim + 1, dim)))


def second_derivative(F: np.ndarray) -> np.ndarray:
    """Of Psi by F, (dim dim, dim dim): dP = mu dF + (mu - lambda ln J) F^-T dF^T F^-T + lambda (F^-T : dF) F^-T."""
    dim, inverse = len(F), np.linalg.inv(F).T
    log = np.log(np.linalg.det(F))
    rows = []
    for index in np.ndindex(dim, dim):
        change = np.zeros((dim, dim))
        change[index] = 1.0
        stress = MU * change + (MU - LAME * log) * inverse @ change.T @ inverse + LAME * inverse[index] * inverse
        rows.append(stress.ravel())
    return np.array(rows)


def pulled_back(energy: NeoHookean, matrix: np.ndarray) -> np.ndarray:
    """Hessian block of the only element: dF = dx (x) grad N."""
    gradients = energy.shape_gradients[0]
    corners, dim = gradients.shape
    to_nodes = np.einsum("aJ,ik->iJak", gradients, np.eye(dim)).reshape(dim * dim, corners * dim)
    return energy.volumes[0] * to_nodes.T @ matrix @ to_nodes


def clipped(matrix: np.ndarray, share: float) -> np.ndarray:
    values, vectors = np.linalg.eigh(matrix)
    return (vectors * np.where(values < 0, (1 - share) * values, values)) @ vectors.T


def rotation(dim: int, random: np.random.Generator) -> np.ndarray:
    turn = np.linalg.qr(random.standard_normal((dim, dim)))[0]
    turn[0] *= np.linalg.det(turn)
    return turn


SPECIAL = {
    "rest": (1.0, 1.0, 1.0),
    "crushed alike": (0.4, 0.4, 0.4),
    "swollen alike": (2.0, 2.0, 2.0),
    "two alike": (0.5, 0.5, 1.3),
    "one kept": (1.0, 0.5, 0.8),
    "long and thin": (3.0, 0.4, 0.4),
    "flat": (0.02, 1.2, 0.9),
    "nearly flat and wide": (1e-3, 2.0, 2.5),
    "hardly apart": (0.6, 0.6 + 1e-9, 1.0),
}


def states(dim: int) -> dict[str, np.ndarray]:
    """Deformation gradients: special ones, as they are and turned, and random ones."""
    random = np.random.default_rng(dim)
    found = {}
    for name, stretches in SPECIAL.items():
        found[name] = np.diag(stretches[:dim])
        found[f"{name}, turned"] = rotation(dim, random) @ found[name] @ rotation(dim, random)
    for index in range(20):
        stretches = np.diag(10 ** random.uniform(-1, 0.5, dim))
        found[f"random {index}"] = rotation(dim, random) @ stretches @ rotation(dim, random)
    return found


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_it_is_the_projection_of_the_second_derivative(dim: int, share: float) -> None:
    rest, lifted = simplex(dim), 0
    energy = NeoHookean(rest, np.arange(dim + 1)[None], mu=MU, lame=LAME)
    for name, F in states(dim).items():
        exact = second_derivative(F)
        lifted += bool(np.linalg.eigvalsh(exact)[0] < -1e-3 * MU)
        expected = pulled_back(energy, clipped(exact, share))
        found = energy.projected_hessian(rest @ F.T, NONE, share)[0]
        assert np.abs(found - expected).max() < 1e-8 * np.abs(expected).max(), name
    assert lifted >= 10


@pytest.mark.parametrize("dim", [2, 3])
def test_wholly_lifted_it_is_semidefinite(dim: int) -> None:
    """Oracle: eigenvalues by numpy; before lifting some are far below 0."""
    rest, least = simplex(dim), 0.0
    energy = NeoHookean(rest, np.arange(dim + 1)[None], mu=MU, lame=LAME)
    for name, F in states(dim).items():
        before, after = (
            np.linalg.eigvalsh(energy.projected_hessian(rest @ F.T, NONE, share)[0]) for share in (0.0, 1.0)
        )
        assert after[0] > -1e-9 * after[-1], name
        least = min(least, before[0] / before[-1])
    assert least < -1e-2
