"""`TASKS`: what a robot can learn by trial and error, by name."""

from collections.abc import Mapping
from dataclasses import dataclass

from hydrostat.errors import InputError
from hydrostat.training.goal_env import GoalEnv
from hydrostat.training.manipulation_tasks import PushEnv, TwistEnv
from hydrostat.training.reach_env import HysteresisEnv, ReachEnv
from hydrostat.training.walk_env import WalkEnv


@dataclass(frozen=True)
class Task:
    """Something to learn.

    Attributes:
        id: by which gymnasium makes its environment.
        env: its environment.
        words: description of one line.
    """

    id: str
    env: type[GoalEnv]
    words: str


TASKS: Mapping[str, Task] = {
    "reach": Task("hydrostat/Reach-v0", ReachEnv, "bring markers to goals"),
    "reach-with-hysteresis": Task(
        "hydrostat/ReachWithHysteresis-v0", HysteresisEnv, "the same with cables that rub, from a pose at random"
    ),
    "push": Task("hydrostat/Push-v0", PushEnv, "push a free object to a place"),
    "twist": Task("hydrostat/Twist-v0", TwistEnv, "turn a free object by keyframes"),
    "walk": Task("hydrostat/Walk-v0", WalkEnv, "go a way along the ground, held by nothing"),
}
"""By their names on the command line."""


def task_of(name: str) -> Task:
    """Return the task of a name (InputError: unknown name)."""
    if name not in TASKS:
        raise InputError(f'unknown task "{name}". Available: {", ".join(TASKS)}.')
    return TASKS[name]
