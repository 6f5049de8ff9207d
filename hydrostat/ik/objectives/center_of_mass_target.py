"""`CenterOfMassTarget`: the center of mass at a point."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.given import Point
from hydrostat.ik.objectives.objective import (
    EquilibriumState,
    Jacobian,
    Objective,
    Residual,
    Rows,
    StateJacobian,
    not_negative,
    place,
)
from hydrostat.simulation import Simulation


@dataclass(frozen=True, kw_only=True)
class CenterOfMassTarget(Objective):
    """Target for the body's center of mass, for example for balance.

    Attributes:
        target: target position [m].
        weight: weight of this error relative to a marker's error.
    """

    target: Point
    weight: float = 1.0

    def bind(self, simulation: Simulation) -> Residual:
        """Return the residual on this robot.

        Raises:
            InputError: a target outside the body's space, not finite or not in meters, or a weight below 0.
        """
        target = place("target of the center of mass", self.target, simulation.robot.body.mesh)
        weight = not_negative("weight of the center of mass", self.weight)
        masses = simulation.body.masses
        return _Center(weight, masses / masses.sum(), target)


class _Center(Residual):
    def __init__(self, weight: float, shares: Vector, target: Vector) -> None:
        self._weight, self._shares, self._target = weight, shares, target

    def residual(self, posture: EquilibriumState) -> Rows:
        return self._weight * (self._shares @ posture.nodes - self._target)

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        return self._weight * np.einsum("n,ndw->dw", self._shares, moves.nodes)

    def errors(self, posture: EquilibriumState) -> Mapping[str, float]:
        distance = float(np.linalg.norm(self._shares @ posture.nodes - self._target))
        return {"center of mass": distance} if self._weight > 0 else {}
