"""`portable_policy`: a policy that was learned, as part of a learned model that runs without torch."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.learning import LearnedModel
from hydrostat.learning.perceptrons import Perceptrons
from hydrostat.training.reach_env import ReachEnv


def portable_policy(trained: Any, env: ReachEnv, model: LearnedModel) -> LearnedModel:
    """The learned model with a policy in the place of its inverse network.

    It answers as any learned model: `solve(targets, search=False)`. Only a policy of one action (T = 1), of all markers
    and of each winch alone: then the goal is all that it sees; what it sees of the rest pose is added to its biases.

    Args:
        trained: a model of stable-baselines3.
        env: in which it was trained.
        model: networks of the same robot.

    Raises:
        InputError: a policy that needs to see more than the goal, or networks of another robot.
    """
    model.check(env.robot)
    if not env.portable:
        raise InputError("only a policy of one action, of all markers and of each winch alone can be taken along")
    layers = _layers(trained.policy.actor)
    count = len(env.seen)
    seen, _ = env.reset(seed=0)
    first, bias = layers[0]
    kinds = list(env.observation_space.spaces)  # type: ignore[attr-defined]
    bias = bias + first @ np.concatenate([np.zeros(count) if kind == _GOAL else seen[kind] for kind in kinds])
    begin = sum(len(seen[kind]) for kind in kinds[: kinds.index(_GOAL)])
    goals = first[:, begin : begin + count]
    rest = env.rest[env.seen]
    scale = model.unit[:count] / env.unit  # the networks count markers from their mean, in units of their own
    bias = bias + goals @ ((model.middle[:count] - rest) / env.unit)
    layers[0] = (goals * scale, bias)
    sizes = np.array([count, *(len(offsets) for _, offsets in layers)])
    numbers = [np.concatenate([weights.T.ravel(), offsets]) for weights, offsets in layers]
    straight = np.zeros(int(sizes[0] * sizes[-1]))
    assert sum(map(len, numbers)) + len(straight) == Perceptrons.count(sizes)
    policy = Perceptrons(sizes=sizes, numbers=np.concatenate([*numbers, straight])[None])
    facts = {**model.facts, "inverse_error": None, "policy": type(trained).__name__}
    return replace(model, facts=facts, inverse=policy)


def _layers(actor: Any) -> list[tuple[np.ndarray, np.ndarray]]:
    """Weights (outputs, inputs) and biases of an actor's layers, to the mean of its action before tanh."""
    parts = [actor.latent_pi, actor.mu] if hasattr(actor, "latent_pi") else [actor.mu]
    linear = [each for part in parts for each in part.modules() if type(each).__name__ == "Linear"]
    found = [(each.weight.detach().double().numpy(), each.bias.detach().double().numpy()) for each in linear]
    assert all(len(one[1]) == two[0].shape[1] for one, two in pairwise(found))
    return found


_GOAL = "desired_goal"
"""What an observation calls the goal."""
