"""`Closeness`: near a pose that was there before."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.closed_set import make_member
from hydrostat.errors import InputError
from hydrostat.ik.objectives.objective import Moves, Objective, Posture, Rows, Slopes, Term, describe, not_negative
from hydrostat.simulation import Simulation, SolvedPose


class ClosenessKind(StrEnum):
    """What should stay as it was."""

    NODES = "nodes"
    CONTRACTIONS = "contractions"


@dataclass(frozen=True, kw_only=True, eq=False)
class Closeness(Objective):
    """A pose like a previous one, so that a motion stays smooth.

    Attributes:
        pose: the previous one.
        of: what should stay: the whole body (root of the mean square over its nodes), or the contractions.
        weight: how much a metre away from it counts beside a metre of a marker's error.
    """

    pose: SolvedPose
    of: ClosenessKind | str = ClosenessKind.CONTRACTIONS
    weight: float = 1e-2

    def __post_init__(self) -> None:
        make_member(self, "of", ClosenessKind, what="the kind of a closeness")

    def on(self, simulation: Simulation) -> Term:
        """The wish on this robot (InputError: no solved pose or one of another robot, or a weight below 0)."""
        weight = not_negative("weight of a closeness", self.weight)
        if not isinstance(self.pose, SolvedPose):
            hint = ", give its .pose" if isinstance(getattr(self.pose, "pose", None), SolvedPose) else ""
            raise InputError(f"the pose to stay close to must be a SolvedPose, not {describe(self.pose)}{hint}")
        mesh, winches = simulation.robot.body.mesh, simulation.robot.winches
        if self.pose.nodes.shape != mesh.nodes.shape or len(self.pose.contractions) != len(winches):
            raise InputError("the pose to stay close to is one of another robot")
        if self.of is ClosenessKind.NODES:
            return _Nodes(weight / np.sqrt(len(mesh.nodes)), self.pose.nodes)
        return _Contractions(weight, self.pose.contractions)


class _Nodes(Term):
    def __init__(self, weight: float, nodes: Nodes) -> None:
        self._weight, self._nodes = weight, nodes

    def residual(self, posture: Posture) -> Rows:
        return self._weight * (posture.nodes - self._nodes).ravel()

    def slopes(self, posture: Posture, moves: Moves) -> Slopes:
        return self._weight * moves.nodes.reshape(posture.nodes.size, -1)


class _Contractions(Term):
    def __init__(self, weight: float, contractions: Vector) -> None:
        self._weight, self._contractions = weight, contractions

    def residual(self, posture: Posture) -> Rows:
        return self._weight * (posture.contractions - self._contractions)

    def slopes(self, posture: Posture, moves: Moves) -> Slopes:
        return self._weight * np.eye(len(posture.contractions))
