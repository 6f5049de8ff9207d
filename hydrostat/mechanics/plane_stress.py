"""`PlaneStress`: resistance of a flat body to a change of area, free to become thicker or thinner."""

from collections.abc import Mapping
from typing import ClassVar, NamedTuple

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, Stencils


class PlaneStress(Energy):
    """Least of mu/2 (s^2 - 1) - mu ln s + lambda/2 (ln J + ln s)^2 over the stretch s across the plane, J by area.

    It takes the place of lambda/2 (ln J)^2 in `NeoHookean` or `QuadraticSolid`, which is plane strain, s = 1. There is
    no stress across the plane then: mu (s^2 - 1) + lambda (ln J + ln s) = 0. Nothing locks, as s follows J.
    """

    convex: ClassVar[bool] = False

    def __init__(
        self,
        nodes: Nodes,
        stencils: Stencils,
        *,
        gradients: Float[np.ndarray, "terms corners 2"],
        volumes: Float[np.ndarray, " terms"],
        mu: Float[np.ndarray, " terms"],
        lame: Float[np.ndarray, " terms"],
        materials: Int[np.ndarray, " terms"],
    ) -> None:
        """Points of quadrature on the rest shape `nodes`.

        Args:
            nodes: rest positions [m].
            stencils: nodes of the element of each point.
            gradients: gradients of its shape functions at the point [1/m].
            volumes: volume that the point stands for [m^3].
            mu: shear modulus at each point [Pa].
            lame: Lame's first parameter at each point [Pa].
            materials: index of the material of each point.
        """
        self.stencils, self.gradients, self.volumes = stencils, gradients, volumes
        self.mu, self.lame, self.materials = mu, lame, materials
        self._rest = nodes
        x, y = gradients[:, :, 0], gradients[:, :, 1]
        turned = x[:, :, None] * y[:, None, :] - y[:, :, None] * x[:, None, :]
        corners = stencils.shape[1]
        curvatures = np.zeros((len(stencils), corners, 2, corners, 2))  # d2J/dx2, which is constant
        curvatures[:, :, 0, :, 1] = turned
        curvatures[:, :, 1, :, 0] = -turned
        self._curvatures = curvatures.reshape(len(stencils), 2 * corners, 2 * corners)

    def value(self, nodes: Nodes, controls: Vector) -> float:
        state = self._state(nodes)
        if not (state.change > -1.0).all():
            return np.inf
        widened, log = state.widened, np.log1p(state.change) + 0.5 * np.log1p(state.widened)
        stored = 0.5 * self.mu * (widened - np.log1p(widened)) + 0.5 * self.lame * log**2
        return float(self.volumes @ stored)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        state = self._state(nodes)
        factor = self.volumes * state.pressure / (1.0 + state.change)
        return factor[:, None, None] * state.derivatives

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        state = self._state(nodes)
        area, s = 1.0 + state.change, 1.0 + state.widened
        tangent = 2 * s * self.mu * self.lame / (2 * s * self.mu + self.lame)
        flat = state.derivatives.reshape(len(self.stencils), -1)
        steep = self.volumes * (tangent - state.pressure) / area**2
        bend = self.volumes * state.pressure / area
        return steep[:, None, None] * flat[:, :, None] * flat[:, None, :] + bend[:, None, None] * self._curvatures

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        """By mu and lame of each material, and by the thickness."""
        state = self._state(nodes)
        s, log = 1.0 + state.widened, np.log1p(state.change) + 0.5 * np.log1p(state.widened)
        along = self.volumes / (1.0 + state.change) * (state.derivatives * field[self.stencils]).sum(axis=(1, 2))
        share = along / (2 * s * self.mu + self.lame)
        return {
            "mu": np.bincount(self.materials, -state.widened * self.lame * share),
            "lame": np.bincount(self.materials, 2 * s * self.mu * log * share),
            "thickness": np.array([float(along @ state.pressure)]),
        }

    def _state(self, nodes: Nodes) -> "_State":
        moved = (nodes - self._rest)[self.stencils]
        derivatives = np.einsum("tci,tcj->tij", moved - moved[:, :1], self.gradients)
        change = derivatives[:, 0, 0] + derivatives[:, 1, 1] + np.linalg.det(derivatives)
        turned = np.empty_like(derivatives)  # cofactors of F
        turned[:, 0, 0], turned[:, 0, 1] = 1.0 + derivatives[:, 1, 1], -derivatives[:, 1, 0]
        turned[:, 1, 0], turned[:, 1, 1] = -derivatives[:, 0, 1], 1.0 + derivatives[:, 0, 0]
        widened = solve_thickening(change, self.mu, self.lame)
        return _State(change, widened, -self.mu * widened, np.einsum("tij,tcj->tci", turned, self.gradients))


class _State(NamedTuple):
    """State of the points.

    Attributes:
        change: J - 1.
        widened: s^2 - 1.
        pressure: derivative of the energy by ln J [Pa].
        derivatives: dJ/dx [1/m].
    """

    change: Vector
    widened: Vector
    pressure: Vector
    derivatives: Blocks


def solve_thickening(change: Vector, mu: Vector, lame: Vector) -> Vector:
    """Return s^2 - 1 without stress across the plane, at a change of area J - 1; by Newton's method from below."""
    log = np.log1p(np.maximum(change, -1.0 + 1e-12))
    found = np.where(log > 0, np.expm1(-2 * log), 0.0)  # left of the root of a concave function
    most_steps = 60
    for _ in range(most_steps):
        step = (mu * found + lame * (log + 0.5 * np.log1p(found))) / (mu + 0.5 * lame / (1.0 + found))
        found = found - step
        if (np.abs(step) <= 1e-15 * (1.0 + np.abs(found))).all():
            break
    return found
