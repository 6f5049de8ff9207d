"""Learned shapes. Oracles: the simulator, finite differences."""

import numpy as np
import pytest

from hydrostat.arrays import Nodes
from hydrostat.errors import InputError
from hydrostat.learning import Samples
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.toy import LearnedShape, learn_shape, sample_shapes
from hydrostat.toy.learn_shape import _Training


def test_the_error_that_is_stated_is_that_of_simulated_poses(
    starfish: Robot, samples: Samples, rest: Nodes, shape: LearnedShape
) -> None:
    simulation = Simulation(starfish)
    held_out = samples.contractions[shape.samples :]
    assert len(held_out) == shape.held_out
    distances = [
        np.linalg.norm(shape.nodes(taken) - simulation.solve(taken).nodes, axis=1).mean() for taken in held_out
    ]
    assert np.mean(distances) == pytest.approx(shape.error, rel=1e-3)
    assert shape.error < 0.3 * shape.moved
    assert shape.worst > shape.error
    assert np.abs(shape.nodes(np.zeros(3)) - rest).max() < 1e-6


def test_gradients_of_training_are_those_of_finite_differences() -> None:
    random = np.random.default_rng(0)
    training = _Training(random.uniform(-1, 1, (12, 3)), random.normal(size=(12, 4)), seed=1)
    training._weights = [each.astype(float) for each in training._weights]
    inputs, outputs = random.uniform(-1, 1, (12, 3)), random.normal(size=(12, 4))

    def loss() -> float:
        found = np.array([training.network.values(point)[0] for point in inputs])
        return float(np.mean(np.sum((found - outputs) ** 2, axis=1)))

    gradients, step = training._gradients(inputs, outputs), 1e-6
    for weight, gradient in zip(training._weights, gradients, strict=True):
        place = tuple(random.integers(0, weight.shape))
        before = weight[place]
        weight[place] = before + step
        above = loss()
        weight[place] = before - step
        assert (above - loss()) / (2 * step) == pytest.approx(gradient[place], rel=1e-5, abs=1e-8)
        weight[place] = before


def test_same_samples_same_bytes_and_time_ends_it(samples: Samples, rest: Nodes) -> None:
    one, two = (learn_shape(samples, rest, steps=30) for _ in range(2))
    assert one.network.numbers.tobytes() == two.network.numbers.tobytes()
    assert learn_shape(samples, rest, steps=10**9, seconds=0.2).stopped


def test_too_few_samples_are_refused(starfish: Robot, samples: Samples, rest: Nodes) -> None:
    with pytest.raises(InputError, match="19 samples are too few"):
        learn_shape(samples.first(19), rest)
    with pytest.raises(InputError, match="allow more time"):
        sample_shapes(starfish, 10_000, jobs=1, seconds=1e-6)
