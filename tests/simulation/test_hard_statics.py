"""Statics far outside the gallery, and how it ends where it does not arrive. Oracle: residual and J judged afresh."""

from dataclasses import replace

import attack  # pyright: ignore[reportMissingImports]
import numpy as np
import pytest
from builders import strip_robot

from hydrostat.errors import InputError, NotConvergedError
from hydrostat.mechanics import NewtonOptions, NewtonStatus
from hydrostat.robot import Cable
from hydrostat.simulation import Simulation


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize(
    ("number", "command"),
    [
        (2, 0),  # a pig, Poisson's ratio 0.49 by patches, within travel
        (19, 6),  # cables a hundred times as stiff as the body, pulled in by 89 %
        (29, 8),  # and thousands of times, by 94 %: arcs would turn elements over at any length of a step
    ],
)
def test_what_once_ended_at_the_iteration_limit_converges(number: int, command: int) -> None:
    robot, _ = attack.random_robot(number, 0)
    contractions = list(attack.commands(robot, number, 0))[command][1]
    simulation = Simulation(robot)
    pose = simulation.solve(contractions)
    assert attack.fault(simulation, pose) == ""
    assert pose.result.iterations < 150


def test_the_judge_of_random_robots_can_find_fault() -> None:
    simulation = Simulation(strip_robot())
    pose = simulation.solve(np.array([0.01, 0.0]))
    assert attack.fault(simulation, pose) == ""
    moved, mirrored = pose.nodes.copy(), pose.nodes * [1.0, -1.0]
    moved[-1] += 1e-6
    assert "residual" in attack.fault(simulation, replace(pose, nodes=moved))
    assert "inverted" in attack.fault(simulation, replace(pose, nodes=mirrored))


def test_a_time_limit_ends_a_solve_and_is_told() -> None:
    simulation = Simulation(strip_robot())
    goal = np.array([0.03, 0.0])
    with pytest.raises(NotConvergedError, match="time limit reached") as caught:
        simulation.solve(goal, seconds=1e-9)
    assert caught.value.result.status is NewtonStatus.TIME_LIMIT  # pyright: ignore[reportAttributeAccessIssue]
    late = simulation.solve(goal, seconds=1e-9, strict=False)
    assert late.result.residual == np.abs(simulation.forces(late.nodes, goal)).max()
    assert (simulation.solve(goal, seconds=60.0).nodes == simulation.solve(goal).nodes).all()


def test_friction_keeps_to_a_time_limit() -> None:
    robot = strip_robot()
    rubbing = replace(robot, cables=tuple(replace(cable, friction=0.3) for cable in robot.cables))
    pose = Simulation(rubbing).solve(np.array([0.03, 0.0]), seconds=1e-9, strict=False)
    assert pose.result.status is NewtonStatus.TIME_LIMIT


@pytest.mark.parametrize(
    ("seed", "share"),
    [
        (5, 0.15),  # corrections of the limits of friction went round in circles
        (23, 0.15),
        (42, 0.3),  # the body snaps on the way
    ],
)
def test_a_stiff_cable_that_rubs_on_a_zigzag_finds_its_balance(seed: int, share: float) -> None:
    """Oracle: the judge of random robots, with slips as they are kept and limits by the capstan law."""
    plain = strip_robot(columns=8, rows=2)
    centers = plain.body.mesh.nodes[plain.body.mesh.elements].mean(axis=1)
    points = np.random.default_rng(seed).choice(centers, size=8, replace=False).tolist()
    cable = Cable(winch="up", points=tuple(map(tuple, points)), stiffness=1e5, friction=0.8)
    simulation = Simulation(plain.with_network([replace(plain.winches[0], at=cable.points[0])], [cable]))
    pose = simulation.solve([share * cable.length])
    assert pose.history.any()
    assert attack.fault(simulation, pose) == ""


def test_limits_of_slack_cables_are_corrected_to_none() -> None:
    """A cable let out keeps limits of when it was taut. Oracle: without tension nothing rubs."""
    plain = strip_robot(columns=8, rows=2)
    robot = plain.with_network(plain.winches, [replace(cable, friction=0.3) for cable in plain.cables])
    simulation, slack = Simulation(robot), np.full(len(robot.winches), -0.01)
    nodes, cables = simulation.rest.nodes, simulation.friction
    assert cables is not None
    held = cables.with_limits(np.ones(len(cables.slips)))
    compliance = simulation.stiffness(simulation.rest).compliance_to(held.span_columns(nodes))
    assert not held.with_corrected_history(nodes, slack, compliance).law.limits.any()


@pytest.mark.parametrize("seconds", [0.0, -1.0, float("nan")])
def test_a_time_limit_that_is_none_is_refused(seconds: float) -> None:
    with pytest.raises(InputError, match="seconds"):
        Simulation(strip_robot()).solve(np.zeros(2), seconds=seconds)


def test_a_failure_names_the_cable_and_the_element_in_the_way() -> None:
    """Oracle: largest tension and least det F of the pose returned, and the share of the cable's length asked for."""
    simulation = Simulation(strip_robot(), options=NewtonOptions(iterations=2))
    goal = np.array([0.0, 0.95 * simulation.cables.rest_lengths[1]])
    with pytest.raises(NotConvergedError) as caught:
        simulation.solve(goal)
    pose = simulation.solve(goal, strict=False)
    volumes = np.linalg.det(simulation.body.elastic.deformation_gradients(pose.nodes))
    assert np.argmax(pose.tensions) == 1
    assert volumes.min() < 0.2
    assert f"highest tension {pose.tensions[1]:.3g} N in cable {simulation.robot.cables[1].name!r}" in str(caught.value)
    assert "contracted by 95 % of its bare length" in str(caught.value)
    assert f"element {np.argmin(volumes)}, at (" in str(caught.value)
