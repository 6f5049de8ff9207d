"""`Trials`: episodes of many copies of a task at once, as `HindsightDdpg` learns in them."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from hydrostat.errors import HydrostatError, InputError
from hydrostat.learning import LearnedModel, answer, tensors_of
from hydrostat.version import install_command

try:
    import torch
    from torch import Tensor
except ModuleNotFoundError as error:
    raise InputError(f"training needs {error.name}; install it: {install_command('rl')}") from None

Begun = tuple[Tensor, Tensor, Tensor]


class Trials(ABC):
    """Copies of a task, side by side; tensors are (seeds, many, size).

    Attributes:
        states: numbers of a state.
        goals: numbers of a goal, and of what is reached.
        actions: numbers of an action, each from -1 to 1.
        horizon: actions of an episode (T).
    """

    states: int
    goals: int
    actions: int
    horizon: int

    @abstractmethod
    def begin(self, draw: torch.Generator, shape: tuple[int, int]) -> Begun:
        """Begin episodes: states, what is reached, goals."""

    def begin_alike(self, draw: torch.Generator, shape: tuple[int, int]) -> Begun:
        """Begin the same episodes for every seed."""
        seeds, many = shape
        states, reached, goals = (part.expand(seeds, -1, -1) for part in self.begin(draw, (1, many)))
        return states, reached, goals

    @abstractmethod
    def act(self, acts: Tensor) -> tuple[Tensor, Tensor]:
        """Do an action in each: states, what is reached."""

    @abstractmethod
    def distances(self, reached: Tensor, goals: Tensor) -> Tensor:
        """Compute the distance between achieved and desired goals, (seeds, many)."""


class NetworkReach(Trials):
    """A robot that brings all its markers to a goal, as a learned model expects it; lengths are in centimeters.

    States and goals are coordinates of the markers, as in the thesis: 15 for a hand. Goals, and where episodes begin if
    they do not at rest, are where evenly drawn actions lead. Actions are contractions, whatever was before (R79).
    """

    def __init__(
        self,
        model: LearnedModel,
        *,
        groups: Sequence[Sequence[int]] = (),
        horizon: int = 1,
        random_start: bool = False,
    ) -> None:
        """A learned model.

        Args:
            model: model that predicts marker positions.
            groups: winches that one number of an action moves, one or two each: above 0 the first takes in cable, below
                0 the second; each winch alone, from its release to its travel, if left out.
            horizon: actions of an episode.
            random_start: True if episodes begin in a random pose.
        """
        self.horizon, self._random = horizon, random_start
        self._dim, self._count = model.card.dim, model.card.coordinates
        self.states = self.goals = self._count
        self._low, self._high = (torch.tensor(part, dtype=torch.float32) for part in (model.low, model.high))
        self._groups = [tuple(group) for group in groups] or [(one,) for one in range(len(model.low))]
        self._coupled = any(len(group) == 2 for group in self._groups)
        self.actions = len(self._groups)
        self._networks = tensors_of(model.forward)
        self._middle, self._unit = (
            torch.tensor(100.0 * part[: self._count], dtype=torch.float32) for part in (model.middle, model.unit)
        )
        zero = torch.zeros(1, 1, len(model.low)).clamp(self._low, self._high)
        self.rest = self.places(zero)[0, 0]

    def begin(self, draw: torch.Generator, shape: tuple[int, int]) -> Begun:
        """Begin at rest, or anywhere."""
        goals, starts = self.draw_acts(draw, shape)
        states = self.rest.expand(*shape, -1) if starts is None else self.reach(starts)
        return states, states, self.reach(goals)

    def draw_acts(self, draw: torch.Generator, shape: tuple[int, int]) -> tuple[Tensor, Tensor | None]:
        """Draw the actions that lead to goals, and those that lead to starts (None: at rest)."""
        goals = 2.0 * torch.rand(*shape, self.actions, generator=draw) - 1.0
        return goals, 2.0 * torch.rand(*shape, self.actions, generator=draw) - 1.0 if self._random else None

    def act(self, acts: Tensor) -> tuple[Tensor, Tensor]:
        """Return the marker positions for contractions."""
        reached = self.reach(acts)
        return reached, reached

    def distances(self, reached: Tensor, goals: Tensor) -> Tensor:
        """Mean distance of the markers [cm] (E45: a distance, not its square)."""
        return (reached - goals).unflatten(-1, (-1, self._dim)).norm(dim=-1).mean(-1)

    def reach(self, acts: Tensor) -> Tensor:
        """Coordinates of the markers [cm] after actions."""
        with torch.no_grad():
            return self.places(self.contractions(acts))

    def contractions(self, acts: Tensor) -> Tensor:
        """Contractions [m] of actions."""
        taken = torch.zeros(*acts.shape[:-1], len(self._low))
        for number, group in enumerate(self._groups):
            one, value = group[0], acts[..., number]
            if len(group) == 2:
                other = group[1]
                taken[..., one] = value.clamp(min=0.0) * self._high[one]
                taken[..., other] = (-value).clamp(min=0.0) * self._high[other]
            else:
                low = self._low[one].clamp(min=0.0) if self._coupled else self._low[one]
                taken[..., one] = low + 0.5 * (value + 1.0) * (self._high[one] - low)
        return taken

    def places(self, taken: Tensor) -> Tensor:
        """Coordinates of the markers [cm] at contractions [m]; with slopes, where they are asked for."""
        span = torch.where(self._high > self._low, self._high - self._low, torch.ones(()))
        scaled = (2.0 * (taken - self._low) / span - 1.0).flatten(0, -2)
        members = len(self._networks[0])
        value = answer(self._networks, scaled.expand(members, -1, -1), None)[0].mean(0)
        return (self._middle + self._unit * value[:, : self._count]).unflatten(0, taken.shape[:-1])


class GymnasiumTrials(Trials):
    """A goal-based environment of gymnasium-robotics, such as FetchReach, one copy for each episode.

    Its numbers are as gymnasium gives them, lengths in meters. It is for reference: our method in tasks of others.
    """

    def __init__(self, make: Callable[[], Any], *, horizon: int) -> None:
        """Wrap copies of an environment from `make`, such as `robotics_task`; each ends after `horizon` actions."""
        self.horizon, self._make, self._envs = horizon, make, [make()]
        spaces = self._envs[0].observation_space
        self.states, self.goals = spaces["observation"].shape[0], spaces["desired_goal"].shape[0]
        self.actions = self._envs[0].action_space.shape[0]

    def begin(self, draw: torch.Generator, shape: tuple[int, int]) -> Begun:
        """Begin an episode in each."""
        return self._begin(torch.randint(_SEEDS, shape, generator=draw))

    def begin_alike(self, draw: torch.Generator, shape: tuple[int, int]) -> Begun:
        """Begin the same episodes for every seed, each in a copy of its own."""
        return self._begin(torch.randint(_SEEDS, (1, shape[1]), generator=draw).expand(shape))

    def act(self, acts: Tensor) -> tuple[Tensor, Tensor]:
        """Do a step of each."""
        rows = acts.flatten(0, 1).numpy()
        seen = [env.step(row)[0] for env, row in zip(self._envs, rows, strict=False)]
        return self._gather(seen, "observation", acts.shape), self._gather(seen, "achieved_goal", acts.shape)

    def distances(self, reached: Tensor, goals: Tensor) -> Tensor:
        """Norms of what is missed [m], which is the tasks' own measure."""
        return (reached - goals).norm(dim=-1)

    def _begin(self, seeds: Tensor) -> Begun:
        self._envs += [self._make() for _ in range(seeds.numel() - len(self._envs))]
        rows = zip(self._envs, seeds.flatten().tolist(), strict=False)
        seen = [env.reset(seed=seed)[0] for env, seed in rows]
        states, reached, goals = (
            self._gather(seen, name, seeds.shape) for name in ("observation", "achieved_goal", "desired_goal")
        )
        return states, reached, goals

    @staticmethod
    def _gather(seen: Sequence[Mapping[str, np.ndarray]], name: str, shape: Sequence[int]) -> Tensor:
        rows = torch.tensor(np.array([each[name] for each in seen]), dtype=torch.float32)
        return rows.unflatten(0, tuple(shape[:2]))


def robotics_task(name: str, horizon: int) -> Any:
    """Make an environment of gymnasium-robotics by its name.

    Raises:
        HydrostatError: it is not installed, or no MuJoCo that it runs with.
    """
    try:
        import gymnasium
        import gymnasium_robotics  # pyright: ignore[reportMissingImports]
    except ModuleNotFoundError as error:
        raise HydrostatError(f"{name} needs {error.name}; install it: {_ROBOTICS}") from None
    gymnasium.register_envs(gymnasium_robotics)
    try:
        return gymnasium.make(name, max_episode_steps=horizon)
    except AssertionError:
        told = f"{name} does not run with the MuJoCo that is installed; install one that it runs with: {_ROBOTICS}"
        raise HydrostatError(told) from None


_SEEDS = 2**31
"""Environments are begun with seeds below this."""

_ROBOTICS = 'pip install gymnasium-robotics "mujoco<3.6"'
"""Versions that were tried: gymnasium-robotics 1.4.2 with MuJoCo 3.3 and 3.5; it does not run with 3.17 and 4.0."""
