"""Equilibria to within an accuracy. Oracle: the same poses solved to rounding."""

from itertools import pairwise

import numpy as np
import pytest

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.robot import gallery_folder


@pytest.fixture(scope="module", params=["starfish", "fish_tail"])
def simulation(request: pytest.FixtureRequest) -> hs.Simulation:
    return hs.Simulation(hs.load_robot(gallery_folder(request.param)))


def walk(simulation: hs.Simulation, step: float) -> np.ndarray:
    """Contractions [m] that wander by steps of this share of the travel."""
    travel = np.array([winch.travel for winch in simulation.robot.winches])
    random = np.random.default_rng(3)
    steps = step * random.standard_normal((12, len(travel)))
    return travel * np.abs(0.2 + np.cumsum(steps, axis=0)).clip(0, 0.4)


@pytest.mark.parametrize("step", [0.003, 0.05])
@pytest.mark.parametrize("accuracy", [1e-4, 1e-6])
def test_nodes_are_within_the_accuracy(simulation: hs.Simulation, step: float, accuracy: float) -> None:
    """From the pose before, as a stream is solved; the error that is told is the one there is."""
    pose = None
    for contractions in walk(simulation, step):
        pose = simulation.solve(contractions, start=pose, accuracy=accuracy)
        exact = simulation.solve(contractions, start=pose)
        off = np.linalg.norm(pose.nodes - exact.nodes, axis=1).max()
        assert pose.result.converged
        assert exact.result.error == 0.0
        assert pose.result.error <= accuracy
        assert off <= accuracy
        assert off <= pose.result.error + 1e-9


def test_a_looser_accuracy_takes_fewer_steps(simulation: hs.Simulation) -> None:
    spent = []
    for accuracy in (None, 1e-6, 1e-3):
        poses = [simulation.solve(goal, accuracy=accuracy) for goal in walk(simulation, 0.05)]
        spent.append(sum(pose.result.iterations for pose in poses))
    assert all(less < more for more, less in pairwise(spent))


def test_an_accuracy_is_a_length(simulation: hs.Simulation) -> None:
    with pytest.raises(InputError, match="accuracy must be above 0 m"):
        simulation.solve({}, accuracy=0.0)


def test_what_is_told_where_it_is_not_reached(simulation: hs.Simulation) -> None:
    """Infinite with an accuracy, 0 without."""
    hasty = hs.Simulation(simulation.robot, options=hs.NewtonOptions(iterations=1), body=simulation.body)
    goal = walk(simulation, 0.05)[-1]
    assert hasty.solve(goal, strict=False, accuracy=1e-9).result.error == np.inf
    assert hasty.solve(goal, strict=False).result.error == 0.0
