"""`WAYS`: ways to a policy of one action other than trial and error, on the same pairs of actions and outcomes.

Each takes trials and pairs, (seeds, many, size), and gives what a policy is called with: states and goals.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from hydrostat.errors import InputError
from hydrostat.learning import TANH_SCALE
from hydrostat.progress import Progress, no_progress
from hydrostat.version import install_command
from hydrostat_lab.experiments import SMALL
from hydrostat_lab.hindsight_ddpg import HindsightDdpg, apply_layers
from hydrostat_lab.trials import Begun, NetworkReach, Trials

try:
    import torch
    from torch import Tensor
except ModuleNotFoundError as error:
    raise InputError(f"training needs {error.name}; install it: {install_command('rl')}") from None

from hydrostat.learning import answer

Act = Callable[[Tensor, Tensor], Tensor]
"""Actions of states and goals, (seeds, many, size) each."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TriedPairs:
    """Actions drawn evenly, and what they reached [cm], (seeds, many, size); each costs an equilibrium."""

    acts: Tensor
    reached: Tensor

    def first(self, many: int) -> "TriedPairs":
        """The first pairs of each seed."""
        return TriedPairs(acts=self.acts[:, :many], reached=self.reached[:, :many])


@dataclass(frozen=True, kw_only=True)
class Budget:
    """Budget for learning policies.

    Attributes:
        steps: gradient steps.
        epochs: epochs of trial and error.
        batch: pairs or goals of a step.
        progress: callback for progress.
    """

    steps: int = 6000
    epochs: int = 30
    batch: int = 128
    progress: Progress = no_progress


def drawn_pairs(trials: NetworkReach, seeds: int, many: int) -> TriedPairs:
    """TriedPairs at random, others for each seed."""
    draw = torch.Generator().manual_seed(_PAIRS)
    acts = 2.0 * torch.rand(seeds, many, trials.actions, generator=draw) - 1.0
    return TriedPairs(acts=acts, reached=trials.reach(acts))


def constant(_trials: NetworkReach, pairs: TriedPairs, _effort: Budget) -> Act:
    """The mean action, whatever is asked."""
    mean = pairs.acts.mean(1, keepdim=True)
    return lambda _states, goals: mean.expand(-1, goals.shape[1], -1)


def nearest(_trials: NetworkReach, pairs: TriedPairs, _effort: Budget) -> Act:
    """The action of the pair whose outcome is nearest (R88)."""

    def act(_states: Tensor, goals: Tensor) -> Tensor:
        best = torch.cdist(goals, pairs.reached).argmin(-1)
        return pairs.acts.gather(1, best[..., None].expand(-1, -1, pairs.acts.shape[-1]))

    return act


def ridge(_trials: NetworkReach, pairs: TriedPairs, _effort: Budget) -> Act:
    """Ridge regression from outcomes to actions (R88)."""
    known = torch.cat([pairs.reached, torch.ones_like(pairs.reached[..., :1])], -1)
    square = known.mT @ known + 1e-3 * torch.eye(known.shape[-1])
    linear = torch.linalg.solve(square, known.mT @ pairs.acts)
    return lambda _states, goals: (goals @ linear[:, :-1] + linear[:, -1:]).clamp(-1.0, 1.0)


def clone_actions(trials: NetworkReach, pairs: TriedPairs, effort: Budget) -> Act:
    """A network that repeats the actions of the pairs: behavior cloning, by the square of the action's error."""

    def loss(network: "_Network", rows: Tensor) -> Tensor:
        wanted, reached = (_take_rows(part, rows) for part in (pairs.acts, pairs.reached))
        return (network(reached) - wanted).square().sum(-1)

    return _fit_policy(trials, pairs, effort, loss)


def clone_small(trials: NetworkReach, pairs: TriedPairs, effort: Budget) -> Act:
    """The same cloning by a network like that of trial and error: `SMALL`'s layers, ReLU, no linear map (R88)."""

    def loss(network: "_Network", rows: Tensor) -> Tensor:
        wanted, reached = (_take_rows(part, rows) for part in (pairs.acts, pairs.reached))
        return (network(reached) - wanted).square().sum(-1)

    return _fit_policy(trials, pairs, effort, loss, _SmallNetwork(trials, pairs, SMALL.layers))


def gradient(trials: NetworkReach, pairs: TriedPairs, effort: Budget) -> Act:
    """A network that learns from what its own actions reach, through exact slopes of the networks that it acts in.

    Goals are new ones all the time: in networks they cost nothing.
    """
    draw = torch.Generator().manual_seed(_GOALS)

    def loss(network: "_Network", rows: Tensor) -> Tensor:
        goals = trials.reach(2.0 * torch.rand(*rows.shape, trials.actions, generator=draw) - 1.0)
        return trials.distances(trials.places(trials.contractions(network(goals))), goals)

    return _fit_policy(trials, pairs, effort, loss)


def trial_and_error(trials: NetworkReach, pairs: TriedPairs, effort: Budget) -> Act:
    """The thesis's method, with its small networks and a shaped reward."""
    return _fit_tries(trials, pairs, effort, fill=False)


def learn_from_filled_buffer(trials: NetworkReach, pairs: TriedPairs, effort: Budget) -> Act:
    """The same, with the pairs in its replay buffer before it begins."""
    return _fit_tries(trials, pairs, effort, fill=True)


def residual(trials: NetworkReach, pairs: TriedPairs, effort: Budget) -> Act:
    """Trial and error about what cloning does: actions are a tenth of the learned ones, beside those of the clone."""
    base = clone_actions(trials, pairs, effort)
    around = _Around(trials, base)
    found = _fit_tries(around, pairs, effort, fill=False)
    return lambda states, goals: around.whole(found(states, goals), goals)


WAYS: Mapping[str, Callable[[NetworkReach, TriedPairs, Budget], Act]] = {
    "gradient": gradient,
    "ridge": ridge,
    "1-NN": nearest,
    "cloned": clone_actions,
    "trial and error": trial_and_error,
    "the same, filled": learn_from_filled_buffer,
    "residual on the clone": residual,
    "constant": constant,
}
"""By their names in tables."""

PAIRS_ALONE, UNFILLED = ("ridge", "1-NN", "cloned", "constant"), ("trial and error",)
"""Ways that cost their pairs and nothing else, tried with several numbers of them; and ways that cost trials alone."""


class _Network:
    """Networks of all seeds from goals to actions, with SiLU and a linear map beside it."""

    def __init__(self, trials: NetworkReach, pairs: TriedPairs, layers: Sequence[int] | None = None) -> None:
        layers = _LAYERS if layers is None else layers
        seeds, draw = len(pairs.acts), torch.Generator().manual_seed(_NETWORKS)
        self._mean, self._spread = pairs.reached.mean(1, keepdim=True), pairs.reached.std(1, keepdim=True)
        self.numbers: list[Tensor] = []
        for one, two in pairwise([trials.goals, *layers, trials.actions]):
            self.numbers.append(torch.randn(seeds, one, two, generator=draw) / math.sqrt(one))
            self.numbers.append(torch.zeros(seeds, 1, two))
        self.numbers.append(torch.zeros(seeds, trials.goals, trials.actions))
        self.numbers = [part.requires_grad_() for part in self.numbers]

    def __call__(self, goals: Tensor) -> Tensor:
        raw = self._answer((goals - self._mean) / self._spread)
        return (TANH_SCALE * torch.tanh(raw)).clamp(-1.0, 1.0)

    def _answer(self, values: Tensor) -> Tensor:
        return answer(self.numbers, values, None)[0]


class _SmallNetwork(_Network):
    """Networks with ReLU and nothing beside it."""

    def _answer(self, values: Tensor) -> Tensor:
        return apply_layers(self.numbers[:-1], values)


def _fit_policy(
    trials: NetworkReach,
    pairs: TriedPairs,
    effort: Budget,
    loss: Callable[[_Network, Tensor], Tensor],
    network: _Network | None = None,
) -> Act:
    """Networks by Adam on batches of pairs, with a rate that falls as a cosine."""
    torch.set_num_threads(1)
    torch.set_flush_denormal(True)  # numbers that fade to nothing take a hundred times as long
    network, draw = network or _Network(trials, pairs), torch.Generator().manual_seed(_BATCHES)
    adam = torch.optim.Adam(network.numbers, lr=_RATE, fused=True)
    seeds, many, _ = pairs.acts.shape
    for step in range(effort.steps):
        effort.progress("steps of gradients", step, effort.steps)
        for group in adam.param_groups:
            group["lr"] = 0.5 * _RATE * (1.0 + math.cos(math.pi * step / effort.steps))
        rows = torch.randint(many, (seeds, effort.batch), generator=draw)
        adam.zero_grad()
        loss(network, rows).mean(1).sum().backward()
        adam.step()

    def act(_states: Tensor, goals: Tensor) -> Tensor:
        with torch.no_grad():
            return network(goals)

    return act


def _fit_tries(trials: Trials, pairs: TriedPairs, effort: Budget, *, fill: bool) -> Act:
    learner = HindsightDdpg(trials, SMALL, seeds=len(pairs.acts), epochs=effort.epochs, room=pairs.acts.shape[1])
    if fill:
        learner.fill(pairs.acts, pairs.reached)
    learner.learn(progress=lambda done, of: effort.progress("epochs", done, of))
    return learner.best


class _Around(Trials):
    """The same task, where actions are small changes of what another policy does for a goal."""

    def __init__(self, trials: Trials, base: Act) -> None:
        self.states, self.goals, self.actions, self.horizon = (
            trials.states,
            trials.goals,
            trials.actions,
            trials.horizon,
        )
        self._trials, self._base, self._wanted = trials, base, torch.zeros(0)

    def begin(self, draw: torch.Generator, shape: tuple[int, int]) -> Begun:
        """Begin as before, and remember the goals."""
        begun = self._trials.begin(draw, shape)
        self._wanted = begun[2]
        return begun

    def act(self, acts: Tensor) -> tuple[Tensor, Tensor]:
        """Act about what the other policy does."""
        return self._trials.act(self.whole(acts, self._wanted))

    def distances(self, reached: Tensor, goals: Tensor) -> Tensor:
        """Distances of the task."""
        return self._trials.distances(reached, goals)

    def whole(self, acts: Tensor, goals: Tensor) -> Tensor:
        """The action of a small change."""
        goals = goals.expand(len(acts), -1, -1)
        return (self._base(goals, goals) + _SMALL * acts).clamp(-1.0, 1.0)


def _take_rows(values: Tensor, rows: Tensor) -> Tensor:
    """Rows of values for each seed."""
    return values.gather(1, rows[..., None].expand(-1, -1, values.shape[-1]))


_LAYERS, _RATE, _SMALL = (128, 128, 128), 3e-3, 0.1
"""Hidden layers, largest rate of learning, how far a network may reach beyond its range, and share of small changes."""

_PAIRS, _NETWORKS, _BATCHES, _GOALS = 11, 22, 33, 44
"""Seeds of what is drawn."""
