"""`MaxwellBranches`: viscous branches of a material; `ViscousEnergy`: their potential in one time step."""

from typing import ClassVar

import numpy as np

from hydrostat.arrays import Elements, Float, Nodes, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks
from hydrostat.mechanics.neo_hookean import NeoHookean
from hydrostat.mechanics.quadratic_solid import QuadraticSolid

ViscousMetrics = Float[np.ndarray, "branches elements dim dim"]
"""Metric A of each branch in each element, or each point of quadratic ones; where a branch is relaxed it is C^-1."""

Matrices = Float[np.ndarray, "elements dim dim"]


class ViscousEnergy(Energy):
    """c (tr(F A F^T) / 2 - ln J) in every element, with a metric A that is fixed during the step.

    With a root L L^T = A this is a Neo-Hookean solid of F L, without lambda: every element has a rest shape of its own,
    which has crept.
    """

    convex: ClassVar[bool] = False

    def __init__(
        self,
        nodes: Nodes,
        elements: Elements,
        *,
        volumes: Float[np.ndarray, " elements"],
        metrics: Matrices,
        modulus: float,
    ) -> None:
        """Elements of the rest shape `nodes` [m] with their volumes [m^3], positive definite metrics and c [Pa]."""
        corners = nodes[elements]
        dim = nodes.shape[1]
        crept = np.linalg.solve(roots(metrics), np.swapaxes(corners - corners[:, :1], 1, 2))
        apart = np.arange(elements.size).reshape(elements.shape)
        self.stencils = elements
        corners_crept = np.swapaxes(crept, 1, 2).reshape(-1, dim)
        self._solid = NeoHookean(corners_crept, apart, mu=modulus, lame=0.0, volumes=volumes)

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return self._solid.value(self._apart(nodes), controls)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self._solid.gradient(self._apart(nodes), controls)

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self._solid.hessian(self._apart(nodes), controls)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        return self._solid.projected_hessian(self._apart(nodes), controls, share)

    def _apart(self, nodes: Nodes) -> Float[np.ndarray, "apart dim"]:
        """Corners of each element for themselves."""
        corners = nodes[self.stencils]
        return (corners - corners[:, :1]).reshape(-1, nodes.shape[1])


class MaxwellBranches:
    """Maxwell branches (spring and dashpot in series) parallel to an elastic body: a transient network (Linder 2011).

    Each branch stores mu/2 (tr(A C) - dim - ln det(A C)), C = F^T F, in a metric A that follows the body:
    dA/dt = (C^-1 - A) / tau, so its stress is S = mu (A - C^-1), and it loses energy whenever A differs from C^-1. With
    eta = mu tau and tau to 0 there is a bare dashpot: S = eta C^-1 dC/dt C^-1, or as a stress in the deformed shape
    2 eta D / J, that of a Newtonian fluid. None of it changes when the body turns.

    In an implicit step h from A_n the end value of A is linear in C^-1, so that S derives from a potential:
    S = eta / (tau + h) (A_n - C^-1). That of all branches together is one `ViscousEnergy` of their mean metric.
    """

    def __init__(self, nodes: Nodes, body: NeoHookean | QuadraticSolid, *, viscosities: Vector, times: Vector) -> None:
        """Branches of viscosity eta = mu tau [Pa s] and relaxation time tau >= 0 [s] on the rest shape `nodes`."""
        self._nodes, self._body = nodes, body
        self.viscosities, self.times = viscosities, times

    def __len__(self) -> int:
        return len(self.times)

    def relax_fully(self, nodes: Nodes) -> ViscousMetrics:
        """Return the metrics of fully relaxed branches with the body at `nodes`."""
        return np.repeat(self._inverse(nodes)[None], len(self), axis=0)

    def compute_stored_energy(self, metrics: ViscousMetrics, nodes: Nodes) -> float:
        """Elastic energy stored in the springs of all branches [J]."""
        total = 0.0
        gradients = self._body.deformation_gradients(nodes) if self.times.any() else np.zeros(0)
        for metric, viscosity, time in zip(metrics, self.viscosities, self.times, strict=True):
            if time > 0:
                turned = gradients @ metric @ np.swapaxes(gradients, 1, 2)
                excess = np.trace(turned, axis1=1, axis2=2) - metric.shape[-1] - np.log(np.linalg.det(turned))
                total += float(0.5 * viscosity / time * (self._body.volumes @ excess))
        return total

    def sound(self, metrics: ViscousMetrics, last: ViscousMetrics) -> ViscousMetrics:
        """Metrics that are positive definite: the last ones in elements where an extrapolation is not."""
        bad = np.isnan(roots(metrics.reshape(-1, *metrics.shape[2:]))[:, -1, -1]).reshape(metrics.shape[:2])
        return np.where(bad[:, :, None, None], last, metrics) if bad.any() else metrics

    def modulus(self, step: float) -> float:
        """Stiffness of all branches together in an implicit step [s], as a shear modulus [Pa]."""
        return float((self.viscosities / (self.times + step)).sum())

    def energy(self, metrics: ViscousMetrics, step: float) -> ViscousEnergy | QuadraticSolid:
        """Potential of an implicit step [s] from these metrics."""
        weights = self.viscosities / (self.times + step)
        mean, modulus = np.tensordot(weights / weights.sum(), metrics, axes=1), float(weights.sum())
        if isinstance(self._body, QuadraticSolid):
            return self._body.with_metrics(mean, modulus)
        return ViscousEnergy(
            self._nodes, self._body.stencils, volumes=self._body.volumes, metrics=mean, modulus=modulus
        )

    def relax_step(self, metrics: ViscousMetrics, nodes: Nodes, step: float) -> ViscousMetrics:
        """Metrics after an implicit step [s] that ends at `nodes`."""
        if not len(self):
            return metrics
        times = self.times[:, None, None, None]
        return (times * metrics + step * self._inverse(nodes)) / (times + step)

    def _inverse(self, nodes: Nodes) -> Matrices:
        """C^-1 of each element."""
        inverse = np.linalg.inv(self._body.deformation_gradients(nodes))
        return inverse @ np.swapaxes(inverse, 1, 2)


def roots(matrices: Matrices) -> Matrices:
    """L with L L^T = each symmetric matrix (Cholesky); NaN where a matrix is not positive definite."""
    lower = np.zeros_like(matrices)
    dim = matrices.shape[-1]
    # A metric whose pivots fall below this share of its diagonal counts as not positive definite
    least_pivot = 1e-6
    for j in range(dim):
        pivot = matrices[:, j, j] - (lower[:, j, :j] ** 2).sum(axis=1)
        lower[:, j, j] = np.sqrt(np.where(pivot > least_pivot * matrices[:, j, j], pivot, np.nan))
        for i in range(j + 1, dim):
            crossed = matrices[:, i, j] - (lower[:, i, :j] * lower[:, j, :j]).sum(axis=1)
            lower[:, i, j] = crossed / lower[:, j, j]
    return lower
