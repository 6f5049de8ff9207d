"""`compare_on_shared_data`: trial and error beside what others learn of the pairs that it tried (thesis, Fig 5.14)."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from hydrostat.errors import InputError
from hydrostat.progress import Progress, no_progress
from hydrostat.simulation import Simulation
from hydrostat.version import install_command
from hydrostat_lab.experiments import SMALL
from hydrostat_lab.hindsight_ddpg import HindsightDdpg
from hydrostat_lab.policies import Act, Budget, TriedPairs, clone_actions, clone_small, drawn_pairs, nearest, ridge
from hydrostat_lab.run_experiment import exact_distances, exact_goals
from hydrostat_lab.trials import NetworkReach

try:
    import torch
except ModuleNotFoundError as error:
    raise InputError(f"training needs {error.name}; install it: {install_command('rl')}") from None


class Order(NamedTuple):
    """A claim that one way ends nearer than another."""

    text: str
    nearer: str
    farther: str


@dataclass(frozen=True, kw_only=True, eq=False)
class OfPairs:
    """Errors of a method after a number of pairs of actions and outcomes.

    Attributes:
        way: its name.
        pairs: number of pairs.
        expected: distances in the networks that it was learned in [cm], (seeds, goals).
        exact: distances in the simulator [cm], (seeds, goals); after all pairs alone, as it takes long, else None.
    """

    way: str
    pairs: int
    expected: np.ndarray
    exact: np.ndarray | None


def compare_on_shared_data(
    trials: NetworkReach,
    simulation: Simulation,
    *,
    seeds: int,
    goals: int,
    budget: Budget,
    progress: Progress = no_progress,
) -> Iterator[OfPairs]:
    """Learn by trial and error, which sees the goal alone, and in other ways, of the same pairs and of drawn ones.

    Args:
        trials: episodes of one action.
        simulation: simulation of the same robot, which judges at the end.
        seeds: number of random starts of each.
        goals: number of goals in the simulator.
        budget: epochs of trial and error, and steps of the network.
        progress: callback for progress.
    """
    options = replace(SMALL, goal_only=True)
    learner, marks = HindsightDdpg(trials, options, seeds=seeds, epochs=budget.epochs), looked_at(budget.epochs)
    then: dict[int, tuple[Act, Act]] = {}

    def done(at: int, of: int) -> None:
        if at in marks:
            then[at] = learner.policy.copy_policy(), learner.best.copy_policy()
        progress(TRIED, at, of)

    learner.learn(progress=done)
    acts, reached = (torch.tensor(part) for part in learner.tried)
    each = acts.shape[1] // budget.epochs
    tried, drawn = TriedPairs(acts=acts, reached=reached), drawn_pairs(trials, seeds, acts.shape[1])
    asked = exact_goals(simulation, trials, goals)
    for at in marks:
        ways = dict(zip((TRIED, BEST), then[at], strict=True))
        for data, pairs in (("shared", tried.first(each * at)), ("independent", drawn.first(each * at))):
            ways |= {f"{name}, {data}": way(trials, pairs, budget) for name, way in OTHERS.items()}
        for name, act in ways.items():
            exact = exact_distances(simulation, trials, act, seeds, asked) if at == marks[-1] else None
            yield OfPairs(way=name, pairs=each * at, expected=expected_errors(trials, act, seeds), exact=exact)


def expected_errors(trials: NetworkReach, act: Act, seeds: int) -> np.ndarray:
    """Compute distances [cm] in the networks from 1,000 goals that none learns from, (seeds, goals)."""
    states, _, goals = trials.begin_alike(torch.Generator().manual_seed(_GOALS), (seeds, _MANY))
    with torch.no_grad():
        return trials.distances(trials.reach(act(states, goals)), goals).numpy()


def looked_at(epochs: int) -> tuple[int, ...]:
    """Epochs after which all are compared: the first, the last, and two between by equal factors."""
    return tuple(sorted({round(epochs ** (part / 3)) for part in range(4)}))


TRIED, BEST = "trial and error", "trial and error, best"
"""The thesis's method as it is after so many actions, and as it was in its best epoch until then."""

OTHERS: Mapping[str, Callable[[NetworkReach, TriedPairs, Budget], Act]] = {
    "1-NN": nearest,
    "network": clone_actions,
    "network 4 x 30": clone_small,
    "ridge": ridge,
}
"""Ways to learn from pairs, by their names."""

ORDERS = (
    Order("1-NN ends nearer than trial and error, of the same pairs (N16)", "1-NN, shared", BEST),
    Order("trial and error ends nearer than a network, of the same pairs (N16, R90)", BEST, "network, shared"),
    Order("a network ends nearer than ridge regression (N16)", "network, shared", "ridge, shared"),
    Order("trial and error ends nearer than a network of pairs drawn evenly (R90, E61)", BEST, "network, independent"),
    Order("trial and error ends nearer than an equal network of the same pairs (R88)", BEST, "network 4 x 30, shared"),
)
"""Claims of the thesis about the end of its figure, and its conclusion when others have pairs of their own."""

_GOALS, _MANY = 27_182, 1000
"""Seed and number of the goals in the networks."""
