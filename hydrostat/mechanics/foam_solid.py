"""`FoamSolid`: elastic energy of foams and fillings (Hill 1978, Storakers 1986), by principal stretches."""

from collections.abc import Mapping
from typing import ClassVar, NamedTuple

import numpy as np

from hydrostat.arrays import Float, Nodes, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, Stencils

Principal = Float[np.ndarray, "points dim"]
Square = Float[np.ndarray, "points dim dim"]


class FoamLaw(NamedTuple):
    """Hyperfoam in the logarithms e of the principal stretches, t = sum of e = ln J, h(x) = exp(x) - 1 - x.

    Psi = sum over terms of 2 mu share / alpha^2 (sum over axes of h(alpha e) + h(-alpha b t) / b), b = nu / (1 - 2 nu).
    This is the form of Storakers as a sum of convex functions of e, each 0 at rest: Psi > 0 elsewhere. Stretched along
    one axis, Poisson's ratio in e is nu at every stretch. With b = nu / (1 - nu) it is that of plane stress.
    """

    shares: Vector
    exponents: Vector
    coupling: float  # b

    def density(self, logs: Principal) -> Vector:
        """Psi over mu at each point."""
        volume = logs.sum(axis=1)
        total = np.zeros(len(logs))
        for share, alpha in zip(self.shares, self.exponents, strict=True):
            own = _exp_rest(alpha * logs).sum(axis=1)
            if self.coupling:
                own += _exp_rest(-alpha * self.coupling * volume) / self.coupling
            total += 2 * share / alpha**2 * own
        return total

    def stresses(self, logs: Principal) -> Principal:
        """dPsi/de over mu: Kirchhoff's principal stresses."""
        volume = logs.sum(axis=1, keepdims=True)
        terms = zip(self.shares, self.exponents, strict=True)
        return sum(
            (
                2 * share / alpha * (np.expm1(alpha * logs) - np.expm1(-alpha * self.coupling * volume))
                for share, alpha in terms
            ),
            np.zeros_like(logs),
        )

    def coupling_derivatives(self, logs: Principal) -> Vector:
        """Derivative by b of dPsi/de over mu, which is equal along all axes."""
        volume = logs.sum(axis=1)
        terms = zip(self.shares, self.exponents, strict=True)
        return sum(
            (2 * share * volume * np.exp(-alpha * self.coupling * volume) for share, alpha in terms),
            np.zeros(len(logs)),
        )

    def curvatures(self, logs: Principal) -> tuple[Principal, Vector]:
        """Second derivatives by e over mu: those of each axis alone, and that of t, which is added to all pairs."""
        volume, own, shared = logs.sum(axis=1), np.zeros_like(logs), np.zeros(len(logs))
        for share, alpha in zip(self.shares, self.exponents, strict=True):
            own += 2 * share * np.exp(alpha * logs)
            shared += 2 * share * self.coupling * np.exp(-alpha * self.coupling * volume)
        return own, shared

    def secants(self, mean: Vector, half: Vector, volume: Vector) -> Vector:
        """(P - P') / (s - s') over mu of two stretches s, by mean and half difference of their logarithms.

        P is the first Piola-Kirchhoff stress. Nothing cancels where the stretches are equal.
        """
        total = np.zeros(len(mean))
        for share, alpha in zip(self.shares, self.exponents, strict=True):
            power = np.exp((alpha - 2) * mean) * _sinh_ratio(alpha - 1, half)
            total += 2 * share / alpha * (power + np.exp(-alpha * self.coupling * volume - 2 * mean))
        return total


class FoamSolid(Energy):
    """Compressible foam of one material on linear or quadratic simplices, see `FoamLaw`.

    It stands for elements in which `NeoHookean` or `QuadraticSolid` has no moduli. Exponents above 2 make a plateau in
    compression and stiffen in tension, exponents below 0 stiffen in compression.
    """

    convex: ClassVar[bool] = False

    def __init__(
        self,
        nodes: Nodes,
        stencils: Stencils,
        *,
        gradients: Float[np.ndarray, "terms points corners dim"],
        volumes: Float[np.ndarray, "terms points"],
        lame: tuple[float, float],
        terms: tuple[tuple[float, float], ...],
        material: int = 0,
        is_free_across: bool = False,
    ) -> None:
        """Elements on the rest shape `nodes`.

        Args:
            nodes: rest positions [m].
            stencils: nodes of each element.
            gradients: gradients of its shape functions at each point of quadrature [1/m].
            volumes: volume that each point stands for [m^3].
            lame: Lame's parameters mu and lambda at rest [Pa].
            terms: share of mu, above 0, and exponent, not 0, of each term.
            material: index of the material, for `parameter_derivative`.
            is_free_across: True for plane stress.
        """
        self.stencils = np.ascontiguousarray(stencils)
        (self.mu, self.lame), self.material, self.is_free_across = lame, material, is_free_across
        strained = self.lame / (2 * self.mu)
        shares, exponents = np.array(terms, dtype=float).T
        self.law = FoamLaw(shares, exponents, strained / (1 + strained) if is_free_across else strained)
        self._rest, self._dim = nodes, nodes.shape[1]
        self._gradients = gradients.reshape(-1, *gradients.shape[2:])
        self._volumes, self._points = volumes.ravel(), gradients.shape[1]
        self._pairs = np.triu_indices(self._dim, 1)
        self._last: tuple[Nodes, _Frame | None] = (nodes[:0], None)

    def value(self, nodes: Nodes, controls: Vector) -> float:
        """Computed from the displacement gradient, so that little is lost to rounding near rest."""
        derivatives = self._deformation_gradients(nodes)
        if not (np.linalg.det(np.eye(self._dim) + derivatives) > 0.0).all():
            return np.inf
        with np.errstate(over="ignore", invalid="ignore"):
            stored = self.mu * float(self._volumes @ self.law.density(self._frame(nodes, derivatives).logs))
        return stored if np.isfinite(stored) else np.inf

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        frame = self._frame(nodes)
        return self._forces(frame, self.mu * self.law.stresses(frame.logs))

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        """Hessian blocks; its negative part is known in the principal axes (Smith, de Goes and Kim 2019)."""
        frame, dim = self._frame(nodes), self._dim
        scaling, flips, twists = self._eigensystem(frame)
        if share:
            values, vectors = np.linalg.eigh(scaling)
            values += share * (np.maximum(values, 0.0) - values)
            scaling = (vectors * values[:, None, :]) @ np.swapaxes(vectors, 1, 2)
            flips, twists = (part + share * (np.maximum(part, 0.0) - part) for part in (flips, twists))
        count, corners = len(self._gradients), self.stencils.shape[1]
        across = np.swapaxes(self._gradients @ frame.right, 1, 2)
        turned = np.swapaxes(frame.left, 1, 2)[:, :, None, None] * across[:, None, :, :, None]
        turned = turned.reshape(count, dim, dim, corners * dim)
        axes, (one, two) = np.arange(dim), self._pairs
        straight, across, back = turned[:, axes, axes], turned[:, one, two], turned[:, two, one]
        weights = (self.mu * self._volumes)[:, None, None]
        modes = np.concatenate([straight, across + back, across - back], axis=1)
        stiff = np.concatenate(
            [
                scaling @ straight,
                0.5 * flips[:, :, None] * modes[:, dim : dim + len(one)],
                0.5 * twists[:, :, None] * modes[:, dim + len(one) :],
            ],
            axis=1,
        )
        shape = len(self.stencils), -1, corners * dim  # points of an element are rows of one product
        return np.swapaxes(modes.reshape(shape), 1, 2) @ (weights * stiff).reshape(shape)

    def min_volume_ratio(self, nodes: Nodes) -> float:
        return min(1.0, float(np.linalg.det(np.eye(self._dim) + self._deformation_gradients(nodes)).min(initial=1.0)))

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        """By mu and lame of the material, and by the thickness."""
        frame, moved = self._frame(nodes), field[self.stencils]
        own = float((self._forces(frame, self.law.stresses(frame.logs)) * moved).sum())
        equal = np.repeat(self.law.coupling_derivatives(frame.logs)[:, None], self._dim, axis=1)
        by_coupling = float((self._forces(frame, equal) * moved).sum())
        strained = self.lame / (2 * self.mu)
        if self.is_free_across:
            by_coupling /= (1 + strained) ** 2
        at = [self.material]
        return {
            "mu": np.bincount(at, [own - strained * by_coupling]),
            "lame": np.bincount(at, [0.5 * by_coupling]),
            "thickness": np.array([self.mu * own]),
        }

    def _deformation_gradients(self, nodes: Nodes) -> Square:
        """F - I at each point."""
        moved = (nodes - self._rest)[self.stencils]
        moved = np.repeat(moved - moved[:, :1], self._points, axis=0)
        return np.swapaxes(moved, 1, 2) @ self._gradients

    def _frame(self, nodes: Nodes, derivatives: Square | None = None) -> "_Frame":
        """Principal axes at `nodes`; the last ones are kept, as value, forces and Hessian follow one another."""
        last, kept = self._last
        if kept is not None and np.array_equal(last, nodes):
            return kept
        derivatives = self._deformation_gradients(nodes) if derivatives is None else derivatives
        logs, right = _logs(derivatives)
        left = (right + derivatives @ right) * np.exp(-logs)[:, None, :]
        frame = _Frame(logs, left, right)
        self._last = nodes.copy(), frame  # in one assignment, so that threads may share the energy
        return frame

    def _forces(self, frame: "_Frame", kirchhoff: Principal) -> Blocks:
        """Forces on the nodes of each element by principal stresses of Kirchhoff [Pa]."""
        scaled = frame.left * (self._volumes[:, None] * kirchhoff * np.exp(-frame.logs))[:, None, :]
        forces = self._gradients @ frame.right @ np.swapaxes(scaled, 1, 2)
        return forces.reshape(len(self.stencils), self._points, -1, self._dim).sum(axis=1)

    def _eigensystem(self, frame: "_Frame") -> tuple[Square, Vector, Vector]:
        """Second derivative of Psi by F over mu: of the principal stretches, then of sums and differences of pairs."""
        logs, (one, two) = frame.logs, self._pairs
        stretch, volume = np.exp(logs), logs.sum(axis=1)
        own, shared = self.law.curvatures(logs)
        kirchhoff = self.law.stresses(logs)
        scaling = shared[:, None, None] / (stretch[:, :, None] * stretch[:, None, :])
        axes = np.arange(self._dim)
        scaling[:, axes, axes] += (own - kirchhoff) / stretch**2
        pulls = kirchhoff / stretch
        mean, half = 0.5 * (logs[:, one] + logs[:, two]), 0.5 * (logs[:, one] - logs[:, two])
        columns = [self.law.secants(mean[:, k], half[:, k], volume) for k in range(len(one))]
        twists = (pulls[:, one] + pulls[:, two]) / (stretch[:, one] + stretch[:, two])
        return scaling, np.stack(columns, axis=1), twists


class _Frame(NamedTuple):
    """F = left diag(exp(logs)) right^T at each point."""

    logs: Principal
    left: Square
    right: Square


def _logs(derivatives: Square) -> tuple[Principal, Square]:
    """Logarithms of the principal stretches and their axes at rest, from F - I."""
    turned = np.swapaxes(derivatives, 1, 2)
    values, axes = np.linalg.eigh(derivatives + turned + turned @ derivatives)
    return 0.5 * np.log1p(np.maximum(values, -1.0 + 1e-15)), axes


def _exp_rest(x: np.ndarray) -> np.ndarray:
    """exp(x) - 1 - x without cancellation."""
    near = np.abs(x) < 1e-2
    small = np.where(near, x, 0.0)
    series = 0.5 * small**2 * (1 + small / 3 * (1 + small / 4 * (1 + small / 5 * (1 + small / 6 * (1 + small / 7)))))
    return np.where(near, series, np.expm1(x) - x)


def _sinh_ratio(factor: float, x: np.ndarray) -> np.ndarray:
    """sinh(factor x) / sinh(x), also at 0."""
    near = np.abs(x) < 1e-4
    safe = np.where(near, 1.0, x)
    return np.where(near, factor * (1 + (factor**2 - 1) * x**2 / 6), np.sinh(factor * safe) / np.sinh(safe))
