"""`FactorizedHessian`: the Hessian (tangent stiffness matrix) of the energy, factorized, with its part of low rank."""

from copy import copy
from functools import cached_property
from typing import Any

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.mechanics.energy import Compliance, Law, LowRankBasis, LowRankStiffness, RankMatrix
from hydrostat.mechanics.factorization import Factorization


class FactorizedHessian:
    """H = K + G D G^T, with K sparse and factorized, G of a few columns, D small and positive semidefinite.

    A taut cable couples all the nodes along it. Kept apart, it neither fills the factors of K nor spoils their
    conditioning: H^-1 = K^-1 - Z R (I + R^T M R)^-1 R^T Z^T with Z = K^-1 G, M = G^T Z, D = R R^T (Woodbury). By
    Haynsworth's inertia formula H has as many negative eigenvalues as K less those of I + R^T M R.

    Attributes:
        definite: True if H is positive definite.
        factors: factors of K.
        low_rank: the springs G D G^T as given at construction.
        columns: G.
        weights: D.
        token: identity of the assembly whose Hessian this is; the factors serve no other assembly.
        source: the `Assembly` whose Hessian this is, if known; not sent to other processes.
    """

    def __init__(
        self, factors: Factorization, low_rank: LowRankStiffness, *, token: object = None, source: object = None
    ) -> None:
        """Take the factors of K, and G and D."""
        self.factors, self.token, self.low_rank, self.source = factors, token, low_rank, source
        self.columns = low_rank.columns
        self._weigh(low_rank.weights)

    def __getstate__(self) -> dict[str, Any]:
        """Return the state that is sent to another process, without `source`."""
        return self.__dict__ | {"source": None}

    def with_low_rank(self, low_rank: LowRankStiffness) -> "FactorizedHessian":
        """Return this stiffness with other springs; if their law is known and they are of the same spans, G stays."""
        new, old = low_rank.series, self.low_rank.series
        same = new is old or (new is not None and old is not None and np.array_equal(new, old))
        if low_rank.law is None or low_rank.weights.shape != self.weights.shape or not same:
            return FactorizedHessian(self.factors, low_rank, token=self.token, source=self.source)
        other = self.with_weights(low_rank.weights)
        other.low_rank = low_rank
        return other

    def with_weights(self, weights: RankMatrix) -> "FactorizedHessian":
        """Return this stiffness with another D, at almost no cost."""
        if not self.factors.singular:
            _ = self.compliance  # Computed once for both
        other = copy(self)
        other._weigh(weights)
        return other

    def _weigh(self, weights: RankMatrix) -> None:
        self.weights, self._pulling = weights, bool(weights.any())
        self._inside = None
        self.__dict__.pop("_signs", None)
        self.definite = self.factors.definite
        if self._indefinite and self.factors.negative <= len(weights):  # more of them no springs make positive
            self.definite = not self.singular and self.factors.negative == int((self._signs < 0).sum())

    @property
    def _indefinite(self) -> bool:
        """True if springs pull that could make up for negative eigenvalues of K."""
        return not self.factors.singular and not self.factors.definite and self._pulling

    @property
    def singular(self) -> bool:
        """True if K or H cannot be solved with."""
        if not self._indefinite:
            return self.factors.singular
        size = np.abs(self._signs)
        return bool(not np.isfinite(size).all() or size.min() < 1e-14 * size.max())

    @cached_property
    def _signs(self) -> Vector:
        """Eigenvalues of I + R^T M R."""
        root, inner = self._inner()
        signs, axes = np.linalg.eigh(inner)
        with np.errstate(divide="ignore", invalid="ignore"):
            self._inside = root @ (axes * (1.0 / signs) @ axes.T) @ root.T
        return signs

    @cached_property
    def _reduced_columns(self) -> LowRankBasis:
        """Forward half of Z."""
        return self.factors.reduce(self.columns) if self.columns.size else self.columns

    @cached_property
    def compliance(self) -> RankMatrix:
        """M [m/N]."""
        return self.factors.inner(self._reduced_columns, self._reduced_columns)

    @property
    def _correction(self) -> RankMatrix:
        """R (I + R^T M R)^-1 R^T."""
        if self._indefinite:
            _ = self._signs
        if self._inside is None:
            root, inner = self._inner()
            self._inside = root @ np.linalg.solve(inner, root.T)
        return self._inside

    def _inner(self) -> tuple[RankMatrix, RankMatrix]:
        """R, and I + R^T M R."""
        root = _square_root(self.weights)
        inner = np.eye(root.shape[1]) + root.T @ self.compliance @ root
        return root, 0.5 * (inner + inner.T)

    @cached_property
    def moves(self) -> LowRankBasis:
        """Z [m/N]: displacement of the nodes per newton of extra cable force."""
        return self.factors.expand(self._reduced_columns) if self.columns.size else self.columns

    def compliance_to(self, columns: LowRankBasis) -> Compliance:
        """Compliance of the body without the springs to forces along some columns."""
        return Compliance(self.factors, columns)

    @property
    def body_definite(self) -> bool:
        """True if K alone is positive definite."""
        return self.factors.definite

    def response(self, weights: RankMatrix) -> LowRankBasis:
        """Displacement of x when each column's spring contracts by 1 m, if D were these weights: -H^-1 G D."""
        inner = np.eye(len(weights)) + weights @ self.compliance
        return -self.moves @ np.linalg.solve(inner, weights)

    def move(self, forces: Float[np.ndarray, " dofs"], low_rank: LowRankStiffness) -> Float[np.ndarray, " dofs"] | None:
        """Displacement of x under forces [N] and springs that can become slack or taut; None if no solution is found.

        Args:
            forces: forces on the body without those of the springs [N].
            low_rank: the springs, with their law and their current elongations.
        """
        assert low_rank.law is not None
        free = self.factors.reduce(forces)
        elongations = low_rank.elongations + self.factors.inner(self._reduced_columns, free)
        tensions = low_rank.law.solve_slack_complementarity(elongations, self.compliance)
        return None if tensions is None else self.factors.expand(free - self._reduced_columns @ tensions)

    def push(
        self, columns: LowRankBasis, elongations: Float[np.ndarray, " rank"], law: Law
    ) -> Float[np.ndarray, " dofs"] | None:
        """Displacement of x by springs along some columns, without the forces that are there; None if none is found.

        Args:
            columns: derivatives of the elongations of the springs.
            elongations: elongations before the springs act [m].
            law: force law of the springs.
        """
        reduced = self.factors.reduce(columns)
        compliance = self.factors.inner(reduced, reduced)
        if self._pulling:
            across = self.factors.inner(self._reduced_columns, reduced)
            pulls = self._correction @ across
            compliance -= across.T @ pulls
            reduced = reduced - self._reduced_columns @ pulls
        tensions = law.solve_slack_complementarity(elongations, np.ascontiguousarray(compliance))
        return None if tensions is None else -self.factors.expand(reduced @ tensions)

    def solve(self, right: Float[np.ndarray, "dofs *columns"]) -> Float[np.ndarray, "dofs *columns"]:
        """Solution of H x = right, for one or several right-hand sides."""
        if not self._pulling:
            return self.factors.solve(right)
        free = self.factors.reduce(right)
        pulls = self._correction @ self.factors.inner(self._reduced_columns, free)
        return self.factors.expand(free - self._reduced_columns @ pulls)


def _square_root(weights: RankMatrix) -> RankMatrix:
    """R with R R^T = weights."""
    diagonal = weights.diagonal()
    if np.count_nonzero(weights) == np.count_nonzero(diagonal):
        return np.diag(np.sqrt(diagonal))
    values, vectors = np.linalg.eigh(weights)
    return vectors * np.sqrt(np.maximum(values, 0.0))


def find_negative_curvature(stiffness: FactorizedHessian, size: int) -> Vector | None:
    """Find a mode of negative curvature, largest entry 1: that of the most negative eigenvalue of H^-1, by Lanczos.

    None if Lanczos does not arrive.
    """
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh  # Imported here: seldom needed.

    inverse = LinearOperator((size, size), matvec=stiffness.solve, dtype=float)  # pyright: ignore[reportCallIssue]
    start = np.random.default_rng(0).standard_normal(size)
    try:
        mode = eigsh(inverse, k=1, which="SA", v0=start, tol=1e-3)[1][:, 0]  # pyright: ignore[reportArgumentType]
    except ArpackError:
        return None
    return mode / np.abs(mode).max()
