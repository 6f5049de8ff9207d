"""`policy_of`, `portable_policy`: a policy that was learned, alone or in a learned model; it runs without torch."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.learning import LearnedModel, Perceptrons, PortablePolicy, physics_hash
from hydrostat.training.goal_env import GoalEnv
from hydrostat.training.reach_env import ReachEnv


def policy_of(trained: Any, env: GoalEnv, *, task: str, error: float) -> PortablePolicy:
    """Return the policy of a stable-baselines3 model, for any task.

    Args:
        trained: trained policy.
        env: environment of the training.
        task: name of the task.
        error: mean final distance on unseen goals, in the unit of the task.
    """
    seen = env.observation_space.spaces  # type: ignore[attr-defined]
    sees = [[name, int(np.prod(space.shape))] for name, space in seen.items()]
    facts = {"task": task, "robot": env.robot.name, "physics": physics_hash(env.robot), "sees": sees}
    facts |= {"actions": int(np.prod(env.action_space.shape)), "error": error, "method": type(trained).__name__}  # type: ignore[arg-type]
    return PortablePolicy(facts=facts, network=Perceptrons.of_layers(_layers(trained.policy.actor)))


def portable_policy(trained: Any, env: ReachEnv, model: LearnedModel) -> LearnedModel:
    """Return a learned model in which a policy replaces the inverse network.

    Use it as any learned model: `solve(targets, search=False)`. The policy must have one action (T = 1), all markers
    and no pairs of winches: it then observes only the goal. The rest pose, which is constant, is added to its biases.

    Args:
        trained: stable-baselines3 model.
        env: environment of the training.
        model: networks of the same robot.

    Raises:
        InputError: a policy with observations other than the goal, or networks of another robot.
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
    card = replace(model.card, inverse_error=None, policy=type(trained).__name__, pairs=())  # each winch alone
    return replace(model, card=card, inverse=Perceptrons.of_layers(layers))


def _layers(actor: Any) -> list[tuple[np.ndarray, np.ndarray]]:
    """Weights (outputs, inputs) and biases of an actor's layers, to the mean of its action before tanh."""
    parts = [actor.latent_pi, actor.mu] if hasattr(actor, "latent_pi") else [actor.mu]
    linear = [each for part in parts for each in part.modules() if type(each).__name__ == "Linear"]
    found = [(each.weight.detach().double().numpy(), each.bias.detach().double().numpy()) for each in linear]
    assert all(len(one[1]) == two[0].shape[1] for one, two in pairwise(found))
    return found


_GOAL = "desired_goal"
"""Key of the goal in an observation."""
