"""`Effort`: penalty on contractions, tensions or slack."""

# Of the thesis (docs/thesis.md): E18

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.closed_set import make_member
from hydrostat.ik.objectives.objective import (
    EquilibriumState,
    Jacobian,
    Objective,
    Residual,
    Rows,
    StateJacobian,
    above_zero,
    full_travels,
    not_negative,
)
from hydrostat.simulation import Simulation


class EffortKind(StrEnum):
    """Quantity that an effort objective keeps small."""

    CONTRACTION = "contraction"
    TENSION = "tension"
    SLACK = "slack"


@dataclass(frozen=True, kw_only=True)
class Effort(Objective):
    """Squared contractions, tensions or slack lengths, against co-contraction and loose cables.

    Attributes:
        of: quantity to minimize.
        weight: marker error, as a fraction of the body's size, that is equivalent to `scale`.
        scale: contraction or slack [m], or tension [N]; None for the contraction of each winch or cable at full travel,
            or 10 N.
    """

    of: EffortKind | str = EffortKind.CONTRACTION
    weight: float = 1e-3
    scale: float | None = None

    def __post_init__(self) -> None:
        make_member(self, "of", EffortKind, what="the kind of an effort")

    def bind(self, simulation: Simulation) -> Residual:
        """Return the residual on this robot (InputError: a weight below 0, or a scale not above 0)."""
        robot = simulation.robot
        travel = full_travels(robot)
        weight = not_negative("weight of an effort", self.weight) * robot.body.mesh.size
        scale = None if self.scale is None else above_zero("scale of an effort", self.scale)
        tension = 10.0  # a pull that winches of small robots bear with ease [N]
        if self.of is EffortKind.TENSION:
            return _Tension(weight / (scale or tension))
        if self.of is EffortKind.SLACK:
            return _Slack(weight / (scale or simulation.cables.compute_contractions(travel)))
        return _Contraction(weight / (scale or travel))


def keeps_taut(objective: Objective) -> bool:
    """Return True if an objective penalizes slack cables."""
    return isinstance(objective, Effort) and objective.of == EffortKind.SLACK


class _Contraction(Residual):
    def __init__(self, scale: float | np.ndarray) -> None:
        self._scale = scale

    def residual(self, posture: EquilibriumState) -> Rows:
        return self._scale * posture.contractions

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        return np.diag(np.broadcast_to(self._scale, posture.contractions.shape))


class _Tension(Residual):
    def __init__(self, scale: float) -> None:
        self._scale = scale

    def residual(self, posture: EquilibriumState) -> Rows:
        return self._scale * posture.tensions

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        return self._scale * moves.tensions


class _Slack(Residual):
    def __init__(self, scale: float | np.ndarray) -> None:
        self._scale = scale

    def residual(self, posture: EquilibriumState) -> Rows:
        return self._scale * np.minimum(posture.elongations, 0.0)

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        scale = np.broadcast_to(self._scale, posture.elongations.shape)
        return np.where(posture.elongations < 0, scale, 0.0)[:, None] * moves.elongations
