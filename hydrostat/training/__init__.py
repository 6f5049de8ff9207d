"""Reinforcement learning: goal-based environments of any robot (gymnasium), and policies learned in them.

Needs the extra `rl`. Environments are registered with gymnasium as hydrostat/Reach-v0 when this is imported.
"""

import gymnasium

from hydrostat.training.portable import is_portable, portable_policy
from hydrostat.training.reach_env import ReachEnv, ReachOptions
from hydrostat.training.train import CurvePoint, TrainMethod, TrainOptions, held_out_goals, judge, train
from hydrostat.training.worlds import ExactWorld, LearnedWorld, MixedWorld, World

__all__ = [
    "CurvePoint",
    "ExactWorld",
    "LearnedWorld",
    "MixedWorld",
    "ReachEnv",
    "ReachOptions",
    "TrainMethod",
    "TrainOptions",
    "World",
    "held_out_goals",
    "is_portable",
    "judge",
    "portable_policy",
    "register",
    "train",
]


def register() -> None:
    """Register the environments with gymnasium, once."""
    if "hydrostat/Reach-v0" not in gymnasium.registry:
        gymnasium.register("hydrostat/Reach-v0", "hydrostat.training.reach_env:ReachEnv")


register()
