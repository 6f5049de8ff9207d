"""`train_thesis_network`: the network of the thesis with its own settings, and the curves of its learning."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from hydrostat.arrays import Float
from hydrostat.errors import InputError
from hydrostat.learning import Samples, SamplingScheme, shared_numbers
from hydrostat.version import install_command

Goals = Float[np.ndarray, "targets coordinates"]
Answers = Float[np.ndarray, "targets winches"]


@dataclass(frozen=True, kw_only=True, eq=False)
class ThesisNetwork:
    """A trained network of the thesis.

    Attributes:
        answers: contractions [m] for coordinates of the markers [m].
        curve: mean squares of the action's error, contractions counted from -1 to 1: on what was learned from, over
            the epoch, and on what was held out, after it.
    """

    answers: Callable[[Goals], Answers]
    curve: Float[np.ndarray, "epochs 2"]


def train_thesis_network(train: Samples, *, seed: int = 0, epochs: int = 300) -> ThesisNetwork:
    """Train the thesis's network (R66): four layers of 30, ReLU, tanh at the end, squares of the action.

    Of samples of which two winches that work against one another share a number its action has those numbers, else one
    for each winch. Inputs are raw centimeters; Adam with rate 0.001, batches of 20, the weights that were best on a
    tenth.

    Raises:
        InputError: no PyTorch.
    """
    try:
        import torch  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise InputError(f"the thesis's network needs PyTorch. Install it: {install_command('learn')}") from None
    draw = torch.Generator().manual_seed(seed)
    to_action, to_contractions = _actions(train)
    inputs = torch.tensor(100 * train.markers.reshape(len(train), -1), dtype=torch.float32)
    actions = torch.tensor(to_action(train.contractions), dtype=torch.float32)
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        layers: list[torch.nn.Module] = []
        for one, two in pairwise([inputs.shape[1], 30, 30, 30, 30, actions.shape[1]]):
            layers += [torch.nn.Linear(one, two), torch.nn.ReLU()]
        network = torch.nn.Sequential(*layers[:-1], torch.nn.Tanh())
    optimizer = torch.optim.Adam(network.parameters(), lr=1e-3)
    order, kept = torch.randperm(len(inputs), generator=draw), len(inputs) - max(1, len(inputs) // 10)
    learned, held = order[:kept], order[kept:]
    best, least, curve = network.state_dict(), float("inf"), np.zeros((epochs, 2))
    for epoch in range(epochs):
        for rows in learned[torch.randperm(kept, generator=draw)].split(20):
            optimizer.zero_grad(set_to_none=True)
            loss = (network(inputs[rows]) - actions[rows]).square().mean()
            loss.backward()
            optimizer.step()
            curve[epoch, 0] += loss.item() * len(rows) / kept
        with torch.no_grad():
            curve[epoch, 1] = float((network(inputs[held]) - actions[held]).square().mean())
        if curve[epoch, 1] < least:
            best, least = {name: part.clone() for name, part in network.state_dict().items()}, curve[epoch, 1]
    network.load_state_dict(best)

    def answers(goals: Goals) -> Answers:
        with torch.no_grad():
            found = network(torch.tensor(100 * goals, dtype=torch.float32)).double().numpy()
        return to_contractions(found)

    return ThesisNetwork(answers=answers, curve=curve)


def _actions(train: Samples) -> tuple[Callable[[Answers], np.ndarray], Callable[[np.ndarray], Answers]]:
    """From contractions [m] to actions between -1 and 1, and back."""
    low, high = train.limits
    if list(train.facts["draws"]) != [SamplingScheme.ANTAGONIST]:
        return lambda rows: 2 * (rows - low) / (high - low) - 1, lambda found: low + 0.5 * (found + 1) * (high - low)
    places = {name: place for place, name in enumerate(train.facts["winches"])}
    pairs = tuple(tuple(places[name] for name in names) for names in train.facts["pairs"])
    return (
        lambda rows: 2 * shared_numbers(rows, high, pairs) - 1,
        lambda found: SamplingScheme.ANTAGONIST.contractions(0.5 * (found + 1), low, high, pairs),
    )
