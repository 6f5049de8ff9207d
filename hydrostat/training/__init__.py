"""Reinforcement learning: goal-based gymnasium environments for any robot, and training of policies in them.

Needs the extra `rl`. Once this is imported, environments of all `TASKS`, such as hydrostat/Reach-v0, are registered.
"""

from typing import TYPE_CHECKING

import gymnasium

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.training.goal_env import TaskOptions
    from hydrostat.training.manipulation_tasks import PushEnv, PushOptions, TwistEnv, TwistOptions
    from hydrostat.training.manipulation_world import ManipulationPhysics
    from hydrostat.training.portable import policy_of, portable_policy
    from hydrostat.training.reach_env import HysteresisEnv, ReachEnv, ReachOptions
    from hydrostat.training.tasks import task_of
    from hydrostat.training.train import (
        CurvePoint,
        Listener,
        TrainMethod,
        TrainOptions,
        begun_curve,
        held_out_goals,
        judge,
        moves_of,
        train,
    )
    from hydrostat.training.walk_env import Gait, WalkEnv, WalkOptions


__all__ = [
    "CurvePoint",
    "Gait",
    "HysteresisEnv",
    "Listener",
    "ManipulationPhysics",
    "PushEnv",
    "PushOptions",
    "ReachEnv",
    "ReachOptions",
    "TaskOptions",
    "TrainMethod",
    "TrainOptions",
    "TwistEnv",
    "TwistOptions",
    "WalkEnv",
    "WalkOptions",
    "begun_curve",
    "held_out_goals",
    "judge",
    "moves_of",
    "policy_of",
    "portable_policy",
    "task_of",
    "train",
]


def register() -> None:
    """Register the environments with gymnasium, once."""
    from hydrostat.training.tasks import TASKS

    for task in TASKS.values():
        if task.id not in gymnasium.registry:
            gymnasium.register(task.id, f"{task.env.__module__}:{task.env.__name__}")


open_package(__name__)
register()
