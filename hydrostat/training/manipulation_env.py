"""`ManipulationEnv`: a robot moves a free object by keyframes (gymnasium, goal-based): what Push and Twist share."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np
from gymnasium import spaces

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.robot import Obstacle, Robot
from hydrostat.training.env_pictures import ManipulationPictures
from hydrostat.training.goal_env import AN_ACTION, GoalEnv, TaskOptions, check_task, finite_numbers, prepare_robot
from hydrostat.training.manipulation_world import (
    ManipulationPhysics,
    ManipulationWorld,
    ObjectState,
    as_drawn,
    is_clear,
)


@dataclass(frozen=True, kw_only=True)
class ManipulationOptions:
    """Options of the tasks of moving an object.

    Attributes:
        steps: keyframes of an episode (T).
        tied: parts of names: winches whose names have one are moved by one number; others are moved alone.
        travel: most that an action takes in [m]; that of the winch if None.
        tolerance: largest distance that is a success, in the unit of the task.
        shaped: reward is minus the distance in units of the tolerance; else 0 for success and -1.
        friction: the object's is drawn within this share of its own, up and down.
        radius: its radius, likewise.
        start: along each axis it begins within this of its place [m].
        physics: options of the motion in time.

    Raises:
        InputError: a number out of its range.
    """

    steps: int = 4
    tied: Sequence[str] = ()
    travel: float | None = None
    tolerance: float = 5e-3
    shaped: bool = True
    friction: float = 0.3
    radius: float = 0.05
    start: float = 5e-3
    physics: ManipulationPhysics = field(default_factory=ManipulationPhysics)

    def __post_init__(self) -> None:
        check_task(self)
        for name in ("tolerance", "travel"):
            value = getattr(self, name)
            if value is not None and not 0 < value < np.inf:
                raise InputError(f"{name} must be above 0, not {value:g}")
        for name in ("friction", "radius"):
            if not 0 <= getattr(self, name) < 1:
                raise InputError(f"{name} is drawn within a share from 0 to below 1, not {getattr(self, name):g}")
        if not 0 <= self.start < np.inf:
            raise InputError(f"start must be 0 m or more, not {self.start:g}")


class ManipulationEnv(GoalEnv):
    """Goal-based environment in time: actions are keyframes, contractions that winches go to; then the hand opens.

    Each episode has an object of its own: friction, radius and start are drawn, and the policy sees none of them but
    where the object is. Observations hold the contractions (from -1 to 1), where the middle of the object is, counted
    from its usual place in sizes of the body, how far it has turned in half turns, and the share of the keyframes that
    are done. Where the simulator finds no time step, nothing counts as achieved in that episode. Cost is counted in
    time steps of the exact simulator that were asked for, `ManipulationPhysics.beats` for each keyframe and as many to
    open the hand.

    Attributes:
        options: options of the task.
        obstacle: object with its usual properties.
        world: robot and obstacle, now.
    """

    cost: ClassVar[str] = "time steps"

    def __init__(
        self,
        robot: Robot | str,
        *,
        obstacle: Obstacle | None = None,
        options: ManipulationOptions,
        axis: Sequence[float] = (0.0, 0.0, 1.0),
        contact: bool = False,
        render_mode: str | None = None,
    ) -> None:
        """A robot that moves an object.

        Args:
            robot: itself, its folder, or a name such as gallery:caging_gripper.
            obstacle: object that is moved, with a mass; the first obstacle of the robot that has one if left out.
            options: options of the task.
            axis: about which turns count, of any length but 0; of no matter in the plane.
            contact: True for self-contact if robot.toml does not set contact.
            render_mode: "rgb_array", "human" or None.

        Raises:
            InputError: a robot without winches, no object, one that is in the body or has no mass.
        """
        self.robot = prepare_robot(robot, contact)
        if not self.robot.winches:
            raise InputError(f"robot {self.robot.name!r} needs a winch to move an object by")
        self.options, self.render_mode = options, render_mode
        self.obstacle = _find_object(self.robot, obstacle)
        if not np.any(axis):
            raise InputError("the axis of turns must not be 0 along every axis")
        unit = np.array(axis, dtype=float) / np.linalg.norm(axis)
        self.world = ManipulationWorld(self.robot, self.obstacle, unit, options.physics)
        self.steps, self.tolerance, self._pictures = options.steps, options.tolerance, None
        self._groups = _group_winches(self.robot, options.tied)
        self._low = np.array([-winch.release for winch in self.robot.winches], dtype=float)
        travel = np.inf if options.travel is None else options.travel
        self._high = np.array([min(winch.travel, travel) for winch in self.robot.winches], dtype=float)
        self._dim, self._size = self.robot.body.mesh.dim, self.robot.body.mesh.size
        self._usual = self.obstacle.frame()[0]
        self._goal, self._stuck, self._begun = np.zeros(self.goal_size), False, np.zeros(self.goal_size)
        self.action_space = spaces.Box(-1.0, 1.0, (len(self._groups),), np.float32)
        goal = spaces.Box(-100.0, 100.0, (self.goal_size,), np.float64)
        seen = spaces.Box(-100.0, 100.0, (len(self.robot.winches) + self._dim + 2,), np.float64)
        self.observation_space = spaces.Dict(observation=seen, achieved_goal=goal, desired_goal=goal)

    @property
    @abstractmethod
    def goal_size(self) -> int:
        """Number of coordinates of a goal."""

    @abstractmethod
    def get_achieved(self) -> Vector:
        """Achieved state, as a goal."""

    @abstractmethod
    def draw_goal(self, random: np.random.Generator) -> Vector:
        """A goal at random."""

    @abstractmethod
    def distances(self, achieved: np.ndarray, desired: np.ndarray) -> np.ndarray:
        """Difference between achieved and desired goals, one or a row each, in the unit of the tolerance."""

    @abstractmethod
    def words(self) -> str:
        """Description of the episode, in a line."""

    @property
    def equilibria(self) -> int:
        """Time steps of the exact simulator that were asked for."""
        return self.world.time_steps

    def sample_episode(self, random: np.random.Generator) -> dict[str, Any] | None:
        """Draw a goal and an object: factors of its friction and radius, its start [m]; None: in the body."""
        options, pick = self.options, random.uniform
        state = ObjectState(
            friction=1 + options.friction * pick(-1, 1),
            radius=1 + options.radius * pick(-1, 1),
            start=tuple((options.start * pick(-1, 1, self._dim)).tolist()),
        )
        goal = self.draw_goal(random)
        return {"goal": goal, **state._asdict()} if is_clear(self.robot, as_drawn(self.obstacle, state)) else None

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, Vector], dict[str, Any]]:
        """Go to rest with what is drawn; or with "goal" and any of "friction", "radius", "start" as `drawn` has them.

        Raises:
            InputError: a goal or a start of another size.
        """
        super().reset(seed=seed)
        given = dict(options or {})
        while "goal" not in given:
            given = {**(self.sample_episode(self.np_random) or {}), **given}
        goal, start = finite_numbers(given["goal"], self.goal_size, "a goal", "numbers"), tuple(given.get("start", ()))
        if len(start) not in (0, self._dim):
            raise InputError(f"a start has {self._dim} coordinates, not {len(start)}")
        self._goal, self.taken_steps = goal, 0
        self.world.begin(ObjectState(float(given.get("friction", 1.0)), float(given.get("radius", 1.0)), start))
        self.moves = [(0.0, self.world.motion.contractions)]
        self._stuck, self._begun = False, self.get_achieved()
        self.show()
        return self._observation(), self._info()

    def step(self, action: np.ndarray) -> tuple[dict[str, Vector], float, bool, bool, dict[str, Any]]:
        """Go to a keyframe; after the last one the hand opens, to no contraction."""
        action = finite_numbers(action, len(self._groups), *AN_ACTION)
        self.taken_steps += 1
        self._go(self.contractions(action))
        over = self.taken_steps >= self.steps
        if over:
            self._go(np.clip(np.zeros(len(self._low)), self._low, self._high))
        self.show()
        observation, info = self._observation(), self._info()
        reward = float(self.compute_reward(observation["achieved_goal"], observation["desired_goal"], info))
        return observation, reward, False, over, info

    def contractions(self, action: np.ndarray) -> Vector:
        """Contractions of an action [m]: from release to travel."""
        taken = np.zeros(len(self._low))
        for value, group in zip(np.clip(action, -1.0, 1.0).tolist(), self._groups, strict=True):
            rows = list(group)
            taken[rows] = self._low[rows] + 0.5 * (value + 1.0) * (self._high[rows] - self._low[rows])
        return taken

    def compute_reward(self, achieved: np.ndarray, desired: np.ndarray, info: Any) -> float | np.ndarray:
        """Reward of what is achieved for what is desired, one or a row each; nothing else decides about it."""
        left = self.distances(achieved, desired)
        tolerance = self.options.tolerance
        return -left / tolerance if self.options.shaped else -np.asarray(left >= tolerance, dtype=float)

    def go_on(self, kept: Mapping[str, Any]) -> None:
        """Go on, from the next episode, where an environment was that has been kept."""
        super().go_on(kept)
        self.world.time_steps = kept["equilibria"]

    def picture(self) -> np.ndarray:
        """Picture of the robot and the object, with dots on it that show its rotation."""
        if self._pictures is None:
            self._pictures = ManipulationPictures(self.robot, self.obstacle)
        return self._pictures.draw(self.world, f"{self.words()}, after keyframe {self.taken_steps} of {self.steps}")

    def _go(self, contractions: Vector) -> None:
        motions = self.world.go(contractions)
        self._stuck |= len(motions) < self.options.physics.beats
        self.moves += [(motion.time, motion.contractions) for motion in motions]

    def _counted_goal(self) -> Vector:
        """Achieved goal; the one at the beginning of the episode if a time step did not converge."""
        return self._begun.copy() if self._stuck else self.get_achieved()

    def _observation(self) -> dict[str, Vector]:
        span = np.where(self._high > self._low, self._high - self._low, 1.0)
        moved = (self.world.place - self._usual) / self._size
        taken = np.clip(2.0 * (self.world.motion.contractions - self._low) / span - 1.0, -1.0, 1.0)
        more = [self.world.turned / np.pi, self.taken_steps / self.steps]
        seen = np.concatenate([taken, moved, more])
        return {"observation": seen, "achieved_goal": self._counted_goal(), "desired_goal": self._goal.copy()}

    def _info(self) -> dict[str, Any]:
        left = float(self.distances(self._counted_goal(), self._goal))
        away = float(np.linalg.norm(self.world.place - self.world.start))
        return {
            "distance": left,
            "is_success": left < self.options.tolerance,
            "turned": self.world.turned,
            "moved": away,
        }

    @classmethod
    def _for_object(cls, robot: Robot | str, given: TaskOptions, options: ManipulationOptions, **more: Any) -> Self:
        """One with an object as the command line asks for it."""
        given.refuse("markers", "pairs", "incremental", "actions")
        made, obstacle = prepare_robot(robot), given.obstacle
        obstacle = obstacle if obstacle is not None or given.friction is None else _find_object(made, None)
        return cls(made, obstacle=_rubbing(obstacle, given.friction), options=options, contact=given.contact, **more)


def _rubbing(obstacle: Obstacle | None, friction: float | None) -> Obstacle | None:
    return obstacle if obstacle is None or friction is None else replace(obstacle, friction=friction)


def _find_object(robot: Robot, given: Obstacle | None) -> Obstacle:
    """Object that is moved, with a friction of its own (InputError: none, or one that cannot be moved)."""
    free = [each for each in robot.obstacles if each.mass is not None]
    if given is None and not free:
        raise InputError(
            f"robot {robot.name!r} has nothing to move: give an [[obstacle]] a mass, or give an object (--object)"
        )
    obstacle = given or free[0]
    if obstacle.mass is None:
        raise InputError(f'"{obstacle.name}" stands still: give it a mass')
    if len(obstacle.at) != robot.body.mesh.dim:
        raise InputError(
            f'"{obstacle.name}" has {len(obstacle.at)} coordinates, but the body has {robot.body.mesh.dim}'
        )
    if not is_clear(robot, obstacle):
        raise InputError(f'"{obstacle.name}" begins in the body or touches it: put it elsewhere')
    return replace(obstacle, friction=robot.friction_of(obstacle))


def _group_winches(robot: Robot, parts: Sequence[str]) -> tuple[tuple[int, ...], ...]:
    """Winches moved by one number of the action each (InputError: a part that no name has, or one that two have)."""
    names = [winch.name for winch in robot.winches]
    groups = []
    for part in parts:
        rows = tuple(index for index, name in enumerate(names) if part in name)
        if not rows:
            raise InputError(f'robot {robot.name!r}: no winch name contains "{part}". Available: {", ".join(names)}.')
        groups.append(rows)
    used = [row for group in groups for row in group]
    if len(set(used)) < len(used):
        raise InputError(f"a winch is tied to others once only; these parts share some: {', '.join(parts)}")
    return tuple(sorted([*groups, *((row,) for row in range(len(names)) if row not in used)]))
