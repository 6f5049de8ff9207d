"""Inverse kinematics of cables on steps of one shaft. Oracles: differences, brute force, poses that are known."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.ik import Effort, IKOptions, Limits, MarkerTarget, solve_ik
from hydrostat.ik.limits import bounds
from hydrostat.ik.objectives.effort import EffortKind
from hydrostat.ik.objectives.objective import EquilibriumState, StateJacobian, posture_of
from hydrostat.ik.search.inverse_search import InverseSearch
from hydrostat.ik.search.linear_model import channels, stack_jacobians
from hydrostat.ik.search.problem import InverseProblem, _full_tension
from hydrostat.robot import Cable, Robot, Winch
from hydrostat.simulation import Simulation
from hydrostat.testing import check_objective

RATIOS = (2.0, 0.8, 1.5)
SLACK = (0.0015, 0.001, 0.0)


def stepped() -> Robot:
    """A strip with two cables on one shaft, above and below, of which the upper one is taut first; another below."""
    robot = strip_robot(columns=8, rows=2)
    upper, lower = robot.cables
    winches = [Winch(name=name, at=lower.points[0], spool_radius=0.02, travel=0.03) for name in ("both", "third")]
    third = tuple((x, 0.5 * y) for x, y in lower.points[2:5])
    third = Cable(winch="third", points=(lower.points[0], *third))
    cables = [
        replace(cable, winch=winch, spool_radius=0.02 * ratio, slack=slack)
        for cable, winch, ratio, slack in zip(
            (upper, lower, third), ("both", "both", "third"), RATIOS, SLACK, strict=True
        )
    ]
    return robot.with_network(winches, cables)


PULLED = np.array([0.015, 0.007])


@pytest.mark.parametrize("kind", EffortKind)
def test_slopes_of_effort(kind: EffortKind) -> None:
    """Oracle: central differences, in `check_objective`; both cables of the shaft taut, then none."""
    simulation = Simulation(stepped())
    assert simulation.solve(PULLED).tensions.min() > 0.1
    check_objective(Effort(of=kind), simulation, PULLED)
    check_objective(Effort(of=kind), simulation, np.array([0.0003, 0.008]))


def test_slopes_of_markers() -> None:
    check_objective(MarkerTarget(targets={"tip": (0.18, 0.03)}), Simulation(stepped()), PULLED)


def test_a_model_has_the_slopes_of_the_pose() -> None:
    simulation = Simulation(stepped())
    pose = simulation.solve(PULLED)
    expected = StateJacobian.at(simulation, pose)
    found = stack_jacobians(
        simulation, EquilibriumState.at(simulation, pose), simulation.stiffness(pose), np.array([0, 2])
    )
    for part in ("nodes", "elongations", "tensions"):
        want = getattr(expected, part)
        assert np.abs(getattr(found, part) - want).max() < 1e-6 * np.abs(want).max()


@pytest.mark.parametrize("contraction", [0.0, 0.0004, -0.01])
def test_a_slack_shaft_joins_where_its_first_cable_is_taut(contraction: float) -> None:
    """Oracle: bisection of the contraction at which a cable of the shaft is taut on nodes that stay."""
    simulation, values = Simulation(stepped()), np.array([contraction, 0.005])
    nodes = simulation.solve(values).nodes
    places = channels(simulation.cables, posture_of(simulation, nodes, values), values, bounds(simulation, Limits()))
    low, high = contraction, 0.05
    for _ in range(60):
        middle = 0.5 * (low + high)
        taut = simulation.cables.elongations(nodes, np.array([middle, 0.005]))[:2] > 0
        low, high = (low, middle) if taut.any() else (middle, high)
    taut = simulation.cables.elongations(nodes, np.array([high + 1e-12, 0.005]))[:2] > 0
    assert places.gaps[0] == pytest.approx(high - contraction, abs=1e-12)
    assert places.gaps[1] == 0
    assert taut.tolist() == [True, False]
    assert places.first[0] == 0


def test_what_a_shaft_lets_out_to_be_slack() -> None:
    """Oracle: the elongations after its tension fell to 0 to first order and it let out that much further."""
    simulation = Simulation(stepped())
    values = np.array([0.005, 0.0])
    nodes = simulation.solve(values).nodes
    posture = posture_of(simulation, nodes, values)
    places = channels(simulation.cables, posture, values, bounds(simulation, Limits()))
    first = places.first[0]
    fall = posture.tensions[first] / simulation.cables.law.tangent(posture.elongations)[first]
    fallen = fall / RATIOS[first]
    after = simulation.cables.elongations(nodes, values - np.array([fallen + places.beyond[0], 0.0]))[first]
    assert after == pytest.approx(-0.01 * simulation.cables.law.smoothing[first], abs=1e-12)


def test_a_shaft_that_hardly_pulls_is_let_go() -> None:
    """Oracle: its first cable is slack by what a plain winch would leave, however small its spool."""
    robot = stepped()
    robot = robot.with_network(robot.winches, [replace(cable, spool_radius=0.005) for cable in robot.cables])
    simulation = Simulation(robot)
    pose = simulation.solve(np.array([0.01665, 0.028]))
    goal = MarkerTarget(targets={"tip": tuple(pose.markers["tip"])}).bind(simulation)
    options = IKOptions(tolerance=1e-3)
    search = InverseSearch(InverseProblem(simulation, [goal], bounds(simulation, Limits()), options))
    state = search.begin(pose)
    assert 0 < state.posture.tensions[0] < 1e-3 * state.posture.tensions[2]
    tidied = search.drop_slack(state)
    assert tidied.posture.elongations[:2].max() <= 0
    assert tidied.values[0] == pytest.approx(0.0)


def test_weights_count_what_cables_take_in() -> None:
    """Oracle: the same cables on winches of their own that travel in proportion."""
    robot = stepped()
    winches = [
        Winch(name=str(number), at=cable.points[0], travel=ratio * 0.03)
        for number, (cable, ratio) in enumerate(zip(robot.cables, RATIOS, strict=True))
    ]
    cables = [replace(cable, winch=str(number), spool_radius=None) for number, cable in enumerate(robot.cables)]
    shared, apart = Simulation(robot), Simulation(robot.with_network(winches, cables))
    assert _full_tension(shared) == pytest.approx(_full_tension(apart), rel=1e-9)
    slack = EquilibriumState.at(shared, shared.solve(np.array([0.0, 0.005])))
    found, expected = (Effort(of="slack").bind(simulation).residual(slack) for simulation in (shared, apart))
    assert found == pytest.approx(expected, rel=1e-12)
    assert (found != 0).sum() == 2


@pytest.mark.parametrize("wanted", [(0.006, 0.008), (0.009, 0.0), (0.0, 0.01)])
def test_contractions_are_found_again(wanted: tuple[float, float]) -> None:
    """Oracle: the contractions that made the pose; from rest, where all cables of the shaft are slack."""
    robot = stepped()
    simulation = Simulation(robot)
    pose = simulation.solve(np.array(wanted))
    found = solve_ik(simulation, {"tip": tuple(pose.markers["tip"])})
    assert found.errors["tip"] < 1e-4 * robot.body.mesh.size
    assert found.pose.contractions == pytest.approx(wanted, abs=2e-4)
