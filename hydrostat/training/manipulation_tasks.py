"""`PushEnv`, `TwistEnv`: a robot pushes a free object to a place, or turns it (gymnasium, goal-based)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.robot import Obstacle, Robot
from hydrostat.training.goal_env import TaskOptions, prepare_robot
from hydrostat.training.manipulation_env import ManipulationEnv, ManipulationOptions
from hydrostat.training.manipulation_world import ManipulationPhysics


@dataclass(frozen=True, kw_only=True)
class PushOptions(ManipulationOptions):
    """Options for the pushing task.

    Attributes:
        far: largest distance of a goal from the usual position of the object [m].

    Raises:
        InputError: as for `ManipulationOptions`, or no distance.
    """

    far: float = 20e-3

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 < self.far < np.inf:
            raise InputError(f"far must be above 0 m, not {self.far:g}")


class PushEnv(ManipulationEnv):
    """`ManipulationEnv` with goals for the center of the object, drawn in a disc or ball around its usual position.

    Goals are relative to that position, in body sizes. Some goals may be out of reach of the fingers.
    """

    options: PushOptions

    def __init__(
        self,
        robot: Robot | str,
        *,
        obstacle: Obstacle | None = None,
        options: PushOptions | None = None,
        contact: bool = False,
        render_mode: str | None = None,
    ) -> None:
        """A robot that pushes; arguments and errors as for `ManipulationEnv`."""
        made = options or PushOptions()
        super().__init__(robot, obstacle=obstacle, options=made, contact=contact, render_mode=render_mode)
        self.unit = self._size

    @classmethod
    def for_task(cls, robot: Robot | str, given: TaskOptions) -> Self:
        """Create the environment from the options of the command line."""
        return cls._for_object(robot, given, PushOptions(**given.select_given("steps", "tolerance", "shaped", "tied")))

    @property
    def goal_size(self) -> int:
        """Number of coordinates of a position."""
        return self.robot.body.mesh.dim

    def get_achieved(self) -> Vector:
        """Return the position of the object relative to its usual position, in body sizes."""
        return (self.world.place - self._usual) / self._size

    def draw_goal(self, random: np.random.Generator) -> Vector:
        """Draw a position in the disc or ball."""
        way = random.normal(size=self._dim)
        share = random.uniform() ** (1.0 / self._dim)
        return self.options.far / self._size * share * way / np.linalg.norm(way)

    def distances(self, achieved: np.ndarray, desired: np.ndarray) -> np.ndarray:
        """Return the distances from goals [m]."""
        return self._size * np.linalg.norm(np.asarray(achieved) - np.asarray(desired), axis=-1)

    def words(self) -> str:
        """Return the remaining distance as text."""
        return f"{1e3 * self._info()['distance']:.1f} mm from the goal"


@dataclass(frozen=True, kw_only=True)
class TwistOptions(ManipulationOptions):
    """Options for the twisting task.

    Attributes:
        turn: least and largest goal angle [rad]; negative to turn the other way.
        tolerance: largest remaining angle of a success [rad].

    Raises:
        InputError: as for `ManipulationOptions`, or angles of opposite signs.
    """

    turn: tuple[float, float] = (0.5 * np.pi, 0.5 * np.pi)
    tolerance: float = float(np.deg2rad(1.0))

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.turn[0] * self.turn[1] > 0:
            raise InputError(f"turns that are asked for go one way: give two angles of one sign, not {self.turn}")


class TwistEnv(ManipulationEnv):
    """`ManipulationEnv` with goals for the rotation about an axis, in half turns; turning further counts as success.

    In 3D a spring holds the object near its start, unless `options` set another. The rotation about the axis is the
    twist component of the total rotation, without the swing.
    """

    options: TwistOptions
    measure: ClassVar[tuple[str, float]] = ("degrees", 180.0 / np.pi)

    def __init__(
        self,
        robot: Robot | str,
        *,
        obstacle: Obstacle | None = None,
        options: TwistOptions | None = None,
        axis: Sequence[float] = (0.0, 0.0, 1.0),
        contact: bool = False,
        render_mode: str | None = None,
    ) -> None:
        """A robot that turns an object; arguments and errors as for `ManipulationEnv`."""
        made = prepare_robot(robot, contact)
        options = options or TwistOptions(physics=_physics(made))
        super().__init__(made, obstacle=obstacle, options=options, axis=axis, render_mode=render_mode)
        self.unit = np.pi

    @classmethod
    def for_task(cls, robot: Robot | str, given: TaskOptions) -> Self:
        """Create the environment from the options of the command line."""
        made = prepare_robot(robot)
        options = TwistOptions(**given.select_given("steps", "shaped", "tied"), physics=_physics(made))
        given.refuse("tolerance")
        return cls._for_object(made, given, options)

    @property
    def goal_size(self) -> int:
        """Number of values of a goal: one angle."""
        return 1

    def get_achieved(self) -> Vector:
        """Return the rotation of the object in half turns."""
        return np.array([self.world.turned / np.pi])

    def draw_goal(self, random: np.random.Generator) -> Vector:
        """Draw a goal angle."""
        return np.array([random.uniform(min(self.options.turn), max(self.options.turn)) / np.pi])

    def distances(self, achieved: np.ndarray, desired: np.ndarray) -> np.ndarray:
        """Return the remaining rotations [rad]; 0 for an object that turned further than its goal."""
        wanted = np.asarray(desired)[..., 0]
        return np.pi * np.maximum(np.sign(wanted) * (wanted - np.asarray(achieved)[..., 0]), 0.0)

    def words(self) -> str:
        """Return the rotation of the object as text."""
        return f"turned by {np.rad2deg(self.world.turned):.0f} of {180 * self._goal[0]:.0f} degrees"


def _physics(robot: Robot) -> ManipulationPhysics:
    """A palm in space, none in the plane."""
    hold = 100.0  # Spring in place of a palm under an object in space [N/m]
    return ManipulationPhysics(hold=hold if robot.body.mesh.dim == 3 else 0.0)
