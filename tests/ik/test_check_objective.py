"""The conformance suite of objectives can fail. Oracle: a good one, broken on purpose."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest
from wishes import BENT, FLAT, PLANE

from hydrostat.ik.objectives.marker_target import MarkerTarget
from hydrostat.ik.objectives.objective import EquilibriumState, Jacobian, Objective, Residual, Rows, StateJacobian
from hydrostat.simulation import Simulation
from hydrostat.testing import ConformanceError, check_objective


@dataclass(frozen=True)
class Broken(Objective):
    """A good objective, broken on purpose."""

    change: Callable[[Residual], Residual]

    def bind(self, simulation: Simulation) -> Residual:
        return self.change(PLANE["outline"].bind(simulation))


class Wrapped(Residual):
    def __init__(self, term: Residual) -> None:
        self.term, self.asked = term, 0

    def residual(self, posture: EquilibriumState) -> Rows:
        return self.term.residual(posture)

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        return self.term.jacobian(posture, moves)

    def errors(self, posture: EquilibriumState) -> Mapping[str, float]:
        return self.term.errors(posture)


class SlopeOff(Wrapped):
    """One entry of its largest row is 0.01 % too large."""

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        slopes = super().jacobian(posture, moves).copy()
        slopes[np.abs(slopes[:, 0]).argmax(), 0] *= 1.0001
        return slopes


class SlopesOfNodesAlone(Wrapped):
    """As if the places of the shape were not pulled at by the body."""

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        slopes = super().jacobian(posture, moves).copy()
        slopes[-100:] = 0.0
        return slopes


class SlopesTurned(Wrapped):
    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        return super().jacobian(posture, moves).T


class RowsThatComeAndGo(Wrapped):
    def residual(self, posture: EquilibriumState) -> Rows:
        residual = super().residual(posture)
        return residual[: len(residual) - int(posture.contractions[0] > 0.025)]


class RowsInATable(Wrapped):
    def residual(self, posture: EquilibriumState) -> np.ndarray:
        return super().residual(posture)[:, None]


class ResidualNaN(Wrapped):
    def residual(self, posture: EquilibriumState) -> Rows:
        return np.where(np.arange(len(super().residual(posture))) == 3, np.nan, 1.0)


class NegativeError(Wrapped):
    def errors(self, posture: EquilibriumState) -> Mapping[str, float]:
        return {"outline": -1e-9}


class ErrorOfNothing(Wrapped):
    def residual(self, posture: EquilibriumState) -> Rows:
        return np.zeros(3)

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        return np.zeros((3, 2))


class Forgetful(Wrapped):
    """Counts how often it was asked."""

    def residual(self, posture: EquilibriumState) -> Rows:
        self.asked += 1
        return super().residual(posture) + 1e-9 * self.asked


SLIPS = {
    SlopeOff: "jacobian at",
    SlopesOfNodesAlone: "jacobian at",
    SlopesTurned: "jacobian: they have the shape",
    RowsThatComeAndGo: "residual: it has .* rows at one posture",
    RowsInATable: "residual: it has the shape",
    ResidualNaN: r"residual at \[3\]: it is not finite",
    NegativeError: "errors: outline is -1e-09",
    ErrorOfNothing: "errors: outline is .* where the residual is zero",
    Forgetful: "residual: it is another",
}


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize("slip", SLIPS)
def test_the_suite_can_fail(slip: type[Wrapped]) -> None:
    with pytest.raises(ConformanceError, match=SLIPS[slip]):
        check_objective(Broken(slip), FLAT, BENT[2])


@pytest.mark.slow
def test_cables_that_rub_are_taken() -> None:
    """Oracle: differences of whole loading paths, which a slope that is off by 0.01 % does not pass."""
    robot = FLAT.robot
    rough = Simulation(replace(robot, cables=tuple(replace(cable, friction=0.2) for cable in robot.cables)))
    goal = MarkerTarget(targets={"tip": (0.2, 0.1)})
    check_objective(goal, rough, BENT[2], postures=1)
    with pytest.raises(ConformanceError, match="jacobian at"):
        check_objective(Broken(lambda _: SlopeOff(goal.bind(rough))), rough, BENT[2], postures=1)
