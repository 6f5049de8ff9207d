"""Training of networks on samples, by PyTorch; the only file of this room that needs it."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from hydrostat.arrays import Float
from hydrostat.errors import InputError
from hydrostat.learning.learn_options import LearnOptions
from hydrostat.learning.learned_model import TANH_SCALE, span_of
from hydrostat.learning.perceptrons import Perceptrons
from hydrostat.learning.training_set import TrainingSet, linear_map
from hydrostat.progress import Progress
from hydrostat.version import install_command

try:
    import torch  # pyright: ignore[reportMissingImports]
    from torch import Tensor  # pyright: ignore[reportMissingImports]
except ImportError:
    raise InputError(f"learning needs PyTorch. Install it: {install_command('learn')}") from None

Numbers = Sequence[Tensor]  # weights and biases of each layer, then S, each (members, ...)


@dataclass(frozen=True, kw_only=True)
class Trained:
    """Networks as they were when they did best on what they had not learned from.

    Attributes:
        networks: networks of one shape.
        error: mean distance of markers on held-out samples, in the unit of the training set; infinite without one.
        stopped: True if Ctrl-C ended it.
    """

    networks: Perceptrons
    error: float
    stopped: bool


def train_forward(
    training_set: TrainingSet, dim: int, options: LearnOptions, progress: Progress, *, start: Perceptrons | None = None
) -> Trained:
    """Train networks from contractions to markers and tensions; each holds out other samples.

    With `start`, training continues from those networks, with the same number and shape.
    """
    torch.set_num_threads(options.threads)
    draw = torch.Generator().manual_seed(options.seed)
    inputs, outputs, derivatives = (
        _tensor(part) for part in (training_set.inputs, training_set.outputs, training_set.jacobians)
    )
    if start is None:
        sizes = [inputs.shape[1], *[options.width] * options.depth, outputs.shape[1]]
        numbers = _begin(sizes, options.members, training_set.linear, draw)
    else:
        sizes, numbers = start.sizes.tolist(), tensors_of(start)
    learned, held = _folds(len(inputs), options, draw)
    batches = _batches(learned, options.batch, draw)
    coordinates = training_set.coordinates
    weights = loss_weights(coordinates, outputs.shape[1], options)

    def loss() -> Tensor:
        rows = next(batches)
        ways = torch.randn(*rows.shape, options.directions, sizes[0], generator=draw) if options.jacobians else None
        return sobolev_loss(numbers, inputs[rows], ways, outputs[rows], derivatives[rows], weights)

    def error() -> Tensor:
        value, _ = answer(numbers, inputs[held], None)
        missed = (value - outputs[held])[..., :coordinates].unflatten(-1, (-1, dim))
        return missed.norm(dim=-1).mean((1, 2))

    steps = options.steps_for(len(inputs))
    best, errors, stopped = _train(numbers, loss, error, steps, options.rate, lambda n: progress("forward", *n))
    return Trained(networks=_perceptrons(sizes, best), error=float(errors.mean()), stopped=stopped)


def train_inverse(
    training_set: TrainingSet,
    dim: int,
    forward: Perceptrons,
    options: LearnOptions,
    progress: Progress,
    pairs: tuple[np.ndarray, np.ndarray],
) -> Trained:
    """Train a network from markers to contractions through the forward networks.

    Targets are the markers of the samples, and predictions between samples. Many contractions can reach the same
    target, so the loss compares the markers that the answer reaches, and its effort, with no reference contractions.
    Only one winch of each pair takes in cable, as in the samples.
    """
    draw = torch.Generator().manual_seed(options.seed + 1)
    inputs, markers = _tensor(training_set.inputs), _tensor(training_set.outputs[:, : training_set.coordinates])
    teacher = tensors_of(forward)
    sizes = [training_set.coordinates, *[options.width] * options.depth, inputs.shape[1]]
    numbers = _begin(
        sizes, 1, linear_map(training_set.outputs[:, : training_set.coordinates], training_set.inputs), draw
    )
    aside = torch.arange(0, len(inputs), max(2, round(1 / options.held_out)))
    learned = torch.tensor(np.setdiff1d(np.arange(len(inputs)), aside.numpy()))[None]
    batches, members, held = _batches(learned, options.batch, draw), len(forward), _holding(training_set, pairs)

    def apply_inverse(goals: Tensor, number: int) -> tuple[Tensor, Tensor, Tensor]:
        scaled = held(TANH_SCALE * torch.tanh(answer(numbers, goals[None], None)[0]))
        value = answer([part[number : number + 1] for part in teacher], scaled, None)[0][0]
        return value[:, : training_set.coordinates], value[:, training_set.coordinates :], scaled[0]

    def loss() -> Tensor:
        rows, others = next(batches)[0], next(batches)[0]
        number = int(torch.randint(members, (1,), generator=draw))
        share = _BETWEEN * torch.rand(len(rows), 1, generator=draw)
        between = held(inputs[rows] + share * (inputs[others] - inputs[rows]))
        with torch.no_grad():
            expected = answer([part[number : number + 1] for part in teacher], between[None], None)[0][0]
        goals = torch.cat([markers[rows], expected[:, : training_set.coordinates]])
        found, pulls, scaled = apply_inverse(goals, number)
        effort = torch.relu(pulls).square().sum(-1) + (1 + scaled).square().sum(-1)
        return (found - goals).square().sum(-1).mean() + options.effort * effort.mean()

    def error() -> Tensor:
        found = torch.stack([apply_inverse(markers[aside], number)[0] for number in range(members)]).mean(0)
        return (found - markers[aside]).unflatten(-1, (-1, dim)).norm(dim=-1).mean()[None]

    best, errors, stopped = _train(
        numbers, loss, error, options.inverse_steps, options.rate, lambda n: progress("inverse", *n)
    )
    return Trained(networks=_perceptrons(sizes, best), error=float(errors.mean()), stopped=stopped)


def _holding(training_set: TrainingSet, pairs: tuple[np.ndarray, np.ndarray]) -> Callable[[Tensor], Tensor]:
    """Return a function on scaled contractions after which one winch of each pair takes in, as in `LearnedModel`."""
    one, other = (torch.tensor(places) for places in pairs)
    if not len(one):
        return lambda scaled: scaled
    low, high, half = (
        _tensor(part)
        for part in (training_set.low, training_set.high, 0.5 * span_of(training_set.low, training_set.high))
    )

    def apply_pairs(scaled: Tensor) -> Tensor:
        shares = (low + half * (scaled + 1.0)) / torch.where(high > 0, high, 1.0)
        more = shares[..., one] - shares[..., other]
        found = scaled.clone()
        for places, taken in ((one, torch.relu(more)), (other, torch.relu(-more))):
            found[..., places] = (taken * high[places] - low[places]) / half[places] - 1.0
        return found

    return apply_pairs


def loss_weights(coordinates: int, outputs: int, options: LearnOptions) -> tuple[Tensor, Tensor]:
    """Weights of the value of each output, and of its derivative: markers first, then tensions."""
    tensions = outputs - coordinates
    values, derivatives = (1.0, options.tensions), (options.jacobians, options.tension_jacobians)
    return tuple(
        torch.tensor([marker] * coordinates + [tension] * tensions) for marker, tension in (values, derivatives)
    )  # type: ignore


def sobolev_loss(
    numbers: Numbers,
    points: Tensor,
    ways: "Tensor | None",
    outputs: Tensor,
    derivatives: Tensor,
    weights: tuple[Tensor, Tensor],
) -> Tensor:
    """Mean squares of what values and derivatives along some ways miss, summed over the networks (members, batch, ...).

    Derivatives of the first outputs, of as many as are given.
    """
    value, moved = answer(numbers, points, ways)
    loss = ((value - outputs).square() * weights[0]).sum(-1)
    if moved is not None and ways is not None:
        differentiated = derivatives.shape[-2]
        true = torch.einsum("mbkw,mbcw->mbkc", ways, derivatives)
        loss = loss + ((moved[..., :differentiated] - true).square() * weights[1][:differentiated]).sum(-1).mean(-1)
    return loss.mean(1).sum()


def answer(numbers: Numbers, points: Tensor, ways: "Tensor | None") -> "tuple[Tensor, Tensor | None]":
    """Compute outputs at points (members, batch, inputs), and derivatives in directions (members, batch, ways, ...).

    Uses forward-mode differentiation in all directions at once, like `torch.func.jvp`.
    """
    layers = (len(numbers) - 1) // 2
    value, moved = points, ways
    for layer in range(layers):
        weights, biases = numbers[2 * layer], numbers[2 * layer + 1]
        value = torch.baddbmm(biases, value, weights)
        moved = None if moved is None else _multiply_members(moved, weights)
        if layer < layers - 1:
            gate = torch.sigmoid(value)
            value = value * gate
            moved = None if moved is None else moved * (gate + value * (1.0 - gate))[:, :, None]
    value = value + torch.bmm(points, numbers[-1])
    return value, None if moved is None or ways is None else moved + _multiply_members(ways, numbers[-1])


def tensors_of(networks: Perceptrons, kind: torch.dtype = torch.float32) -> list[Tensor]:
    """Return the parameters of networks as tensors."""
    found, at, sizes = [], 0, networks.sizes.tolist()
    shapes = [shape for one, two in pairwise(sizes) for shape in ((one, two), (1, two))]
    for rows, columns in [*shapes, (sizes[0], sizes[-1])]:
        part = networks.numbers[:, at : at + rows * columns].reshape(-1, rows, columns)
        found.append(torch.tensor(part, dtype=kind))
        at += rows * columns
    return found


def _train(
    numbers: list[Tensor],
    loss: Callable[[], Tensor],
    error: Callable[[], Tensor],
    steps: int,
    rate: float,
    progress: Callable[[tuple[int, int]], None],
) -> tuple[list[Tensor], Tensor, bool]:
    """Adam; the numbers of each network when its error was least. Ctrl-C ends it with those."""
    for part in numbers:
        part.requires_grad_(True)
    optimizer = torch.optim.Adam(numbers, lr=rate, betas=(0.9, 0.99))
    schedule = torch.optim.lr_scheduler.LambdaLR(optimizer, lambda step: _rate(step / steps))
    best, least = [part.detach().clone() for part in numbers], torch.full((len(numbers[0]),), math.inf)
    looks = 60  # So often held-out samples are looked at
    often = max(1, steps // looks)
    try:
        for step in range(steps):
            optimizer.zero_grad(set_to_none=True)
            loss().backward()
            optimizer.step()
            schedule.step()
            if (step + 1) % often == 0 or step == steps - 1:
                with torch.no_grad():
                    now = error()
                    better = (now < least)[:, None, None]
                    kept = [torch.where(better, one, other) for one, other in zip(numbers, best, strict=True)]
                best, least = kept, torch.minimum(now, least)
                progress((step + 1, steps))
    except KeyboardInterrupt:
        return best, least, True
    return best, least, False


def _rate(share: float) -> float:
    """Learning rate as a share of the largest: a short rise, then a cosine."""
    rise = 0.05  # Share of the steps in which the learning rate rises
    return share / rise if share < rise else 0.5 * (1.0 + math.cos(math.pi * (share - rise) / (1.0 - rise)))


def _begin(sizes: list[int], members: int, linear: np.ndarray, draw: torch.Generator) -> list[Tensor]:
    """Random layers that add little at first to the linear map of the samples."""
    found: list[Tensor] = []
    for number, (one, two) in enumerate(pairwise(sizes)):
        last, gain = number == len(sizes) - 2, 1.0 if number == 0 else 2.0
        scale = math.sqrt(gain / one) * (0.1 if last else 1.0)
        found.append(scale * torch.randn(members, one, two, generator=draw))
        found.append(torch.rand(members, 1, two, generator=draw) - 0.5)
    found[-1] = _tensor(linear[-1]).expand(members, 1, -1).clone()
    return [*found, _tensor(linear[:-1]).expand(members, -1, -1).clone()]


def _folds(count: int, options: LearnOptions, draw: torch.Generator) -> tuple[Tensor, Tensor]:
    """For each network which samples it learns from, and which it does not."""
    size, order = max(1, round(options.held_out * count)), torch.randperm(count, generator=draw)
    turns = [order.roll(-size * member) for member in range(options.members)]
    return torch.stack([turn[size:] for turn in turns]), torch.stack([turn[:size] for turn in turns])


def _batches(rows: Tensor, size: int, draw: torch.Generator) -> Iterator[Tensor]:
    """Without end: some of the rows of each network, (members, batch), each once before any comes again."""
    count = rows.shape[1]
    size = min(size, count)
    while True:
        mixed = torch.stack([row[torch.randperm(count, generator=draw)] for row in rows])
        for at in range(0, count - size + 1, size):
            yield mixed[:, at : at + size]


def _multiply_members(ways: Tensor, weights: Tensor) -> Tensor:
    return torch.bmm(ways.flatten(1, 2), weights).unflatten(1, ways.shape[1:3])


def _tensor(values: Float[np.ndarray, "..."]) -> Tensor:
    return torch.tensor(values, dtype=torch.float32)


def _perceptrons(sizes: list[int], numbers: Numbers) -> Perceptrons:
    flat = torch.cat([part.flatten(1) for part in numbers], dim=1)
    return Perceptrons(sizes=np.array(sizes), numbers=flat.double().numpy())


_BETWEEN = 0.5
"""Goals of the inverse network lie up to so far on the way from one sample to another."""
