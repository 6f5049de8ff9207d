"""Slopes where cables rub. Oracle: central differences of whole loading paths from rest, along which cable slips on."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.robot import Cable, Robot
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.simulation.cable_sensitivities import cable_sensitivities

WAVY = (0.005, 0.018, 0.008, 0.016, 0.004, 0.012)
PULL = np.array([0.02, 0.0])
DRAW = np.random.default_rng(3)


def rubbing(sheathed: tuple[tuple[int, int], ...] = ()) -> Robot:
    robot = strip_robot(sheathed=sheathed)
    first, *others = robot.cables
    waves = tuple((x + 0.0007, y) for (x, _), y in zip(first.points[1:], WAVY, strict=True))
    start = (first.points[0][0] + 0.0007, first.points[0][1])  # off the border of two elements
    cables = [replace(first, points=(start, *waves), friction=0.3, slack=0.002), *others]
    return robot.with_network(robot.winches, cables)


def change(robot: Robot, **changes: object) -> Robot:
    cable: Cable = replace(robot.cables[0], **changes)  # pyright: ignore[reportArgumentType]
    return robot.with_network(robot.winches, [cable, *robot.cables[1:]])


def moved(robot: Robot, point: int, axis: int, step: float) -> Robot:
    places = np.array(robot.cables[0].points)
    places[point, axis] += step
    return change(robot, points=tuple(map(tuple, places.tolist())))


@pytest.mark.parametrize("sheathed", [(), ((1, 3),)])
def test_they_are_differences_of_whole_ways(sheathed: tuple[tuple[int, int], ...]) -> None:
    robot = rubbing(sheathed)
    simulation = Simulation(robot)
    pose = simulation.solve(PULL)
    by_nodes = DRAW.standard_normal(pose.nodes.shape)
    by_tensions = 0.01 * DRAW.standard_normal(len(pose.tensions))
    found = simulation.adjoint(pose, by_nodes, tensions=by_tensions)

    def number(end: Equilibrium) -> float:
        return float((by_nodes * end.nodes).sum() + by_tensions @ end.tensions)

    def slope(changed: Callable[[float], Robot], step: float) -> float:
        up, down = (number(Simulation(changed(sign * step)).solve(PULL)) for sign in (1.0, -1.0))
        return (up - down) / (2 * step)

    def harder(share: float) -> Robot:
        material = replace(robot.body.material, young=robot.body.material.young * (1 + share))
        return replace(robot, body=replace(robot.body, material=material))

    cable, young = robot.cables[0], robot.body.material.young
    up, down = (number(simulation.solve(PULL + np.array([step, 0.0]))) for step in (1e-6, -1e-6))
    assert found.contractions[0] == pytest.approx((up - down) / 2e-6, rel=1e-4)
    assert found.slack[0] == pytest.approx(slope(lambda s: change(robot, slack=cable.slack + s), 1e-6), rel=1e-4)
    by_mu = slope(lambda s: change(robot, friction=cable.friction + s), 1e-4)
    assert found.friction[0] == pytest.approx(by_mu, rel=1e-4)
    stiffer = slope(lambda s: change(robot, stiffness=cable.stiffness * (1 + s)), 1e-4)
    assert found.cable_stiffness[0] == pytest.approx(stiffer / cable.stiffness, rel=1e-4)
    assert found.young == pytest.approx(slope(harder, 1e-4) / young, rel=1e-4)
    largest = np.abs(found.routes[0]).max()
    for point, axis in np.ndindex(*found.routes[0].shape):
        by_place = slope(partial(moved, robot, point, axis), 1e-6)
        assert found.routes[0][point, axis] == pytest.approx(by_place, abs=1e-4 * largest)


def test_rig_slopes_are_the_adjoint_of_each_row() -> None:
    simulation = Simulation(rubbing())
    pose = simulation.solve(PULL)
    slopes = cable_sensitivities(simulation, pose, [0])
    anchors, nodes = simulation.marker_anchors, np.zeros_like(pose.nodes)
    nodes[anchors.stencils[0], 0] = anchors.weights[0]
    found = simulation.adjoint(pose, nodes)
    assert slopes.contractions[0] == pytest.approx(found.contractions, rel=1e-9, abs=1e-12)
    assert slopes.points[0] == pytest.approx(np.concatenate(found.routes), rel=1e-9, abs=1e-12)
    moves = simulation.jacobian(pose)
    assert slopes.contractions[0] == pytest.approx((nodes[:, :, None] * moves).sum(axis=(0, 1)), rel=1e-8)
