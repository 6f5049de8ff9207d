"""`Bordered`: equilibrium with one more unknown and equation, the corrector of pseudo-arclength continuation."""

from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics import FactorizedHessian
from hydrostat.simulation.simulation import Simulation


@dataclass(frozen=True, eq=False)
class Tangent:
    """Direction of a branch, of length 1 in the measure of `Bordered`.

    Attributes:
        move: displacement of the nodes [m], (nodes x dim,).
        rate: change of the share of the way.
    """

    move: Vector
    rate: float


@dataclass(frozen=True, eq=False)
class PathPoint:
    """Equilibrium on a branch.

    Attributes:
        nodes: node positions [m].
        share: share of the way from the first contractions to the goal.
        stiffness: factorized Hessian.
        tangent: direction of the branch.
        residual: largest component of a nodal force [N].
        allowed: residual [N] at which it counts as converged.
        distance: largest distance of a node from its predicted position, as a share of the body's size, or the error of
            the share.
        iterations: number of Newton iterations.
    """

    nodes: Nodes
    share: float
    stiffness: FactorizedHessian
    tangent: Tangent
    residual: float
    allowed: float
    distance: float
    iterations: int

    def reverse_direction(self) -> "PathPoint":
        """Return the same point with the branch direction reversed."""
        return replace(self, tangent=Tangent(-self.tangent.move, -self.tangent.rate))


class Bordered:
    """Newton on g(x, r) = dE/dx = 0 together with t . (x - x0, r - r0) = 0, a plane across the branch.

    r is the share of the way, a(r) = a0 + r (a1 - a0). With g_r = d2E/dx da (a1 - a0) a step solves

        [ H      g_r ] [dx]     [g]
        [ w t_x  t_r ] [dr] = - [N]

    by two solutions with H, H z = g and H y = g_r: dr = -(N - w t_x z) / (t_r - w t_x y), dx = -z - y dr. The bordered
    matrix is regular at a fold, where H is not (Keller 1977). Lengths are measured by |dx|^2 w + dr^2, with
    w = 1 / (nodes x size^2).
    """

    def __init__(self, simulation: Simulation, begin: Vector, goal: Vector) -> None:
        """Take the physics of a robot and the contractions at both ends of the way, `begin` and `goal` [m]."""
        mesh = simulation.robot.body.mesh
        self._simulation, self._begin, self._way = simulation, begin, goal - begin
        self._size = mesh.size
        self._weight = 1.0 / (len(mesh.nodes) * mesh.size**2)

    def controls(self, share: float) -> Vector:
        """Contractions at a share of the way [m]."""
        return self._begin + share * self._way

    def bend(self, nodes: Nodes, step: Vector) -> Nodes:
        """Return the nodes after a step along arcs."""
        return self._simulation.body.warp(nodes, step.reshape(nodes.shape))

    def dot(self, one: Tangent, other: Tangent) -> float:
        """Cosine of the angle between two directions."""
        return float(self._weight * (one.move @ other.move) + one.rate * other.rate)

    def length(self, move: np.ndarray, rate: float) -> float:
        """Length of a step."""
        return float(np.sqrt(self._weight * np.square(move).sum() + rate**2))

    def farthest(self, move: Nodes, rate: float) -> float:
        """Largest displacement of a node relative to the body's size, or the change of the share if larger."""
        return max(float(np.linalg.norm(move, axis=1).max()) / self._size, abs(rate))

    def correct(
        self,
        nodes: Nodes,
        share: float,
        across: Tangent,
        *,
        reach: float = np.inf,
        iterations: int = 20,
        before: Tangent | None = None,
    ) -> PathPoint | None:
        """Equilibrium in the plane through a place, across a direction; None if it is not within reach.

        Args:
            nodes: positions to begin at [m].
            share: share of the way to begin at.
            across: the direction; with one that moves no node the share is kept.
            reach: largest distance from the start (see `farthest`).
            iterations: most steps of Newton.
            before: direction that the new one shall continue; `across` if left out.
        """
        first_nodes, first_share = nodes, share
        for iteration in range(iterations + 1):
            controls, assembly = self.controls(share), self._simulation.assembly.with_active_terms(nodes)
            if not np.isfinite(assembly.value(nodes, controls)):
                return None
            gradient = assembly.gradient(nodes, controls)
            stiffness = assembly.stiffness(nodes, controls)
            if stiffness.singular:
                return None
            pulled = assembly.control_derivative(nodes, controls) @ self._way
            back, ahead = stiffness.solve(np.column_stack([gradient, pulled])).T
            arrived = float(np.abs(gradient).max()) <= self._simulation.solver.force_tolerance(nodes, controls)
            missing = self._weight * (across.move @ (nodes - first_nodes).ravel()) + across.rate * (share - first_share)
            slope = across.rate - self._weight * (across.move @ ahead)
            change = -(missing - self._weight * (across.move @ back)) / slope
            step = -back - change * ahead
            if not self.farthest(step.reshape(nodes.shape), change) <= 2 * reach:
                return None
            bent = self.bend(nodes, step)
            if assembly.largest_step(nodes, bent - nodes) < 1.0:  # parts of the body, or an obstacle, are in the way
                return None
            nodes, share = bent, share + change
            distance = self.farthest(nodes - first_nodes, share - first_share)
            if not distance <= reach:
                return None
            if arrived:  # the last step is free: near a fold it still moves the nodes
                tangent = self._tangent(ahead, before or across)
                return self._place(nodes, share, stiffness, tangent, distance, iteration)
        return None

    def _place(
        self,
        nodes: Nodes,
        share: float,
        stiffness: FactorizedHessian,
        tangent: Tangent,
        distance: float,
        iterations: int,
    ) -> PathPoint | None:
        """Equilibrium with its forces; None if there is none."""
        controls = self.controls(share)
        allowed = self._simulation.solver.force_tolerance(nodes, controls)
        residual = float(np.abs(self._simulation.forces(nodes, controls)).max())
        if not residual <= allowed:
            return None
        return PathPoint(nodes, share, stiffness, tangent, residual, allowed, distance, iterations)

    def _tangent(self, ahead: Vector, before: Tangent) -> Tangent:
        """Direction of the branch where H y = g_r, on the same side as the one before."""
        size = self.length(ahead, 1.0)
        tangent = Tangent(-ahead / size, 1.0 / size)
        if self.dot(tangent, before) >= 0:
            return tangent
        return Tangent(-tangent.move, -tangent.rate)
