"""How far tolerances take markers. Oracles: differences of solved poses, and robots drawn at random."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design.built_error import built_errors, expected_error
from hydrostat.design.spread import friction_column, spread_columns
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.ik import solve_ik
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Simulation, cable_sensitivities

PULLED = np.array([0.012, 0.002])
BENT = ((0.02, 0.012), (0.07, 0.016), (0.12, 0.008), (0.18, 0.014))


def robot() -> Robot:
    made = strip_robot(columns=10, rows=3)
    winch = made.winches[0]
    cables = (replace(made.cables[0], points=(winch.at, *BENT[1:])), *made.cables[1:])
    return made.with_network(made.winches, cables)


def tip(changed: Robot) -> np.ndarray:
    return Simulation(changed).solve(PULLED).markers["tip"]


def slope(change: Callable[[float], Robot], step: float) -> np.ndarray:
    return (tip(change(step)) - tip(change(-step))) / (2 * step)


def columns(uncertainty: BuildTolerances) -> np.ndarray:
    simulation = Simulation(robot())
    pose = simulation.solve(PULLED)
    return spread_columns(simulation, pose, cable_sensitivities(simulation, pose, [0]), uncertainty, 2)


def test_columns_are_those_of_differences(unchecked: None) -> None:
    made, dim = robot(), 2
    some = BuildTolerances(friction=(0.0, 0.0))
    found = columns(some)
    holes = dim * (len(made.winches) + sum(len(cable.points) - 1 for cable in made.cables))

    def with_hole(step: float) -> Robot:
        points = [list(point) for point in made.cables[0].points]
        points[1][1] += step
        cable = replace(made.cables[0], points=tuple(map(tuple, points)))
        return made.with_network(made.winches, (cable, *made.cables[1:]))

    def with_spool(step: float) -> Robot:
        cable = replace(made.cables[0], spool_radius=(1 + step) * made.winches[0].spool_radius)
        return made.with_network(made.winches, (cable, *made.cables[1:]))

    def with_stiffness(step: float) -> Robot:
        cable = replace(made.cables[0], stiffness=(1 + step) * made.cables[0].stiffness)
        return made.with_network(made.winches, (cable, *made.cables[1:]))

    hole = dim * len(made.winches) + 1
    spool = holes + len(made.cables)
    stiff = spool + len(made.winches)
    assert found[:, hole] == pytest.approx(some.sewing * slope(with_hole, 1e-6), rel=1e-3, abs=1e-8)
    assert found[:, spool] == pytest.approx(some.spool * slope(with_spool, 1e-5), rel=1e-3, abs=1e-8)
    assert found[:, stiff] == pytest.approx(some.stiffness * slope(with_stiffness, 1e-4), rel=1e-2, abs=1e-8)


def test_the_column_of_friction_is_that_of_a_little_friction(unchecked: None) -> None:
    """Oracle: the path from rest with mu = 0.001, all cable slipping towards its winch."""
    made = robot()
    simulation = Simulation(made)
    pose = simulation.solve(PULLED)
    column = friction_column(simulation, pose, cable_sensitivities(simulation, pose, [0]).fields[:2])
    rough = made.with_network(made.winches, [replace(cable, friction=1e-3) for cable in made.cables])
    assert column == pytest.approx((tip(rough) - pose.markers["tip"]) / 1e-3, rel=0.02)


def test_the_expected_error_is_that_of_many_draws(unchecked: None) -> None:
    """Oracle: 60 robots, solved; their mean square is known to a fifth, and to first order it is what is expected."""
    made, pose = robot(), PoseTarget(name="up", targets={"tip": (0.185, 0.035)})
    small = BuildTolerances(sewing=5e-4, friction=(0.0, 0.1))
    simulation = Simulation(made)
    reached = [solve_ik(simulation, pose)]
    expected = expected_error(simulation, reached, small)
    drawn = built_errors(made, [pose], [reached[0].pose.contractions], small, draws=60).drawn
    assert float(np.sqrt(np.mean(drawn**2))) == pytest.approx(expected, rel=0.2)
    assert expected > 1.05 * reached[0].rms_error
