"""`HysteresisEnv`: a robot whose cables rub brings its markers to a goal (gymnasium, goal-based)."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Self

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.learning import LearnedModel
from hydrostat.robot import Robot
from hydrostat.training.goal_env import TaskOptions, prepare_robot
from hydrostat.training.reach_env import ReachEnv, ReachOptions, reach_options
from hydrostat.training.worlds import ExactWorld, World

FRICTION = 0.2
"""Coefficient mu of cables, where nothing else is said."""


class HysteresisEnv(ReachEnv):
    """`ReachEnv` where the way counts: cables have capstan friction, and an episode begins in a pose at random.

    The same contractions lead elsewhere from another pose. What has slipped is not observed: of the past a policy knows
    the contractions and where the markers are. Goals are where contractions at random lead from rest, with friction.

    Attributes:
        given: the robot as robot.toml has it. Networks of it may be learned in: then the model is wrong.
    """

    def __init__(
        self,
        robot: Robot | str,
        *,
        friction: float | None = FRICTION,
        world: World | None = None,
        options: ReachOptions | None = None,
        contact: bool = False,
        render_mode: str | None = None,
    ) -> None:
        """A robot that reaches.

        Args:
            robot: itself, its folder, or a name such as gallery:cupping_hand.
            friction: coefficient mu of every cable; as in robot.toml if None.
            world: simulator or networks that compute marker positions; if left out the exact simulator, from pose to
                pose.
            options: options of the task.
            contact: True for self-contact if robot.toml does not set contact.
            render_mode: "rgb_array", "human" or None.

        Raises:
            InputError: as for `ReachEnv`, no cable that rubs, or friction below 0.
        """
        self.given = prepare_robot(robot, contact)
        rubs = rubbing(self.given, friction)
        super().__init__(
            rubs, world=world or ExactWorld(rubs, from_rest=False), options=options, render_mode=render_mode
        )

    @property
    def portable(self) -> bool:
        """Never: the same contractions lead elsewhere from another pose."""
        return False

    @classmethod
    def for_task(cls, robot: Robot | str, given: TaskOptions) -> Self:
        """Reach as the command line asks for it."""
        given.refuse("actions", "tied", "thing")
        more = given.select_given("friction", "contact")
        return cls(robot, options=reach_options(given), **more)

    def drawn(self, random: np.random.Generator) -> dict[str, Any] | None:
        """A goal, and contractions in which the episode begins [m]."""
        goal = super().drawn(random)
        return None if goal is None else {**goal, "start": self.anywhere(random)}

    def _check(self, model: LearnedModel) -> None:
        """Check that networks are of the robot as it is given."""
        model.check(self.given)

    def _begun(self, given: Mapping[str, Any]) -> tuple[Vector, Vector]:
        """The pose of contractions given as "start" [m], come to from rest; rest, where there is none."""
        taken, at = super()._begun(given)
        start = np.asarray(given.get("start", taken), dtype=float)
        if start.shape != taken.shape:
            raise InputError(f"a start has {len(taken)} contractions, not {start.size}")
        reached = self.world.reach(start) if start.any() else None
        return (taken, at) if reached is None else (start, reached)


def rubbing(robot: Robot, friction: float | None) -> Robot:
    """A robot whose cables all have a coefficient of friction; itself if that is None.

    Raises:
        InputError: friction below 0, or none that is given and none that the cables have.
    """
    if friction is None:
        if not any(cable.friction for cable in robot.cables):
            raise InputError(f"no cable of robot {robot.name!r} rubs: give friction, here or in robot.toml")
        return robot
    if not 0 <= friction < np.inf:
        raise InputError(f"friction must be 0 or more, not {friction:g}")
    return robot.with_network(robot.winches, [replace(cable, friction=friction) for cable in robot.cables])
