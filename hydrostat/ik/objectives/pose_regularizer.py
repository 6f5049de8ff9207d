"""`PoseRegularizer`: near a pose that was there before."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.closed_set import make_member
from hydrostat.errors import InputError
from hydrostat.geometry import Anchors
from hydrostat.ik.objectives.objective import (
    EquilibriumState,
    Jacobian,
    Objective,
    Residual,
    Rows,
    StateJacobian,
    describe,
    not_negative,
)
from hydrostat.simulation import Equilibrium, Simulation


class ClosenessKind(StrEnum):
    """Quantity that a pose regularizer keeps near its previous value."""

    NODES = "nodes"
    MARKERS = "markers"
    CONTRACTIONS = "contractions"


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseRegularizer(Objective):
    """Penalty on the distance from a reference pose, for smooth motion.

    Attributes:
        pose: reference pose.
        of: quantity to keep: the whole body (root mean square over its nodes), markers, or contractions; the range of a
            drive counts as the size of the body.
        weight: weight of this distance relative to a marker's error.
        markers: names of the markers to keep; None for all.
    """

    pose: Equilibrium
    of: ClosenessKind | str = ClosenessKind.CONTRACTIONS
    weight: float = 1e-2
    markers: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        make_member(self, "of", ClosenessKind, what="the kind of a closeness")

    def bind(self, simulation: Simulation) -> Residual:
        """Return the residual on this robot (InputError: no solved pose, one of another robot, or a weight below 0)."""
        weight = not_negative("weight of a closeness", self.weight)
        if not isinstance(self.pose, Equilibrium):
            hint = ", give its .pose" if isinstance(getattr(self.pose, "pose", None), Equilibrium) else ""
            raise InputError(f"the pose to stay close to must be an Equilibrium, not {describe(self.pose)}{hint}")
        mesh, winches = simulation.robot.body.mesh, simulation.robot.winches
        if self.pose.nodes.shape != mesh.nodes.shape or len(self.pose.contractions) != len(winches):
            raise InputError("the pose to stay close to is one of another robot")
        if self.of is ClosenessKind.NODES:
            return _Nodes(weight / np.sqrt(len(mesh.nodes)), self.pose.nodes)
        if self.of is ClosenessKind.MARKERS:
            names = [marker.name for marker in simulation.robot.markers]
            unknown = sorted(set(self.markers or ()) - set(names))
            if unknown:
                raise InputError(f"a closeness names {unknown[0]!r:.60}, which is no marker of the robot")
            which = np.array(
                [index for index, name in enumerate(names) if self.markers is None or name in self.markers]
            )
            return _Markers(weight, simulation.marker_anchors, which.astype(int), self.pose.nodes)
        spans = [high - low for low, high in (drive.limits for drive in simulation.robot.drives)]
        weights = weight * np.array([1.0] * len(winches) + [mesh.size / (span or 1.0) for span in spans])
        return _Contractions(weights, self.pose.controls)


class _Nodes(Residual):
    def __init__(self, weight: float, nodes: Nodes) -> None:
        self._weight, self._nodes = weight, nodes

    def residual(self, posture: EquilibriumState) -> Rows:
        return self._weight * (posture.nodes - self._nodes).ravel()

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        return self._weight * moves.nodes.reshape(posture.nodes.size, -1)


class _Markers(Residual):
    def __init__(self, weight: float, anchors: Anchors, which: np.ndarray, nodes: Nodes) -> None:
        self._weight, self._anchors, self._which = weight, anchors, which
        self._places = anchors.positions(nodes)[which]

    def residual(self, posture: EquilibriumState) -> Rows:
        return self._weight * (self._anchors.positions(posture.nodes)[self._which] - self._places).ravel()

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        stencils, weights = self._anchors.stencils[self._which], self._anchors.weights[self._which]
        moved = np.einsum("mk,mkdc->mdc", weights, moves.nodes[stencils])
        return self._weight * moved.reshape(-1, moved.shape[2])


class _Contractions(Residual):
    def __init__(self, weights: Vector, contractions: Vector) -> None:
        self._weights, self._contractions = weights, contractions

    def residual(self, posture: EquilibriumState) -> Rows:
        return self._weights * (posture.contractions - self._contractions)

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        return np.diag(self._weights)
