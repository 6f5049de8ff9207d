"""Cables on steps of one shaft. Oracle: the same cables on winches of their own, contracted in proportion."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.robot import Robot, Winch
from hydrostat.simulation import Simulation

RATIOS = np.array([2.0, 0.75])
RADIUS = 0.02
TURN = np.array([0.012])


def apart(friction: float) -> Robot:
    """Two cables, each on a winch of its own."""
    robot = strip_robot()
    return robot.with_network(robot.winches, [replace(cable, friction=friction) for cable in robot.cables])


def together(friction: float) -> Robot:
    """The same two on steps of one shaft."""
    robot = apart(friction)
    cables = [
        replace(cable, winch="both", spool_radius=float(ratio) * RADIUS)
        for cable, ratio in zip(robot.cables, RATIOS, strict=True)
    ]
    return robot.with_network([Winch(name="both", at=robot.winches[1].at, spool_radius=RADIUS)], cables)


@pytest.fixture(params=[0.0, 0.3], ids=["smooth", "rubbing"])
def pair(request: pytest.FixtureRequest) -> tuple[Simulation, Simulation]:
    return Simulation(apart(request.param)), Simulation(together(request.param))


def test_a_step_takes_in_by_its_radius(pair: tuple[Simulation, Simulation]) -> None:
    expected, pose = pair[0].solve(RATIOS * TURN), pair[1].solve(TURN)
    size = pair[0].robot.body.mesh.size
    assert expected.tensions.min() > 0.1
    assert np.abs(expected.nodes - pair[0].robot.body.mesh.nodes).max() > 0.05 * size
    assert np.abs(pose.nodes - expected.nodes).max() < 1e-9 * size
    assert pose.tensions == pytest.approx(expected.tensions, rel=1e-8)
    assert pose.result.iterations == expected.result.iterations
    assert pose.history == pytest.approx(expected.history, abs=1e-9 * size)


def test_slopes_follow_the_chain_rule(pair: tuple[Simulation, Simulation]) -> None:
    expected = pair[0].jacobian(pair[0].solve(RATIOS * TURN)) @ RATIOS
    found = pair[1].jacobian(pair[1].solve(TURN))[..., 0]
    assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max()


def test_a_step_in_time() -> None:
    expected, found = Simulation(apart(0.0)), Simulation(together(0.0))
    one = expected.step(expected.motion_at_rest(), RATIOS * TURN, 0.01)
    two = found.step(found.motion_at_rest(), TURN, 0.01)
    assert np.abs(two.nodes - one.nodes).max() < 1e-9 * expected.robot.body.mesh.size
    assert two.tensions == pytest.approx(one.tensions, rel=1e-8)
