"""What others do with the same samples: a constant, nearest neighbours, ridge regression, the thesis's network."""

from collections.abc import Callable, Mapping
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.optimize import lsq_linear

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.learning.lesson import linear_map
from hydrostat.learning.samples import Samples

Goals = Float[np.ndarray, "targets coordinates"]
Answers = Float[np.ndarray, "targets winches"]
Method = Callable[[Samples, Goals], Answers]


def constant(train: Samples, goals: Goals) -> Answers:
    """The mean contractions, whatever is asked."""
    return np.tile(train.contractions.mean(axis=0), (len(goals), 1))


def nearest(train: Samples, goals: Goals) -> Answers:
    """Contractions of the sample whose markers are nearest (R88)."""
    return train.contractions[_nearest(train, goals)]


def nearest_with_slopes(train: Samples, goals: Goals) -> Answers:
    """The same, and one bounded Gauss-Newton step by the sample's own slopes."""
    low, high = _limits(train)
    rows = []
    for goal, place in zip(goals, _nearest(train, goals), strict=True):
        begun, markers = train.contractions[place], train.markers[place].ravel()
        slopes = train.jacobians[place].reshape(len(goal), -1)
        rows.append(begun + _bounded(slopes, markers - goal, low - begun, high - begun))
    return np.array(rows)


def ridge(train: Samples, goals: Goals) -> Answers:
    """Ridge regression from markers to contractions (R88)."""
    size = train.facts["size"]
    linear = linear_map(train.markers.reshape(len(train), -1) / size, train.contractions)
    return np.clip(np.hstack([goals / size, np.ones((len(goals), 1))]) @ linear, *_limits(train))


def thesis_network(train: Samples, goals: Goals) -> Answers:
    """The thesis's network (R66): four layers of 30, ReLU, tanh at the end, squares of the action.

    Inputs are raw centimetres; Adam with rate 0.001, batches of 20, 300 epochs, the weights that were best on a tenth.

    Raises:
        InputError: no PyTorch.
    """
    try:
        import torch  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise InputError("the thesis's network needs PyTorch; install hydrostat[learn]") from None
    draw = torch.Generator().manual_seed(0)
    low, high = _limits(train)
    inputs = torch.tensor(100 * train.markers.reshape(len(train), -1), dtype=torch.float32)
    actions = torch.tensor(2 * (train.contractions - low) / (high - low) - 1, dtype=torch.float32)
    with torch.random.fork_rng():
        torch.manual_seed(0)
        layers: list[torch.nn.Module] = []
        for one, two in pairwise([inputs.shape[1], 30, 30, 30, 30, actions.shape[1]]):
            layers += [torch.nn.Linear(one, two), torch.nn.ReLU()]
        network = torch.nn.Sequential(*layers[:-1], torch.nn.Tanh())
    optimiser = torch.optim.Adam(network.parameters(), lr=1e-3)
    order, kept = torch.randperm(len(inputs), generator=draw), len(inputs) - max(1, len(inputs) // 10)
    learned, held = order[:kept], order[kept:]
    best, least = network.state_dict(), float("inf")
    for _ in range(300):
        for rows in learned[torch.randperm(kept, generator=draw)].split(20):
            optimiser.zero_grad(set_to_none=True)
            (network(inputs[rows]) - actions[rows]).square().mean().backward()
            optimiser.step()
        with torch.no_grad():
            loss = float((network(inputs[held]) - actions[held]).square().mean())
        if loss < least:
            best, least = {name: part.clone() for name, part in network.state_dict().items()}, loss
    network.load_state_dict(best)
    with torch.no_grad():
        found = network(torch.tensor(100 * goals, dtype=torch.float32)).double().numpy()
    return low + 0.5 * (found + 1) * (high - low)


def _bounded(slopes: np.ndarray, residual: Vector, low: Vector, high: Vector) -> Vector:
    """The change within limits that best undoes what is missed; the shortest where several do."""
    low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
    some = _SHORT * np.sqrt(np.square(slopes).sum(axis=0).max(initial=0.0))
    rows = np.vstack([slopes, some * np.eye(len(low))])
    found = lsq_linear(rows, np.r_[-residual, np.zeros(len(low))], bounds=(low - _ROOM, high + _ROOM))
    return np.clip(found.x, low, high)


def _limits(train: Samples) -> tuple[Vector, Vector]:
    """Least and largest contractions [m]."""
    return -np.array(train.facts["release"], dtype=float), np.array(train.facts["travel"], dtype=float)


def _nearest(train: Samples, goals: Goals) -> np.ndarray:
    known = train.markers.reshape(len(train), -1)
    return np.array([np.square(known - goal).sum(axis=1).argmin() for goal in goals])


OTHERS: Mapping[str, Method] = {
    "constant": constant,
    "1-NN": nearest,
    "1-NN, Jacobian": nearest_with_slopes,
    "ridge": ridge,
    "thesis": thesis_network,
}
"""Ways from samples and goals to contractions, by their names in tables."""

_SHORT = 1e-3
"""How much a change counts beside what it undoes, as a share of the steepest slope."""

_ROOM = 1e-12
"""Bounds are moved apart by so much [m], as an empty range is refused."""
