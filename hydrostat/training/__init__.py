"""Reinforcement learning: goal-based environments of any robot (gymnasium), and policies learned in them.

Needs the extra `rl`. Once this is imported, environments of all `TASKS`, such as hydrostat/Reach-v0, are registered.
"""

from typing import TYPE_CHECKING

import gymnasium

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.training.experiments import EXPERIMENTS, Experiment, Ran, final
    from hydrostat.training.gait import Gait
    from hydrostat.training.goal_env import GoalEnv, TaskOptions
    from hydrostat.training.hysteresis_env import HysteresisEnv
    from hydrostat.training.policies import PAIRS_ALONE, UNFILLED, WAYS, Budget, drawn_pairs
    from hydrostat.training.portable import policy_of, portable_policy
    from hydrostat.training.push_env import PushEnv, PushOptions
    from hydrostat.training.reach_env import BEYOND, ReachEnv, ReachOptions
    from hydrostat.training.reference import REFERENCES, none_missed_from, run_reference
    from hydrostat.training.run_experiment import (
        Judged,
        certified_distances,
        exact_distances,
        exact_goals,
        finger_pairs,
        run_experiment,
    )
    from hydrostat.training.shared_data import ORDERS, OfPairs, compare_on_shared_data
    from hydrostat.training.tasks import TASKS, Task, task_of
    from hydrostat.training.thing_env import ThingEnv, ThingOptions
    from hydrostat.training.thing_world import ThingPhysics, ThingState, ThingWorld
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
    from hydrostat.training.trials import NetworkReach
    from hydrostat.training.twist_env import TwistEnv, TwistOptions
    from hydrostat.training.verdict import interquartile, verdict
    from hydrostat.training.walk_env import WalkActions, WalkEnv, WalkOptions
    from hydrostat.training.worlds import ExactWorld, LearnedWorld, MixedWorld, World

__all__ = [
    "BEYOND",
    "EXPERIMENTS",
    "ORDERS",
    "PAIRS_ALONE",
    "REFERENCES",
    "TASKS",
    "UNFILLED",
    "WAYS",
    "Budget",
    "CurvePoint",
    "ExactWorld",
    "Experiment",
    "Gait",
    "GoalEnv",
    "HysteresisEnv",
    "Judged",
    "LearnedWorld",
    "Listener",
    "MixedWorld",
    "NetworkReach",
    "OfPairs",
    "PushEnv",
    "PushOptions",
    "Ran",
    "ReachEnv",
    "ReachOptions",
    "Task",
    "TaskOptions",
    "ThingEnv",
    "ThingOptions",
    "ThingPhysics",
    "ThingState",
    "ThingWorld",
    "TrainMethod",
    "TrainOptions",
    "TwistEnv",
    "TwistOptions",
    "WalkActions",
    "WalkEnv",
    "WalkOptions",
    "World",
    "begun_curve",
    "certified_distances",
    "compare_on_shared_data",
    "drawn_pairs",
    "exact_distances",
    "exact_goals",
    "final",
    "finger_pairs",
    "held_out_goals",
    "interquartile",
    "judge",
    "moves_of",
    "none_missed_from",
    "policy_of",
    "portable_policy",
    "run_experiment",
    "run_reference",
    "task_of",
    "train",
    "verdict",
]


def register() -> None:
    """Register the environments with gymnasium, once."""
    from hydrostat.training.tasks import TASKS

    for task in TASKS.values():
        if task.id not in gymnasium.registry:
            gymnasium.register(task.id, f"{task.env.__module__}:{task.env.__name__}")


open_package(__name__)
register()
