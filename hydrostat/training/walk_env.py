"""`WalkEnv`: a robot that nothing holds goes a way along the ground (gymnasium, goal-based)."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Self

import numpy as np
from gymnasium import spaces

from hydrostat.arrays import Vector
from hydrostat.closed_set import make_member
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.robot import ObstacleShape, Robot
from hydrostat.simulation import Motion, Simulation, StepOptions
from hydrostat.training.goal_env import AN_ACTION, GoalEnv, TaskOptions, check_task, finite_numbers, prepare_robot
from hydrostat.training.ground import standing, tilt, with_friction

MIN_PERIOD, MAX_PERIOD = 0.3, 2.0
"""Periods of gaits that an action can ask for [s]."""


@dataclass(frozen=True, kw_only=True)
class Gait:
    """Gait of raised cosines, with a phase lag from winch to winch.

    Attributes:
        amplitude: largest contraction of each winch [m].
        lag: lag of each winch behind the previous one, in cycles.
        period: duration of a cycle [s].
    """

    amplitude: float
    lag: float
    period: float

    @classmethod
    def of_action(cls, action: np.ndarray, most: float) -> "Gait":
        """Return the gait of three values from -1 to 1: amplitude from 0 to `most` [m], lag to half a cycle, period."""
        size, lag, period = np.clip(np.asarray(action, dtype=float), -1.0, 1.0).tolist()
        return cls(amplitude=0.5 * (size + 1.0) * most, lag=0.5 * lag, period=_MIDDLE + _HALF * period)

    def action(self, most: float) -> Vector:
        """Return the action of this gait; the inverse of `of_action`."""
        return np.array([2.0 * self.amplitude / most - 1.0, 2.0 * self.lag, (self.period - _MIDDLE) / _HALF])


class GaitClock:
    """Phase of winches within a gait.

    Attributes:
        phase: cycles since the beginning.
        amplitude: present amplitude [m].
        lag: present lag, in cycles.
    """

    def __init__(self, winches: int, most: float) -> None:
        """Begin with nothing taken in; in a period amplitudes change by `most` [m] at most, lags by half a cycle."""
        self.phase = self.amplitude = self.lag = 0.0
        self._order, self._most = np.arange(winches), most

    def after(self, gait: Gait, dt: float) -> Vector:
        """Contractions [m] after a time [s] of a gait."""
        share = dt / gait.period
        self.phase += share
        if self.amplitude == 0.0:
            self.lag = gait.lag
        self.lag += float(np.clip(gait.lag - self.lag, -0.5 * share, 0.5 * share))
        change = self._most * share
        self.amplitude += float(np.clip(gait.amplitude - self.amplitude, -change, change))
        return self.amplitude * 0.5 * (1.0 - np.cos(2.0 * np.pi * (self.phase - self.lag * self._order)))


_MIDDLE, _HALF = 0.5 * (MAX_PERIOD + MIN_PERIOD), 0.5 * (MAX_PERIOD - MIN_PERIOD)


STEP = 0.02
"""A time step [s]."""

MAX_TILT = np.deg2rad(20.0)
"""A body that has turned further has fallen [rad]."""


class WalkActions(StrEnum):
    """Meaning of an action."""

    GAIT = "gait"
    CONTRACTIONS = "contractions"


BEATS: Mapping[WalkActions, int] = {WalkActions.GAIT: 25, WalkActions.CONTRACTIONS: 5}
"""Time steps of an action: half a second of a gait, a tenth of a second to contractions."""


@dataclass(frozen=True, kw_only=True)
class WalkOptions:
    """Options for the walking task.

    Attributes:
        actions: a member of `WalkActions`, or its value.
        steps: number of actions in an episode (T); None for five seconds of actions.
        incremental: True if an action changes the contractions, by at most a third of the range; not for gaits.
        speed: maximum distance of a goal divided by the duration of an episode, in body sizes per second.
        spread: largest relative deviation of an episode's friction from that of the ground, up or down.
        tolerance: largest displacement error of a success [m].
        shaped: True for a reward of minus the distance in units of the tolerance; False for 0 on success, else -1.

    Raises:
        InputError: unknown actions, an incremental gait, or a value out of range.
    """

    actions: WalkActions | str = WalkActions.GAIT
    steps: int | None = None
    incremental: bool = False
    speed: float = 0.1
    spread: float = 0.3
    tolerance: float = 20e-3
    shaped: bool = True

    def __post_init__(self) -> None:
        make_member(self, "actions", WalkActions)
        if self.incremental and self.actions is WalkActions.GAIT:
            raise InputError("a gait is not incremental: have contractions as actions, or leave it out")
        check_task(self)
        if not 0 <= self.spread < 1:
            raise InputError(f"spread must be from 0 to below 1, not {self.spread:g}")
        for name in ("speed", "tolerance"):
            if not 0 < getattr(self, name) < np.inf:
                raise InputError(f"{name} must be above 0, not {getattr(self, name):g}")


class WalkEnv(GoalEnv):
    """Goal-based dynamic environment: an upright robot without pins walks a distance in x on the ground.

    The achieved goal is the displacement of the center of mass in body sizes, and a fall (1 if the robot has fallen,
    else 0); the desired goal is a displacement without a fall. A fall counts as one more body size and stops the
    motion. Ground friction is drawn for each episode and not observed.

    An observation has the contractions (from -1 to 1), marker positions relative to the center of mass, minus those at
    rest, in body sizes, and marker velocities in body sizes per second. For a gait it also has sine and cosine of the
    phase, amplitude and lag.

    Attributes:
        robot: robot on the ground.
        options: options of the task.
        friction: mean friction coefficient of the ground; each episode draws a value near it.
        most: largest contraction of each winch: half of the smallest travel [m].
        motion: current motion; None before the first episode.
    """

    cost = "time steps"

    def __init__(
        self,
        robot: Robot | str,
        *,
        friction: float | None = None,
        options: WalkOptions | None = None,
        render_mode: str | None = None,
    ) -> None:
        """A robot that walks.

        Args:
            robot: itself, its folder, or a name such as gallery:puppy; its pins are taken away.
            friction: Coulomb's coefficient of the ground; as in robot.toml if None, or 0.6 if that has no ground.
            options: options of the task.
            render_mode: "rgb_array", "human" or None.

        Raises:
            InputError: a robot without winches or markers, or what `standing` refuses.
        """
        self.robot = standing(prepare_robot(robot), friction)
        self.options, self.render_mode = options or WalkOptions(), render_mode
        count, marks = len(self.robot.winches), len(self.robot.markers)
        if not count or not marks:
            raise InputError(f"robot {self.robot.name!r} needs a winch to be moved by and a marker to be looked at")
        planes = [obstacle for obstacle in self.robot.obstacles if obstacle.shape is ObstacleShape.PLANE]
        self.friction = planes[0].friction or 0.0
        self.most = 0.5 * min(winch.travel for winch in self.robot.winches)
        mesh, by_gait = self.robot.body.mesh, self.options.actions is WalkActions.GAIT
        self.unit, self.tolerance = mesh.size, self.options.tolerance
        self.beat = BEATS[WalkActions(self.options.actions)]
        seconds = 5.0  # Default duration of an episode [s]
        self.steps = self.options.steps or round(seconds / (self.beat * STEP))
        self.action_space = spaces.Box(-1.0, 1.0, (3 if by_gait else count,), np.float32)
        seen = count + 2 * marks * mesh.dim + (4 if by_gait else 0)
        goal = spaces.Box(-_OBSERVATION_BOUND, _OBSERVATION_BOUND, (2,), np.float64)
        body = spaces.Box(-_OBSERVATION_BOUND, _OBSERVATION_BOUND, (seen,), np.float64)
        self.observation_space = spaces.Dict(observation=body, achieved_goal=goal, desired_goal=goal)
        self._simulation, self.motion = Simulation(self.robot), None
        self._masses = self._simulation.body.masses / self._simulation.body.masses.sum()
        self._made, self._wanted, self._fallen, self._pictures = 0, 0.0, False, None
        self._clock = GaitClock(count, self.most)

    motion: Motion | None

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, Vector], dict[str, Any]]:
        """Return to the start pose with a new distance and friction; or with "goal" [m] and "friction" of `options`."""
        super().reset(seed=seed)
        given = {**self.sample_episode(self.np_random), **(options or {})}
        wanted = finite_numbers(given["goal"], 1, "a goal", "way [m]")
        self._wanted, self._fallen, self.taken_steps = float(wanted[0]), False, 0
        self._simulation = Simulation(with_friction(self.robot, float(given["friction"])))
        self._given = float(given["friction"])
        self.motion = self._simulation.motion_at_rest()
        self.moves = [(0.0, self.motion.contractions)]
        self._clock = GaitClock(len(self.robot.winches), self.most)
        self.show()
        return self._observation(), self._info()

    def step(self, action: np.ndarray) -> tuple[dict[str, Vector], float, bool, bool, dict[str, Any]]:
        """Simulate the time steps of an action; the episode ends after its last action."""
        action = finite_numbers(action, int(np.prod(self.action_space.shape or (0,))), *AN_ACTION)
        self.taken_steps += 1
        for contractions in self._step_contractions(np.clip(action, -1.0, 1.0)):
            if self._fallen:
                break
            self._advance(contractions)
        self.show()
        observation, info = self._observation(), self._info()
        reward = float(self.compute_reward(observation["achieved_goal"], observation["desired_goal"], info))
        return observation, reward, False, self.taken_steps >= self.steps, info

    def compute_reward(self, achieved: np.ndarray, desired: np.ndarray, info: Any) -> float | np.ndarray:
        """Return the reward of achieved and desired goals, for one or for each row; it depends on nothing else."""
        del info
        far = self.distances(achieved, desired)
        tolerance = self.options.tolerance
        return -far / tolerance if self.options.shaped else -np.asarray(far >= tolerance, dtype=float)

    def distances(self, achieved: np.ndarray, desired: np.ndarray) -> float | np.ndarray:
        """Return displacement errors [m], for one goal or for each row; a fall counts as one body size."""
        return self.unit * np.abs(np.asarray(achieved) - np.asarray(desired)).sum(axis=-1)

    @classmethod
    def for_task(cls, robot: Robot | str, given: TaskOptions) -> Self:
        """Create the environment from the options of the command line."""
        given.refuse("markers", "pairs", "contact", "tied", "obstacle")
        options = WalkOptions(**given.select_given("actions", "steps", "incremental", "tolerance", "shaped"))
        return cls(robot, friction=given.friction, options=options)

    @property
    def equilibria(self) -> int:
        """Number of time steps that the simulator was asked to solve, each with the same cost."""
        return self._made

    def sample_episode(self, random: np.random.Generator) -> dict[str, Any]:
        """Draw a distance up to the maximum [m], and the ground friction."""
        longest = self.options.speed * self.unit * self.steps * self.beat * STEP
        share = self.options.spread * random.uniform(-1.0, 1.0)
        return {"goal": [random.uniform(0.0, longest)], "friction": self.friction * (1.0 + share)}

    def go_on(self, kept: Mapping[str, Any]) -> None:
        """Restore a saved state and continue with the next episode."""
        super().go_on(kept)
        self._made = kept["equilibria"]

    def picture(self) -> np.ndarray | None:
        """Return a picture of the robot, with the ground moving below it; None before the first episode."""
        if self.motion is None:
            return None
        from hydrostat.training.env_pictures import WalkPictures

        if self._pictures is None:
            self._pictures = WalkPictures(self.robot, self.most)
        way, wanted = 1e3 * self.way, 1e3 * self._wanted
        words = f"{self.motion.time:.1f} s, {way:.0f} of {wanted:.0f} mm" + (", fallen" if self._fallen else "")
        return self._pictures.draw(self.motion, self.way, words)

    @property
    def way(self) -> float:
        """Displacement of the center of mass in x since the start of the episode [m]."""
        return float((self._masses @ (self._now.nodes - self.robot.body.mesh.nodes))[0])

    @property
    def _now(self) -> Motion:
        assert self.motion is not None, "an episode begins with reset"
        return self.motion

    def _step_contractions(self, action: Vector) -> list[Vector]:
        """Contractions at the end of each time step of an action [m]."""
        if self.options.actions is WalkActions.GAIT:
            gait = Gait.of_action(action, self.most)
            return [self._clock.after(gait, STEP) for _ in range(self.beat)]
        begin = self._now.contractions
        change = self.most / 3.0 * action if self.options.incremental else 0.5 * self.most * (action + 1.0) - begin
        end = np.clip(begin + change, 0.0, self.most)
        return [begin + share * (end - begin) for share in (np.arange(self.beat) + 1.0) / self.beat]

    def _advance(self, contractions: Vector) -> None:
        """Make a time step; a robot that tilts too far has fallen, as has one of which no step is found."""
        self._made += 1
        try:
            self.motion = self._simulation.step(self._now, contractions, STEP, options=StepOptions(scheme="euler"))
        except NotConvergedError:
            self._fallen = True
            return
        self.moves.append((self.motion.time, contractions))
        masses = self._simulation.body.masses
        self._fallen = bool(tilt(masses, self.robot.body.mesh.nodes, self.motion.nodes) > MAX_TILT)

    def _observation(self) -> dict[str, Vector]:
        motion, anchors, rest = self._now, self._simulation.marker_anchors, self.robot.body.mesh.nodes
        moved = motion.nodes - rest
        places = (anchors.positions(moved) - self._masses @ moved) / self.unit
        speeds = anchors.positions(motion.velocities) / self.unit
        parts = [2.0 * motion.contractions / self.most - 1.0, places.ravel(), speeds.ravel()]
        if self.options.actions is WalkActions.GAIT:
            clock, turn = self._clock, 2.0 * np.pi * self._clock.phase
            parts.append(np.array([np.sin(turn), np.cos(turn), clock.amplitude / self.most, 2.0 * clock.lag]))
        return {
            "observation": np.clip(np.concatenate(parts), -_OBSERVATION_BOUND, _OBSERVATION_BOUND),
            "achieved_goal": np.clip(
                [self.way / self.unit, float(self._fallen)], -_OBSERVATION_BOUND, _OBSERVATION_BOUND
            ),
            "desired_goal": np.array([self._wanted / self.unit, 0.0]),
        }

    def _info(self) -> dict[str, Any]:
        far = self.unit * (abs(self.way - self._wanted) / self.unit + float(self._fallen))
        return {
            "distance": far,
            "is_success": far < self.tolerance,
            "way": self.way,
            "fallen": self._fallen,
            "friction": self._given,
        }


_OBSERVATION_BOUND = 100.0
"""Bound of what is observed."""
