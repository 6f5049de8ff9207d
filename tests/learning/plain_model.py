"""`plain`: a learned model that has learned nothing, for what needs no training."""

import numpy as np
from model_cards import model_card

from hydrostat.learning import LearnedModel
from hydrostat.learning.perceptrons import Perceptrons
from hydrostat.robot import Robot


def plain(robot: Robot) -> LearnedModel:
    """A model that has learned nothing: for what needs no training."""
    draw = np.random.default_rng(0)

    def networks(*sizes: int) -> Perceptrons:
        numbers = draw.normal(size=(2, Perceptrons.count(np.array(sizes)))).astype(np.float32)
        return Perceptrons(sizes=np.array(sizes), numbers=numbers.astype(float))

    return LearnedModel(
        card=model_card(robot),
        low=np.zeros(2),
        high=np.array([winch.travel for winch in robot.winches]),
        middle=np.zeros(4),
        unit=np.ones(4),
        forward=networks(2, 5, 4),
        inverse=networks(2, 5, 2),
        known=np.zeros((3, 2)),
        reached=np.zeros((3, 2)),
    )
