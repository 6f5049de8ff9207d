"""`ReachEnv`: a robot brings its markers to a goal (gymnasium, goal-based)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from gymnasium import spaces

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.given import check_type
from hydrostat.learning import TANH_SCALE, LearnedModel
from hydrostat.robot import PoseTarget, Robot
from hydrostat.training.backends import Backend, ExactBackend, LearnedBackend, MixedBackend
from hydrostat.training.goal_env import AN_ACTION, GoalEnv, TaskOptions, check_task, finite_numbers, prepare_robot
from hydrostat.units import quote


@dataclass(frozen=True, kw_only=True)
class ReachOptions:
    """Options for the reaching task.

    Attributes:
        markers: markers that have goals; all if empty.
        pairs: antagonistic pairs of winches, each moved by one component of the action; other winches have their own.
        steps: number of actions in an episode (T).
        incremental: True if an action changes the contractions, by at most a tenth of their range.
        tolerance: largest mean marker error of a success [m].
        shaped: True for a reward of minus the mean distance in units of the tolerance; False for 0 on success, else -1.
        sensors: True to add `sensors` to observations: readings of the robot's sensors with noise, in SI units.

    Raises:
        InputError: markers that are not a list, steps below 1, or a tolerance that is not above 0.
    """

    markers: Sequence[str] = ()
    pairs: Sequence[Sequence[str]] = ()
    steps: int = 1
    incremental: bool = False
    tolerance: float = 5e-3
    shaped: bool = True
    sensors: bool = False

    def __post_init__(self) -> None:
        for name, wanted in (("markers", 'a list of names, such as ["tip"]'), ("pairs", "a list of pairs of winches")):
            check_type(getattr(self, name), (tuple, list), f"{name} must be {wanted}")
        check_task(self)
        if not 0 < self.tolerance < np.inf:
            raise InputError(f"tolerance must be above 0 m, not {self.tolerance:g}")


class ReachEnv(GoalEnv):
    """Goal-based environment: actions set contractions and drive values; goals are marker positions at random actions.

    Observations hold the contractions (from -1 to 1), marker positions and their goals, minus the positions at rest, in
    body sizes. Each goal costs one equilibrium, which is counted with the others.

    Attributes:
        robot: robot to move.
        backend: simulator or networks that compute marker positions.
        options: task options.
        seen: indices of the observed marker coordinates.
        rest: coordinates of all markers at rest [m].
    """

    def __init__(
        self,
        robot: Robot | str,
        *,
        backend: Backend | None = None,
        options: ReachOptions | None = None,
        contact: bool = False,
        render_mode: str | None = None,
    ) -> None:
        """A robot that reaches.

        Args:
            robot: itself, its folder, or a name such as gallery:cupping_hand.
            backend: simulator or networks that compute marker positions; the exact simulator if left out.
            options: options of the task.
            contact: True for self-contact if robot.toml does not set contact.
            render_mode: "rgb_array", "human" or None.

        Raises:
            InputError: a robot without winches or markers, or names that it does not have.
        """
        self.robot = prepare_robot(robot, contact)
        self.backend = backend or ExactBackend(self.robot)
        self.options, self.render_mode = options or ReachOptions(), render_mode
        robot_ = self.robot
        if not robot_.num_controls or not robot_.markers:
            raise InputError(
                f"robot {robot_.name!r} needs a winch or drive to be moved by and a marker to be looked at"
            )
        self._groups = _groups(robot_, self.options.pairs)
        self._low, self._high = robot_.control_limits
        names = [marker.name for marker in robot_.markers]
        for name in self.options.markers:
            if name not in names:
                raise InputError(f"robot {robot_.name!r}: unknown marker {quote(name)}. Available: {', '.join(names)}.")
        rows = [names.index(name) for name in self.options.markers or names]
        self._dim = robot_.body.mesh.dim
        self.seen = (self._dim * np.array(rows)[:, None] + np.arange(self._dim)).ravel()
        self.rest = np.array([marker.at for marker in robot_.markers], dtype=float).ravel()
        self.unit = robot_.body.mesh.size
        many, coordinates = len(self._groups), len(self.seen)
        self.action_space = spaces.Box(-1.0, 1.0, (many,), np.float32)
        place = spaces.Box(-10.0, 10.0, (coordinates,), np.float64)
        self.observation_space = spaces.Dict(
            observation=spaces.Box(-1.0, 1.0, (robot_.num_controls,), np.float64),
            achieved_goal=place,
            desired_goal=place,
        )
        if self.options.sensors:
            if not (count := sum(sensor.count_values(self._dim) for sensor in robot_.sensors)):
                raise InputError(f"robot {robot_.name!r} has no sensors: add [[sensor]], or leave the option out")
            self.observation_space["sensors"] = spaces.Box(-np.inf, np.inf, (count,), np.float64)
        self.steps, self.tolerance, self._pictures = self.options.steps, self.options.tolerance, None
        self._taken, self._at, self._goal = np.zeros(len(self._low)), self.rest, self.rest

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, Vector], dict[str, Any]]:
        """Return to rest, with a new goal; or with coordinates [m] given as "goal" in `options`."""
        super().reset(seed=seed)
        self.backend.begin()
        given = dict(options or {})
        while "goal" not in given:
            given = {**(self.sample_episode(self.np_random) or {}), **given}
        goal = finite_numbers(given["goal"], len(self.seen), "a goal", "coordinates [m]")
        self._goal, self.taken_steps = self.rest.copy(), 0
        self._goal[self.seen] = goal
        self.backend.back()
        self._taken, self._at = self._find_start(given)
        self.moves = [(0.0, self._taken)]
        self.show()
        return self._observation(), self._info()

    def step(self, action: np.ndarray) -> tuple[dict[str, Vector], float, bool, bool, dict[str, Any]]:
        """Apply an action; the episode ends after its last step."""
        action = finite_numbers(action, int(np.prod(self.action_space.shape or (0,))), *AN_ACTION)
        self.taken_steps += 1
        if self.options.incremental:
            change = 0.1 * (self._high - self._low) * self._spread_action(np.clip(action, -1.0, 1.0))
            taken = np.clip(self._taken + change, self._low, self._high)
        else:
            taken = self.contractions(action)
        reached = self.backend.reach(taken)
        if reached is not None:  # where no equilibrium is found the robot stays
            self._taken, self._at = taken, reached
        pace = 1.0  # From an action to the next, where motors play what was done at rest [s]
        self.moves.append((pace * self.taken_steps, self._taken))
        self.show()
        observation, info = self._observation(), self._info()
        reward = float(self.compute_reward(observation["achieved_goal"], observation["desired_goal"], info))
        return observation, reward, False, self.taken_steps >= self.steps, info

    def compute_reward(self, achieved: np.ndarray, desired: np.ndarray, info: Any) -> float | np.ndarray:
        """Return the reward of positions and goals, for one or for each row; it depends on nothing else."""
        far = self.distances(achieved, desired)
        tolerance = self.options.tolerance
        return -far / tolerance if self.options.shaped else -np.asarray(far >= tolerance, dtype=float)

    def distances(self, achieved: np.ndarray, desired: np.ndarray) -> float | np.ndarray:
        """Return the mean marker error [m], for one or for each row of observed positions."""
        apart = self.unit * (np.asarray(achieved) - np.asarray(desired))
        return np.linalg.norm(apart.reshape(*apart.shape[:-1], -1, self._dim), axis=-1).mean(axis=-1)

    def contractions(self, action: np.ndarray) -> Vector:
        """Return the contractions of an action [m]: release to travel for a winch, 0 to travel for one of a pair."""
        taken = np.zeros(len(self._low))
        for value, group in zip(
            np.clip(TANH_SCALE * np.asarray(action, dtype=float), -1, 1).tolist(), self._groups, strict=True
        ):
            one = group[0]
            if len(group) == 1:
                taken[one] = self._low[one] + 0.5 * (value + 1.0) * (self._high[one] - self._low[one])
            else:
                taken[one], taken[group[1]] = max(value, 0.0) * self._high[one], max(-value, 0.0) * self._high[group[1]]
        return taken

    @classmethod
    def for_task(cls, robot: Robot | str, given: TaskOptions) -> Self:
        """Create the environment from the options of the command line."""
        given.refuse("friction", "actions", "tied", "obstacle")
        return cls(robot, options=reach_options(given), contact=given.contact)

    @property
    def portable(self) -> bool:
        """True if a policy observes only the goal: one action, all markers, no pairs of winches."""
        options, names = self.options, [marker.name for marker in self.robot.markers]
        moved_alone = not (options.incremental or options.pairs or options.sensors)
        return options.steps == 1 and moved_alone and list(options.markers or names) == names

    @property
    def equilibria(self) -> int:
        """Number of equilibria that the exact simulator was asked to solve."""
        return self.backend.equilibria

    def sample_episode(self, random: np.random.Generator) -> dict[str, Any] | None:
        """Draw a goal: the marker positions that random contractions reach from rest."""
        self.backend.back()
        reached = self.backend.reach(self.anywhere(random))
        return None if reached is None else {"goal": reached[self.seen]}

    def anywhere(self, random: np.random.Generator) -> Vector:
        """Return the contractions of a random action [m]."""
        return self.contractions(random.uniform(-1.0, 1.0, len(self._groups)))

    def learn_in(self, model: LearnedModel, *, exact: int = 0) -> None:
        """Use networks for marker positions, and the simulator every `exact` episodes (InputError: another robot)."""
        self._check(model)
        networks = LearnedBackend(model)
        self.backend = MixedBackend(networks, self.backend, every=exact) if exact else networks

    def get_state(self) -> dict[str, Any]:
        """Return the state that the next episode depends on, and the cost so far."""
        return {**super().get_state(), "backend": self.backend.get_state()}

    def go_on(self, kept: Mapping[str, Any]) -> None:
        """Restore a saved state and continue with the next episode."""
        super().go_on(kept)
        self.backend.go_on(kept["backend"])

    def picture(self) -> np.ndarray:
        """Return a picture of the robot and its goal.

        Networks predict no shape: in their episodes the picture shows the simulated pose, solved from rest.
        """
        from hydrostat.training.env_pictures import ReachPictures

        if self._pictures is None:
            self._pictures = ReachPictures(self.robot)
        markers, places = self.robot.markers, self._goal.reshape(-1, self._dim).tolist()
        goals = {markers[row].name: tuple(places[row]) for row in (self.seen[:: self._dim] // self._dim).tolist()}
        far = 1e3 * self._info()["distance"]
        words = f"{far:.1f} mm from the goal, after action {self.taken_steps} of {self.steps}"
        return self._pictures.draw(self.backend.pose, self._taken, PoseTarget(name="goal", targets=goals), words)

    def _check(self, model: LearnedModel) -> None:
        """Check that networks are of this robot (InputError: of another)."""
        model.check(self.robot)

    def _find_start(self, given: Mapping[str, Any]) -> tuple[Vector, Vector]:
        """Contractions and places of all markers at the beginning of an episode [m]."""
        del given
        return np.clip(np.zeros(len(self._low)), self._low, self._high), self.rest

    def _spread_action(self, action: np.ndarray) -> Vector:
        changes = np.zeros(len(self._low))
        for value, group in zip(action.tolist(), self._groups, strict=True):
            changes[group[0]] = value
            if len(group) == 2:
                changes[group[1]] = -value
        return changes

    def _observation(self) -> dict[str, Vector]:
        span = np.where(self._high > self._low, self._high - self._low, 1.0)
        seen = {"sensors": self.backend.read_sensors(self.np_random)} if self.options.sensors else {}
        return seen | {
            "observation": np.clip(2.0 * (self._taken - self._low) / span - 1.0, -1.0, 1.0),
            "achieved_goal": ((self._at - self.rest) / self.unit)[self.seen],
            "desired_goal": ((self._goal - self.rest) / self.unit)[self.seen],
        }

    def _info(self) -> dict[str, Any]:
        far = float(np.linalg.norm((self._at - self._goal)[self.seen].reshape(-1, self._dim), axis=1).mean())
        return {"distance": far, "is_success": far < self.options.tolerance}


def reach_options(given: TaskOptions) -> ReachOptions:
    """Options of the task of reaching, for the command line."""
    own = given.select_given("steps", "tolerance", "markers", "pairs", "incremental", "shaped")
    return ReachOptions(**own)


def _groups(robot: Robot, pairs: Sequence[Sequence[str]]) -> tuple[tuple[int, ...], ...]:
    """Winches moved by one number of the action each (InputError: no such winch, one twice, or no pair)."""
    names = [control.name for control in (*robot.winches, *robot.drives)]
    used: list[int] = []
    for pair in pairs:
        for name in pair:
            if name not in names:
                raise InputError(f"robot {robot.name!r}: unknown winch {quote(name)}. Available: {', '.join(names)}.")
            used.append(names.index(name))
        if len(pair) != 2:
            raise InputError(f"a pair has two winches, not {len(pair)}: {', '.join(pair)}")
    if len(set(used)) < len(used):
        raise InputError("a winch belongs to one pair only")
    paired = [tuple(names.index(name) for name in pair) for pair in pairs]
    return tuple(sorted([*paired, *((index,) for index in range(len(names)) if index not in used)]))


CABLE_FRICTION = 0.2
"""Coefficient mu of cables, where nothing else is said."""


class HysteresisEnv(ReachEnv):
    """`ReachEnv` with path dependence: cables have capstan friction, and an episode begins in a random pose.

    The same contractions reach different poses from different start poses. Slip is not observed: a policy observes only
    the contractions and the marker positions. Goals are the positions that random contractions reach from rest, with
    friction.

    Attributes:
        given: robot as in robot.toml. Training may use networks of it, but their model is wrong without the friction.
    """

    def __init__(
        self,
        robot: Robot | str,
        *,
        friction: float | None = CABLE_FRICTION,
        backend: Backend | None = None,
        options: ReachOptions | None = None,
        contact: bool = False,
        render_mode: str | None = None,
    ) -> None:
        """A robot that reaches.

        Args:
            robot: itself, its folder, or a name such as gallery:cupping_hand.
            friction: coefficient mu of every cable; as in robot.toml if None.
            backend: simulator or networks that compute marker positions; if left out the exact simulator, from pose to
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
            rubs, backend=backend or ExactBackend(rubs, from_rest=False), options=options, render_mode=render_mode
        )

    @property
    def portable(self) -> bool:
        """False: the same contractions reach different poses from different start poses."""
        return False

    @classmethod
    def for_task(cls, robot: Robot | str, given: TaskOptions) -> Self:
        """Create the environment from the options of the command line."""
        given.refuse("actions", "tied", "obstacle")
        more = given.select_given("friction", "contact")
        return cls(robot, options=reach_options(given), **more)

    def sample_episode(self, random: np.random.Generator) -> dict[str, Any] | None:
        """Draw a goal, and the contractions at which the episode begins [m]."""
        goal = super().sample_episode(random)
        return None if goal is None else {**goal, "start": self.anywhere(random)}

    def _check(self, model: LearnedModel) -> None:
        """Check that networks are of the robot as it is given."""
        model.check(self.given)

    def _find_start(self, given: Mapping[str, Any]) -> tuple[Vector, Vector]:
        """The pose of contractions given as "start" [m], come to from rest; rest, where there is none."""
        taken, at = super()._find_start(given)
        start = np.asarray(given.get("start", taken), dtype=float)
        if start.shape != taken.shape:
            raise InputError(f"a start has {len(taken)} contractions, not {start.size}")
        reached = self.backend.reach(start) if start.any() else None
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
