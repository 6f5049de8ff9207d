"""`PushEnv`: a robot pushes a free thing to a place (gymnasium, goal-based)."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.robot import Obstacle, Robot
from hydrostat.training.goal_env import TaskOptions
from hydrostat.training.thing_env import ThingEnv, ThingOptions


@dataclass(frozen=True, kw_only=True)
class PushOptions(ThingOptions):
    """Options of the task of pushing an object.

    Attributes:
        far: goals are drawn within this of the usual place of the thing [m].

    Raises:
        InputError: as for `ThingOptions`, or nothing to go.
    """

    far: float = 20e-3

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 < self.far < np.inf:
            raise InputError(f"far must be above 0 m, not {self.far:g}")


class PushEnv(ThingEnv):
    """`ThingEnv` where goals are places of the middle of the thing, drawn evenly in a disc or ball about the usual one.

    Goals are counted from there, in sizes of the body. Not every one need be within reach of the fingers.
    """

    options: PushOptions

    def __init__(
        self,
        robot: Robot | str,
        *,
        thing: Obstacle | None = None,
        options: PushOptions | None = None,
        contact: bool = False,
        render_mode: str | None = None,
    ) -> None:
        """A robot that pushes; arguments and errors as for `ThingEnv`."""
        made = options or PushOptions()
        super().__init__(robot, thing=thing, options=made, contact=contact, render_mode=render_mode)
        self.unit = self._size

    @classmethod
    def for_task(cls, robot: Robot | str, given: TaskOptions) -> Self:
        """Push as the command line asks for it."""
        return cls._for_thing(robot, given, PushOptions(**given.select_given("steps", "tolerance", "shaped", "tied")))

    @property
    def goal_size(self) -> int:
        """Coordinates of a place."""
        return self.robot.body.mesh.dim

    def get_achieved(self) -> Vector:
        """Position of the object from its usual place, in sizes of the body."""
        return (self.world.place - self._usual) / self._size

    def draw_goal(self, random: np.random.Generator) -> Vector:
        """A place in the disc or ball."""
        way = random.normal(size=self._dim)
        share = random.uniform() ** (1.0 / self._dim)
        return self.options.far / self._size * share * way / np.linalg.norm(way)

    def distances(self, achieved: np.ndarray, desired: np.ndarray) -> np.ndarray:
        """Distances from goals [m]."""
        return self._size * np.linalg.norm(np.asarray(achieved) - np.asarray(desired), axis=-1)

    def words(self) -> str:
        """Return the remaining distance, in words."""
        return f"{1e3 * self._info()['distance']:.1f} mm from the goal"
