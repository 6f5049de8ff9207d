"""`GoalEnv`: what training asks of an environment, whatever the task."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self

import gymnasium
import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.given import check_number
from hydrostat.learning import LearnedModel
from hydrostat.robot import Contact, Obstacle, Robot, load_robot

if TYPE_CHECKING:
    from hydrostat.plot import LivePage


@dataclass(frozen=True, kw_only=True)
class TaskOptions:
    """Options of a task by name; None keeps the default of the task.

    Attributes:
        markers: markers that have goals; all if empty.
        pairs: antagonistic pairs of winches, each moved by one component of the action.
        steps: number of actions in an episode (T).
        incremental: True if an action changes the contractions.
        tolerance: largest distance of a success [m].
        shaped: True for a reward of minus the distance in units of the tolerance; False for 0 on success, else -1.
        contact: True to add self-contact if robot.toml does not set contact.
        friction: friction coefficient of the cables, object or ground, by task.
        actions: kind of actions, by a name that the task defines.
        tied: parts of winch names; winches whose names share a part are moved by one component of the action.
        obstacle: object to move; the robot's own if None.
    """

    markers: Sequence[str] = ()
    pairs: Sequence[Sequence[str]] = ()
    steps: int | None = None
    incremental: bool = False
    tolerance: float | None = None
    shaped: bool = True
    contact: bool = False
    friction: float | None = None
    actions: str | None = None
    tied: Sequence[str] = ()
    obstacle: Obstacle | None = None

    def select_given(self, *names: str) -> dict[str, Any]:
        """Return those of these attributes that are not None, by name."""
        return {name: value for name in names if (value := getattr(self, name)) is not None}

    def refuse(self, *names: str) -> None:
        """Reject options that a task does not have (InputError: one of these attributes is set)."""
        for name in names:
            if getattr(self, name) not in (None, False, (), []):
                raise InputError(f"this task has no {name}: leave it out")


def check_task(options: Any) -> None:
    """Reject options of a task whose steps are no count, or whose numbers are none, such as "5 mm" (InputError)."""
    steps = options.steps
    if steps is not None and not (isinstance(steps, int | np.integer) and steps >= 1):
        raise InputError(f"steps must be 1 or more, not {steps!r:.60}")
    for each in fields(options):
        value = getattr(options, each.name)
        if value is not None and each.type in (float, float | None):
            check_number(each.name, value, "")


class GoalEnv(gymnasium.Env, ABC):
    """Goal-based environment with episodes of a fixed number of actions, as `train` and `judge` use it.

    Attributes:
        cost: unit of `equilibria`, in a word or two.
        measure: the word for what distances are told in, and how many of it are in their unit.
        robot: robot of the task.
        unit: unit of what observations count in: a size of the body [m], half a turn [rad].
        steps: actions in an episode (T).
        tolerance: largest distance that is a success, in the unit of the task, [m] or [rad].
        taken_steps: actions of this episode until now.
        uncounted: part of `equilibria` that judged a policy: no cost of learning it.
        moves: commands of this episode until now: times [s] with contractions [m], as motors would get them.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["human", "rgb_array"], "render_fps": 4}  # type: ignore[misc]
    cost: ClassVar[str] = "equilibria"
    measure: ClassVar[tuple[str, float]] = ("mm", 1e3)
    robot: Robot
    unit: float
    steps: int
    tolerance: float
    taken_steps: int = 0
    uncounted: int = 0
    moves: list[tuple[float, Vector]]
    _page: "LivePage | None" = None

    @classmethod
    @abstractmethod
    def for_task(cls, robot: Robot | str, given: TaskOptions) -> Self:
        """Make one from what is asked on the command line (InputError: something that the task does not have)."""

    @property
    @abstractmethod
    def equilibria(self) -> int:
        """Number of solves of the exact simulator, those of judgements included (see `cost`)."""

    @property
    def portable(self) -> bool:
        """True if a policy needs to see nothing but the goal."""
        return False

    @abstractmethod
    def sample_episode(self, random: np.random.Generator) -> dict[str, Any] | None:
        """Draw an episode at random: `options` for `reset`; None where it has no equilibrium."""

    @abstractmethod
    def compute_reward(self, achieved: np.ndarray, desired: np.ndarray, info: Any) -> float | np.ndarray:
        """Reward of what is achieved for what is desired, one or a row each; nothing else decides about it."""

    def learn_in(self, model: LearnedModel, *, exact: int = 0) -> None:
        """Ask networks in place of the simulator, and the simulator in every so many episodes (InputError: cannot)."""
        del model, exact
        raise InputError("this task is not one of equilibria that networks know: learn it in the simulator")

    def compute_terminated(self, achieved: np.ndarray, desired: np.ndarray, info: Any) -> np.ndarray:
        """True if an episode has come to its end: never before its steps."""
        return np.zeros(np.shape(achieved)[:-1], dtype=bool)

    def compute_truncated(self, achieved: np.ndarray, desired: np.ndarray, info: Any) -> np.ndarray:
        """True if an episode is cut off here."""
        return np.full(np.shape(achieved)[:-1], self.taken_steps >= self.steps)

    def picture(self) -> np.ndarray | None:
        """Picture of the present state, (height, width, 3), bytes, always of one size; None if there is none."""
        return None

    def render(self) -> np.ndarray | None:
        """The picture of now in the mode "rgb_array"; None in others: what is for a human is on a page already."""
        return self.picture() if self.render_mode == "rgb_array" else None

    def show(self) -> None:
        """Show the picture of now in the browser, in the mode "human"; done at the end of each reset and step."""
        if self.render_mode == "human":
            picture = self.picture()
            if picture is not None:
                self.page.show(picture)

    @property
    def page(self) -> "LivePage":
        """The page of this machine on which a human sees it; the first picture opens the browser."""
        from hydrostat.plot import LivePage

        if self._page is None:
            self._page = LivePage(f"{self.robot.name}: {type(self).__name__}")
        return self._page

    def close(self) -> None:
        """End the page, if there is one."""
        if self._page is not None:
            self._page.close()

    def get_state(self) -> dict[str, Any]:
        """State that the next episode depends on, and its cost until now."""
        return {
            "random": self.np_random.bit_generator.state,
            "equilibria": self.equilibria,
            "uncounted": self.uncounted,
        }

    def go_on(self, kept: Mapping[str, Any]) -> None:
        """Go on, from the next episode, where an environment was that has been kept."""
        self.np_random.bit_generator.state = kept["random"]
        self.uncounted = kept["uncounted"]


def prepare_robot(robot: Robot | str, contact: bool = False) -> Robot:
    """A robot, itself or from its folder; with self-contact if requested and not set in robot.toml."""
    made = robot if isinstance(robot, Robot) else load_robot(robot)
    return replace(made, contact=Contact()) if contact and made.contact is None else made


def finite_numbers(given: object, count: int, what: str, which: str) -> Vector:
    """Vector of finite numbers of a given length (InputError: anything else)."""
    try:
        found = np.asarray(given, dtype=float).ravel()
    except (TypeError, ValueError):
        found = np.zeros(0)
    if len(found) != count or not np.isfinite(found).all():
        raise InputError(f"{what} has {count} {which}, not {given!r:.60}")
    return found


AN_ACTION = ("an action", "numbers from -1 to 1")
"""Words of `finite_numbers` for an action."""
