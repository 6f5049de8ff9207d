"""Slopes by all that cables are made of: against one adjoint for each row, and finite differences."""

from dataclasses import replace

import numpy as np
from builders import strip_robot

from hydrostat.robot import Robot
from hydrostat.simulation import Simulation, cable_sensitivities

CONTRACTIONS = np.array([0.011, 0.004])


def stepped() -> Robot:
    """Two cables of unequal ratio on one winch, one on another."""
    robot = strip_robot(columns=12, rows=3)
    up, down = robot.cables
    points = tuple((x, y - 0.002) for x, y in up.points[1:])
    other = replace(up, name="", points=(up.points[0], *points), spool_radius=0.004, slack=0.001)
    return robot.with_network(robot.winches, (up, other, down))


def values(robot: Robot, contractions: np.ndarray) -> np.ndarray:
    pose = Simulation(robot).solve(contractions)
    return np.concatenate([*(pose.markers[marker.name] for marker in robot.markers), pose.tensions])


def test_rows_are_those_of_single_adjoints() -> None:
    robot = stepped()
    simulation = Simulation(robot)
    pose = simulation.solve(CONTRACTIONS)
    slopes = cable_sensitivities(simulation, pose, [0])
    marker = simulation.marker_anchors
    for row in range(2 + 3):
        nodes, tensions = np.zeros_like(pose.nodes), np.zeros(3)
        if row < 2:
            nodes[marker.stencils[0], row] = marker.weights[0]
        else:
            tensions[row - 2] = 1.0
        single = simulation.adjoint(pose, nodes, tensions=tensions)
        np.testing.assert_allclose(slopes.contractions[row], single.contractions, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(slopes.slack[row], single.slack, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(slopes.points[row], np.concatenate(single.routes), rtol=1e-9, atol=1e-9)


def test_ratios_agree_with_finite_differences() -> None:
    robot = stepped()
    simulation = Simulation(robot)
    slopes = cable_sensitivities(simulation, simulation.solve(CONTRACTIONS), [0])
    step = 1e-5
    radius = robot.winches[0].spool_radius
    ends = []
    for sign in (1, -1):
        cables = list(robot.cables)
        cables[1] = replace(cables[1], spool_radius=cables[1].spool_radius + sign * step * radius)  # type: ignore[operator]
        ends.append(values(robot.with_network(robot.winches, cables), CONTRACTIONS))
    found = (ends[0] - ends[1]) / (2 * step)
    np.testing.assert_allclose(slopes.ratios[:, 1], np.concatenate([found[:2], found[-3:]]), rtol=1e-4, atol=1e-6)
