"""Materials of the peers and their equilibria, in plain NumPy and SciPy: what all answers are measured against.

All agree at small strain: each takes Lame's parameters. P is the force per area of the rest shape by the deformation
gradient F (first Piola-Kirchhoff stress), J = det F.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from held_body import HeldBody
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

Matrices = np.ndarray
"""(..., elements, 3, 3)."""


@dataclass(frozen=True)
class Law:
    """A material.

    Attributes:
        stress: P [Pa] of F, mu, lame.
        change: how P changes with F: of F, a change of F, mu, lame.
        keeps_sign: whether no element can be turned inside out.
    """

    stress: Callable[[Matrices, float, float], Matrices]
    change: Callable[[Matrices, Matrices, float, float], Matrices]
    keeps_sign: bool = False


def _transposed(given: Matrices) -> Matrices:
    return np.swapaxes(given, -1, -2)


def _trace(given: Matrices) -> Matrices:
    return np.trace(given, axis1=-2, axis2=-1)[..., None, None]


def _determinant(F: Matrices) -> Matrices:
    return np.linalg.det(F)[..., None, None]


def _turned(F: Matrices, dF: Matrices) -> tuple[Matrices, Matrices, Matrices]:
    """F^-T, the trace of F^-1 dF, and F^-T dF^T F^-T."""
    inverse = _transposed(np.linalg.inv(F))
    return inverse, _trace(_transposed(inverse) @ dF), inverse @ _transposed(dF) @ inverse


def _neo_hookean(F: Matrices, mu: float, lame: float) -> Matrices:
    """P of Psi = mu/2 (tr C - 3) - mu ln J + lambda/2 (ln J)^2, hydrostat's own."""
    inverse = _transposed(np.linalg.inv(F))
    return mu * (F - inverse) + lame * np.log(_determinant(F)) * inverse


def _neo_hookean_change(F: Matrices, dF: Matrices, mu: float, lame: float) -> Matrices:
    inverse, trace, turned = _turned(F, dF)
    return mu * dF + (mu - lame * np.log(_determinant(F))) * turned + lame * trace * inverse


def _saint_venant(F: Matrices, mu: float, lame: float) -> Matrices:
    """P of Psi = mu tr(E^2) + lambda/2 (tr E)^2, E = (C - 1)/2."""
    E = (_transposed(F) @ F - np.eye(3)) / 2
    return F @ (2 * mu * E + lame * _trace(E) * np.eye(3))


def _saint_venant_change(F: Matrices, dF: Matrices, mu: float, lame: float) -> Matrices:
    E, dE = (_transposed(F) @ F - np.eye(3)) / 2, (_transposed(F) @ dF + _transposed(dF) @ F) / 2
    return dF @ (2 * mu * E + lame * _trace(E) * np.eye(3)) + F @ (2 * mu * dE + lame * _trace(dE) * np.eye(3))


def _stable(F: Matrices, mu: float, lame: float) -> Matrices:
    """P of Psi = mu/2 (tr C - 3) + k/2 (J - 1 - mu/k)^2, k = lambda + mu (Smith et al. 2018, no logarithm)."""
    k, J = lame + mu, _determinant(F)
    return mu * F + k * (J - 1 - mu / k) * J * _transposed(np.linalg.inv(F))


def _stable_change(F: Matrices, dF: Matrices, mu: float, lame: float) -> Matrices:
    k, J = lame + mu, _determinant(F)
    inverse, trace, turned = _turned(F, dF)
    return mu * dF + k * J * (J * trace * inverse + (J - 1 - mu / k) * (trace * inverse - turned))


def _smith(F: Matrices, mu: float, lame: float) -> Matrices:
    """P of Psi = m/2 (tr C - 3) - m/2 ln(tr C + 1) + k/2 (J - 1 - 3m/4k)^2 with m = 4/3 mu, k = lambda + 5/6 mu."""
    m, k, J = 4 / 3 * mu, lame + 5 / 6 * mu, _determinant(F)
    swollen = _trace(_transposed(F) @ F) + 1
    return m * (1 - 1 / swollen) * F + k * (J - 1 - 0.75 * m / k) * J * _transposed(np.linalg.inv(F))


def _smith_change(F: Matrices, dF: Matrices, mu: float, lame: float) -> Matrices:
    m, k, J = 4 / 3 * mu, lame + 5 / 6 * mu, _determinant(F)
    swollen = _trace(_transposed(F) @ F) + 1
    inverse, trace, turned = _turned(F, dF)
    shear = m * (1 - 1 / swollen) * dF + 2 * m * _trace(_transposed(F) @ dF) / swollen**2 * F
    return shear + k * J * (J * trace * inverse + (J - 1 - 0.75 * m / k) * (trace * inverse - turned))


LAWS = {
    "Neo-Hookean": Law(_neo_hookean, _neo_hookean_change, keeps_sign=True),
    "St. Venant-Kirchhoff": Law(_saint_venant, _saint_venant_change),
    "stable Neo-Hookean": Law(_stable, _stable_change),
    "stable, with logarithm": Law(_smith, _smith_change),
}


class Reference:
    """Forces and equilibria of a held body by a law, made of nothing that a peer or hydrostat has."""

    def __init__(self, body: HeldBody, law: Law) -> None:
        """The body with its loads."""
        self.body, self.law = body, law
        corners = body.nodes[body.elements]
        spans = _transposed(corners[:, 1:] - corners[:, :1])
        inverse = np.linalg.inv(spans)
        self.gradients = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
        self.volumes = np.linalg.det(spans) / 6
        self.dofs = (3 * body.elements[:, :, None] + np.arange(3)).reshape(len(body.elements), 12)
        self.free = np.flatnonzero(np.repeat(~body.held, 3))

    def deformation(self, nodes: np.ndarray) -> Matrices:
        """F of each element; from displacements, so that little is lost to rounding."""
        moved = (nodes - self.body.nodes)[self.body.elements]
        return np.eye(3) + _transposed(moved) @ self.gradients

    def left_over(self, nodes: np.ndarray, share: float = 1.0) -> np.ndarray:
        """Force of the material less a share of the load, at nodes not held [N]; infinite where one is inverted."""
        F = self.deformation(nodes)
        if self.law.keeps_sign and not (np.linalg.det(F) > 0).all():
            return np.full(len(self.free), np.inf)
        stress = self.law.stress(F, self.body.mu, self.body.lame)
        forces = np.einsum("e,eij,enj->eni", self.volumes, stress, self.gradients)
        total = np.bincount(self.dofs.ravel(), forces.ravel(), self.body.nodes.size)
        return (total - share * self.body.forces.ravel())[self.free]

    def hessian(self, nodes: np.ndarray) -> coo_array:
        """Second derivatives of the energy at nodes that are not held [N/m]."""
        F, unit = self.deformation(nodes), np.eye(9).reshape(9, 1, 3, 3)
        change = self.law.change(F, unit, self.body.mu, self.body.lame).reshape(3, 3, -1, 3, 3)
        blocks = np.einsum(
            "e,enl,kleij,emj->enkmi", self.volumes, self.gradients, change, self.gradients, optimize=True
        )
        rows, columns = (np.broadcast_to(d, (len(d), 12, 12)) for d in (self.dofs[:, :, None], self.dofs[:, None]))
        size = self.body.nodes.size
        whole = coo_array((blocks.ravel(), (rows.ravel(), columns.ravel())), (size, size))
        return whole.tocsr()[self.free][:, self.free]

    def equilibrium(self, start: np.ndarray, share: float = 1.0, tolerance: float = 1e-12) -> np.ndarray | None:
        """Newton's method from `start` until no force left over exceeds `tolerance` of the load; None if it fails."""
        nodes = np.where(self.body.held[:, None], self.body.nodes, start)
        goal = tolerance * np.linalg.norm(self.body.forces.sum(axis=0))
        residual = self.left_over(nodes, share)
        for _ in range(60):
            if np.abs(residual).max() <= goal:
                return nodes
            step = np.zeros(nodes.size)
            step[self.free] = np.asarray(spsolve(self.hessian(nodes).tocsc(), -residual))
            if not np.isfinite(step).all():
                return None
            most = 10 * np.linalg.norm(residual) + goal
            for halvings in range(11):
                trial = nodes + step.reshape(nodes.shape) / 2**halvings
                residual = self.left_over(trial, share)
                if np.linalg.norm(residual) < most:
                    break
            else:
                return None
            nodes = trial
        return None

    def loaded(self, steps: int = 20) -> np.ndarray | None:
        """Equilibrium reached from the rest shape as the load grows in equal steps; None if Newton fails on the way."""
        nodes: np.ndarray | None = self.body.nodes
        for share in np.linspace(1 / steps, 1, steps):
            nodes = self.equilibrium(nodes, share, 1e-6 if share < 1 else 1e-12)
            if nodes is None:
                return None
        return nodes
