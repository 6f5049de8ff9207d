"""`HindsightDdpg`: DDPG with hindsight experience replay as it was first published, several seeds at once.

The method of Plappert et al. 2018 (arXiv 1802.09464), which the thesis begins from (R74): critics' targets cut off at
what a return can be, a penalty on actions, running means of what is observed, targets that follow once a cycle. No
library that is kept today has these. Seeds are trained side by side: ten small networks cost little more than one.
"""

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.version import install_command
from hydrostat_lab.curriculum import MASTERED, Curriculum
from hydrostat_lab.trials import Trials

try:
    import torch
    from torch import Tensor

    from hydrostat_lab.running import Running
except ModuleNotFoundError as error:
    raise InputError(f"training needs {error.name}; install it: {install_command('rl')}") from None


@dataclass(frozen=True, kw_only=True)
class DdpgOptions:
    """Settings of the method; those of Plappert et al. where nothing else is said.

    Attributes:
        layers: hidden layers of actor and critic, with ReLU.
        actor_rate: learning rate of Adam for the actor.
        critic_rate: learning rate of Adam for the critic.
        polyak: share of the targets' numbers that stays at each cycle.
        penalty: on the mean square of actions, beside the critic's value.
        cut: True if targets are cut to [-1 / (1 - gamma), 0].
        random: probability of an action drawn evenly.
        noise: standard deviation of what is added to other actions, of a range from -1 to 1.
        relabelled: goals taken from what came later, for each that was wanted ("future").
        cycles: cycles of an epoch.
        actions: actions of a cycle; roll-outs are as many as fill it.
        updates: updates of a cycle.
        batch: transitions of an update.
        shaped: reward is minus the distance in the unit of the trials; else 0 for success and -1.
        tolerance: distance that is a success at the beginning, in the unit of the trials.
        curriculum: schedule of the tolerance.
        late_critic_rate: learning rate of the critic from the first change of the tolerance on; None: as before.
        reset_adam: True if Adam counts its steps from 0 again, for all seeds, whenever one changes its tolerance.
        goal_only: True if networks see the goal alone, and not the state.

    Raises:
        InputError: a number that cannot be.
    """

    layers: tuple[int, ...] = (256, 256, 256)
    actor_rate: float = 1e-3
    critic_rate: float = 1e-3
    polyak: float = 0.95
    penalty: float = 1.0
    cut: bool = True
    random: float = 0.3
    noise: float = 0.2
    relabelled: int = 4
    cycles: int = 50
    actions: int = 10
    updates: int = 40
    batch: int = 256
    shaped: bool = False
    tolerance: float = 1.0
    curriculum: Curriculum = Curriculum.FIXED
    late_critic_rate: float | None = None
    reset_adam: bool = False
    goal_only: bool = False

    def __post_init__(self) -> None:
        for name in ("relabelled", "cycles", "actions", "updates", "batch"):
            if getattr(self, name) < 1:
                raise InputError(f"{name} must be 1 or more, not {getattr(self, name)}")
        for name in ("random", "noise", "polyak"):
            if not 0 <= getattr(self, name) <= 1:
                raise InputError(f"{name} must be from 0 to 1, not {getattr(self, name):g}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Epochs:
    """Learning curves of all seeds; an array each, (epochs, seeds).

    Attributes:
        actions: taken by the end of each epoch, (epochs,).
        success: share of the tests whose last distance is below the tolerance then.
        distance: mean last distance of the tests.
        tolerance: during the epoch.
    """

    actions: np.ndarray
    success: np.ndarray
    distance: np.ndarray
    tolerance: np.ndarray


def discount(horizon: int) -> float:
    """The discount of rewards for episodes of so many actions, 1 - 1 / T."""
    return 1.0 - 1.0 / horizon


def cut_targets(targets: Tensor, gamma: float) -> Tensor:
    """Targets of a critic cut to what a return of rewards from -1 to 0 can be, [-1 / (1 - gamma), 0]."""
    return targets.clamp(-1.0 / (1.0 - gamma), 0.0)


def hindsight(later: Tensor, share: float, draw: torch.Generator) -> Tensor:
    """Steps whose outcome becomes the goal, of steps that came; -1 where the goal stays.

    Args:
        later: number of steps of the episode that are left from each on, that one included; 1 or more.
        share: share of transitions that get another goal.
        draw: source of chance.

    Returns:
        0 for the step itself, up to `later` - 1 for the last; as many as were given.
    """
    ahead = (torch.rand(later.shape, generator=draw) * later).long()
    keep = torch.rand(later.shape, generator=draw) >= share
    return torch.where(keep, -torch.ones_like(ahead), ahead)


def rewards(distance: Tensor, tolerance: Tensor, *, shaped: bool) -> Tensor:
    """Rewards of distances: 0 for success and -1 else, or minus the distance."""
    return -distance if shaped else -(distance >= tolerance).float()


@dataclass(eq=False)
class Policy:
    """Actors of all seeds, with what they need to see: calls give actions of states and goals, (seeds, many, size)."""

    numbers: list[Tensor]
    states: Running
    goals: Running
    goal_only: bool

    def __call__(self, states: Tensor, goals: Tensor) -> Tensor:
        """Actions from -1 to 1."""
        return torch.tanh(apply_layers(self.numbers, self.see(states, goals)))

    def see(self, states: Tensor, goals: Tensor) -> Tensor:
        """Return the input of the networks."""
        seen = self.goals(goals)
        return seen if self.goal_only else torch.cat([self.states(states), seen], -1)

    def copy_policy(self) -> "Policy":
        """A copy that does not change any more."""
        numbers = [part.detach().clone() for part in self.numbers]
        return Policy(numbers, copy.deepcopy(self.states), copy.deepcopy(self.goals), self.goal_only)


class HindsightDdpg:
    """Actors and critics of several seeds, the replay buffer, and how they learn.

    Attributes:
        trials: episodes to learn in.
        options: options of the method.
        policy: present policy.
        best: policy when the tests' mean distance was least, for each seed.
        tolerance: present tolerance of each seed.
    """

    def __init__(
        self, trials: Trials, options: DdpgOptions, *, seeds: int, epochs: int, seed: int = 0, room: int = 0
    ) -> None:
        """Networks at random, and an empty buffer for so many epochs and room for more episodes."""
        torch.set_num_threads(1)
        torch.set_flush_denormal(True)  # numbers that fade to nothing would take a hundred times as long
        self.trials, self.options, self._seeds, self._epochs = trials, options, seeds, epochs
        self._draw = torch.Generator().manual_seed(seed)
        self._gamma = discount(trials.horizon)
        wide = trials.goals if options.goal_only else trials.states + trials.goals
        self.policy = Policy(
            _glorot([wide, *options.layers, trials.actions], seeds, self._draw),
            Running(seeds, trials.states),
            Running(seeds, trials.goals),
            options.goal_only,
        )
        self._critic = _glorot([wide + trials.actions, *options.layers, 1], seeds, self._draw)
        self._followers = [[part.detach().clone() for part in some] for some in (self.policy.numbers, self._critic)]
        self._actor_adam = torch.optim.Adam(self.policy.numbers, lr=options.actor_rate, fused=True)
        self._critic_adam = torch.optim.Adam(self._critic, lr=options.critic_rate, fused=True)
        self._rollouts = max(1, options.actions // trials.horizon)
        shape = (seeds, epochs * options.cycles * self._rollouts + room)
        t = trials.horizon
        self._states, self._reached = (
            torch.zeros(*shape, t + 1, trials.states),
            torch.zeros(*shape, t + 1, trials.goals),
        )
        self._goals, self._acts = torch.zeros(*shape, trials.goals), torch.zeros(*shape, t, trials.actions)
        self._filled, self._taken = 0, 0
        self.tolerance = torch.full((seeds, 1), options.tolerance)
        self.best, self._least = self.policy.copy_policy(), np.full(seeds, np.inf)
        self._rows: list[tuple[int, np.ndarray, np.ndarray, np.ndarray]] = []

    @property
    def tried(self) -> tuple[np.ndarray, np.ndarray]:
        """Actions that were taken, and what they reached; (seeds, many, size) each, in their order."""
        acts, reached = self._acts[:, : self._filled], self._reached[:, : self._filled, 1:]
        return acts.flatten(1, 2).numpy(), reached.flatten(1, 2).numpy()

    def fill(self, acts: Tensor, reached: Tensor) -> None:
        """Put episodes of one action into the buffer, with what they reached as their goals; (seeds, many, size)."""
        many = acts.shape[1]
        states, _, _ = self.trials.begin(self._draw, (self._seeds, many))
        room = slice(self._filled, self._filled + many)
        self._states[:, room, 0], self._states[:, room, 1] = states, reached
        self._reached[:, room, 0], self._reached[:, room, 1] = states, reached
        self._goals[:, room], self._acts[:, room, 0] = reached, acts
        self._filled += many

    def learn(self, *, tests: int = 100, progress: Callable[[int, int], Any] = lambda *_: None) -> Epochs:
        """Learn for all epochs, and test after each without exploration.

        Args:
            tests: episodes of a test, the same each time.
            progress: called with the number of epochs that are done, and of all.
        """
        while len(self._rows) < self._epochs:
            self._learn_epoch(tests)
            progress(len(self._rows), self._epochs)
        actions, success, distance, tolerance = (np.array(column) for column in zip(*self._rows, strict=True))
        return Epochs(actions=actions, success=success, distance=distance, tolerance=tolerance)

    @property
    def latest(self) -> tuple[int, np.ndarray, np.ndarray, np.ndarray]:
        """Actions taken, and success, distance and tolerance of each seed, in the latest epoch."""
        return self._rows[-1]

    @property
    def has_mastered(self) -> bool:
        """True if a seed mastered its tolerance in the latest epoch."""
        return bool(self._rows) and bool((self._rows[-1][1] >= MASTERED).any())

    def learn_first(self, *, tests: int = 100, progress: Callable[[int, int], Any] = lambda *_: None) -> None:
        """Learn until a seed masters its tolerance, at most for all epochs; `branch` goes on from there."""
        while len(self._rows) < self._epochs and not self.has_mastered:
            self._learn_epoch(tests)
            progress(len(self._rows), self._epochs)

    def branch(self, options: DdpgOptions, *, more: int) -> "HindsightDdpg":
        """Copy the learner for more epochs, with options that matter from the first mastered tolerance on only."""
        other = copy.deepcopy(self)
        other.options, other._epochs = options, len(self._rows) + more
        room = more * options.cycles * self._rollouts
        for name in ("_states", "_reached", "_goals", "_acts"):
            kept = getattr(self, name)[:, : self._filled]
            setattr(other, name, torch.cat([kept, torch.zeros(len(kept), room, *kept.shape[2:])], 1))
        other._go_on(*self.latest[1:3])
        return other

    def _learn_epoch(self, tests: int) -> None:
        for _ in range(self.options.cycles):
            self._roll_out()
            for _ in range(self.options.updates):
                self._update()
            self._follow()
        distance = self.test(self.policy, tests)[-1]
        success, mean = (distance < self.tolerance.numpy()).mean(axis=1), distance.mean(axis=1)
        self._rows.append((self._taken, success, mean, self.tolerance[:, 0].numpy().copy()))
        self._keep_best(mean)
        self._go_on(success, mean)

    def test(self, policy: Policy, tests: int) -> np.ndarray:
        """Distances after each action of a policy without exploration, (horizon, seeds, tests)."""
        draw = torch.Generator().manual_seed(_TESTS)
        states, _, goals = self.trials.begin_alike(draw, (self._seeds, tests))
        far: list[np.ndarray] = []
        with torch.no_grad():
            for _ in range(self.trials.horizon):
                states, reached = self.trials.act(policy(states, goals))
                far.append(self.trials.distances(reached, goals).numpy())
        return np.array(far)

    def _roll_out(self) -> None:
        """Episodes of a cycle, into the buffer; running means see them with their goals as they are relabelled."""
        options, trials, many = self.options, self.trials, self._rollouts
        states, reached, goals = trials.begin(self._draw, (self._seeds, many))
        room = slice(self._filled, self._filled + many)
        self._states[:, room, 0], self._reached[:, room, 0], self._goals[:, room] = states, reached, goals
        with torch.no_grad():
            for step in range(trials.horizon):
                acts = self.policy(states, goals)
                acts = (acts + options.noise * torch.randn(acts.shape, generator=self._draw)).clamp(-1.0, 1.0)
                chance = 2.0 * torch.rand(acts.shape, generator=self._draw) - 1.0
                anew = torch.rand(*acts.shape[:2], 1, generator=self._draw) < options.random
                acts = torch.where(anew, chance, acts)
                states, reached = trials.act(acts)
                self._acts[:, room, step] = acts
                self._states[:, room, step + 1], self._reached[:, room, step + 1] = states, reached
        self._taken += many * trials.horizon
        self._filled += many
        seen = self._drawn(many * trials.horizon, room)
        self.policy.states.see(seen[0])
        self.policy.goals.see(seen[4])

    def _drawn(self, count: int, room: slice | None = None) -> tuple[Tensor, ...]:
        """Transitions of the buffer: state, action, next state, what it reached, goal; most with hindsight."""
        low, high = (0, self._filled) if room is None else (room.start, room.stop)
        shape, horizon = (self._seeds, count), self.trials.horizon
        episode = torch.randint(low, high, shape, generator=self._draw)
        step = torch.randint(0, horizon, shape, generator=self._draw)
        ahead = hindsight(horizon - step, 1.0 - 1.0 / (1.0 + self.options.relabelled), self._draw)
        which = torch.arange(self._seeds)[:, None]
        later = self._reached[which, episode, step + 1 + ahead.clamp(min=0)]
        goals = torch.where((ahead >= 0)[..., None], later, self._goals[which, episode])
        now, after = self._states[which, episode, step], self._states[which, episode, step + 1]
        return now, self._acts[which, episode, step], after, self._reached[which, episode, step + 1], goals

    def _update(self) -> None:
        """One step of the critics, and one of the actors."""
        options = self.options
        states, acts, after, reached, goals = self._drawn(options.batch)
        reward = rewards(self.trials.distances(reached, goals), self.tolerance, shaped=options.shaped)
        seen, then = self.policy.see(states, goals), self.policy.see(after, goals)
        with torch.no_grad():
            targets = reward
            if self._gamma > 0:
                following = torch.tanh(apply_layers(self._followers[0], then))
                targets = reward + self._gamma * self._value(self._followers[1], then, following)
            targets = cut_targets(targets, self._gamma) if options.cut else targets
        loss = (self._value(self._critic, seen, acts) - targets).square().mean(1).sum()
        self._critic_adam.zero_grad()
        loss.backward()
        self._critic_adam.step()
        chosen = torch.tanh(apply_layers(self.policy.numbers, seen))
        fixed = [part.detach() for part in self._critic]
        effort = options.penalty * chosen.square().mean((1, 2))
        loss = (effort - self._value(fixed, seen, chosen).mean(1)).sum()
        self._actor_adam.zero_grad()
        loss.backward()
        self._actor_adam.step()

    @staticmethod
    def _value(critic: Sequence[Tensor], seen: Tensor, acts: Tensor) -> Tensor:
        return apply_layers(critic, torch.cat([seen, acts], -1))[..., 0]

    def _follow(self) -> None:
        """Targets go a little towards the networks."""
        with torch.no_grad():
            for slow, fast in zip(self._followers, (self.policy.numbers, self._critic), strict=True):
                torch._foreach_lerp_(slow, fast, 1.0 - self.options.polyak)  # pyright: ignore[reportPrivateImportUsage]

    def _keep_best(self, distance: np.ndarray) -> None:
        """Actors of seeds that are better than they were."""
        better = distance < self._least
        self._least = np.where(better, distance, self._least)
        if not better.any():
            return
        now, which = self.policy.copy_policy(), torch.tensor(better)
        for old, new in zip(self.best.numbers, now.numbers, strict=True):
            old[which] = new[which]
        for mean, latest in ((self.best.states, now.states), (self.best.goals, now.goals)):
            mean.sum[which] = latest.sum[which] * (max(mean.count, 1.0) / latest.count)
            mean.squares[which] = latest.squares[which] * (max(mean.count, 1.0) / latest.count)

    def _go_on(self, success: np.ndarray, distance: np.ndarray) -> None:
        """The tolerance that comes next, for seeds that have mastered theirs."""
        before = self.tolerance[:, 0].numpy().copy()
        after = self.options.curriculum.next(before, success, distance)
        self.tolerance[:, 0] = torch.tensor(after, dtype=torch.float32)
        if not (after < before).any():
            return
        if self.options.late_critic_rate is not None:
            self._critic_adam.param_groups[0]["lr"] = self.options.late_critic_rate
        if self.options.reset_adam:
            for state in (*self._actor_adam.state.values(), *self._critic_adam.state.values()):
                state["step"].zero_()


def apply_layers(numbers: Sequence[Tensor], values: Tensor) -> Tensor:
    """Networks of all seeds, with ReLU between their layers."""
    last = len(numbers) - 2
    for layer in range(0, len(numbers), 2):
        values = torch.baddbmm(numbers[layer + 1], values, numbers[layer])
        values = torch.relu(values) if layer < last else values
    return values


def _glorot(sizes: Sequence[int], seeds: int, draw: torch.Generator) -> list[Tensor]:
    """Weights and biases of networks of these sizes, as Glorot begins them."""
    numbers: list[Tensor] = []
    for one, two in pairwise(sizes):
        bound = (6.0 / (one + two)) ** 0.5
        numbers.append(bound * (2.0 * torch.rand(seeds, one, two, generator=draw) - 1.0))
        numbers.append(torch.zeros(seeds, 1, two))
    return [part.requires_grad_() for part in numbers]


_TESTS = 987_654
"""Seed of the tests' goals: training draws from other generators."""
