"""The conformance suite of objectives can fail. Oracle: a good one, broken on purpose."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest
from wishes import BENT, FLAT, PLANE

from hydrostat.ik.objectives.marker_goal import MarkerGoal
from hydrostat.ik.objectives.objective import Moves, Objective, Posture, Rows, Slopes, Term
from hydrostat.simulation import Simulation
from hydrostat.testing import ConformanceError, check_objective


@dataclass(frozen=True)
class Broken(Objective):
    """A good objective, broken on purpose."""

    change: Callable[[Term], Term]

    def on(self, simulation: Simulation) -> Term:
        return self.change(PLANE["outline"].on(simulation))


class Wrapped(Term):
    def __init__(self, term: Term) -> None:
        self.term, self.asked = term, 0

    def residual(self, posture: Posture) -> Rows:
        return self.term.residual(posture)

    def slopes(self, posture: Posture, moves: Moves) -> Slopes:
        return self.term.slopes(posture, moves)

    def errors(self, posture: Posture) -> Mapping[str, float]:
        return self.term.errors(posture)


class SlopeOff(Wrapped):
    """One entry of its largest row is 0.01 % too large."""

    def slopes(self, posture: Posture, moves: Moves) -> Slopes:
        slopes = super().slopes(posture, moves).copy()
        slopes[np.abs(slopes[:, 0]).argmax(), 0] *= 1.0001
        return slopes


class SlopesOfNodesAlone(Wrapped):
    """As if the places of the shape were not pulled at by the body."""

    def slopes(self, posture: Posture, moves: Moves) -> Slopes:
        slopes = super().slopes(posture, moves).copy()
        slopes[-100:] = 0.0
        return slopes


class SlopesTurned(Wrapped):
    def slopes(self, posture: Posture, moves: Moves) -> Slopes:
        return super().slopes(posture, moves).T


class RowsThatComeAndGo(Wrapped):
    def residual(self, posture: Posture) -> Rows:
        residual = super().residual(posture)
        return residual[: len(residual) - int(posture.contractions[0] > 0.025)]


class RowsInATable(Wrapped):
    def residual(self, posture: Posture) -> np.ndarray:
        return super().residual(posture)[:, None]


class ResidualNaN(Wrapped):
    def residual(self, posture: Posture) -> Rows:
        return np.where(np.arange(len(super().residual(posture))) == 3, np.nan, 1.0)


class NegativeError(Wrapped):
    def errors(self, posture: Posture) -> Mapping[str, float]:
        return {"outline": -1e-9}


class ErrorOfNothing(Wrapped):
    def residual(self, posture: Posture) -> Rows:
        return np.zeros(3)

    def slopes(self, posture: Posture, moves: Moves) -> Slopes:
        return np.zeros((3, 2))


class Forgetful(Wrapped):
    """Counts how often it was asked."""

    def residual(self, posture: Posture) -> Rows:
        self.asked += 1
        return super().residual(posture) + 1e-9 * self.asked


SLIPS = {
    SlopeOff: "slopes at",
    SlopesOfNodesAlone: "slopes at",
    SlopesTurned: "slopes: they have the shape",
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
    goal = MarkerGoal(targets={"tip": (0.2, 0.1)})
    check_objective(goal, rough, BENT[2], postures=1)
    with pytest.raises(ConformanceError, match="slopes at"):
        check_objective(Broken(lambda _: SlopeOff(goal.on(rough))), rough, BENT[2], postures=1)
