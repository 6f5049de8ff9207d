"""`plain`: a learned model that has learned nothing, for what needs no training."""

import numpy as np

from hydrostat.learning import LearnedModel, plan_samples
from hydrostat.learning.perceptrons import Perceptrons
from hydrostat.robot import Robot


def plain(robot: Robot) -> LearnedModel:
    """A model that has learned nothing: for what needs no training."""
    draw = np.random.default_rng(0)

    def networks(*sizes: int) -> Perceptrons:
        numbers = draw.normal(size=(2, Perceptrons.count(np.array(sizes)))).astype(np.float32)
        return Perceptrons(sizes=np.array(sizes), numbers=numbers.astype(float))

    plan = plan_samples(robot, 20)
    return LearnedModel(
        facts=plan.facts() | {"error": 1e-3},
        low=np.zeros(2),
        high=np.array([winch.travel for winch in robot.winches]),
        middle=np.zeros(4),
        unit=np.ones(4),
        forward=networks(2, 5, 4),
        inverse=networks(2, 5, 2),
        known=np.zeros((3, 2)),
        reached=np.zeros((3, 2)),
    )
