"""`learn_shape`: a `LearnedShape` from samples, trained in NumPy: principal components and a small network."""

import time
from itertools import pairwise

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.learning import MIN_SAMPLES, Perceptrons, Samples
from hydrostat.progress import Progress, no_progress
from hydrostat.toy.learned_shape import LearnedShape

Rows = Float[np.ndarray, "samples columns"]


def learn_shape(
    samples: Samples,
    rest: Nodes,
    *,
    steps: int = 8000,
    seconds: float | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> LearnedShape:
    """Train a shape on nine tenths of the samples, and measure its error in the others.

    The loss is the mean square distance of the nodes, as principal components are orthogonal. Adam takes small batches
    at a rate that falls to 0 by a cosine. A constant makes the shape exact at rest. Same samples, same bytes, unless
    the time ends it.

    Args:
        samples: samples with nodes.
        rest: positions of the nodes where all winches are at 0 [m].
        steps: number of training steps.
        seconds: longest time of training [s]; no limit if left out.
        seed: random seed.
        progress: callback for progress.

    Raises:
        InputError: too few samples, or samples without nodes.
    """
    if samples.nodes is None:
        raise InputError("the samples hold no nodes. Sample again with --save-nodes.")
    if len(samples) < MIN_SAMPLES:
        raise InputError(f"{len(samples)} samples are too few. Use {MIN_SAMPLES} or more.")
    low, high = samples.limits
    span = np.where(high > low, high - low, 1.0)
    inputs = np.where(high > low, 2.0 * (np.vstack([samples.contractions, 0.0 * low]) - low) / span - 1.0, 0.0)
    flat = np.vstack([samples.nodes.reshape(len(samples), -1), rest.reshape(1, -1)]).astype(float)
    held_out = max(4, len(samples) // 10)
    train = len(samples) - held_out
    learned = [*range(train), *[-1] * max(1, train // 50)]  # with the rest, which is seen most, some times
    mean = flat[learned].mean(axis=0)
    basis = _principal_components(flat[learned] - mean)
    coordinates = (flat[learned] - mean) @ basis.T
    scale = max(float(np.sqrt(np.mean(np.sum(coordinates**2, axis=1)))), 1e-12)
    trained = _Training(inputs[learned], coordinates / scale, seed)
    stopped = trained.run(steps, seconds, progress or no_progress)
    moves = np.array([trained.network.values(point)[0] for point in inputs[train:]]) * scale @ basis
    mean = flat[-1] - moves[-1]
    shape = (held_out, *rest.shape)
    checked = flat[train:-1]
    distances = np.linalg.norm((moves[:-1] + mean - checked).reshape(shape), axis=2)
    moved = np.linalg.norm((checked - flat[-1]).reshape(shape), axis=2)
    return LearnedShape(
        low=low,
        high=high,
        network=trained.network,
        mean=mean.reshape(rest.shape),
        basis=(scale * basis).reshape(-1, *rest.shape),
        samples=train,
        held_out=held_out,
        error=float(distances.mean()),
        worst=float(np.quantile(distances.max(axis=1), 0.95)),
        moved=float(moved.mean()),
        stopped=stopped,
    )


def _principal_components(rows: Rows) -> Rows:
    """Orthonormal directions, most motion first, until the rest of the motion is below 0.3 % of all of it."""
    values, directions = np.linalg.svd(rows, full_matrices=False)[1:]
    squares = values**2
    rest = 1.0 - np.cumsum(squares) / max(squares.sum(), 1e-300)
    left, most = 3e-3, 48  # root of the share of squares that is left out; most components
    return directions[: min(int(np.argmax(rest <= left**2)) + 1, most)]


class _Training:
    """A network in single precision, and Adam's averages."""

    def __init__(self, inputs: Rows, outputs: Rows, seed: int) -> None:
        self._random = np.random.Generator(np.random.PCG64(seed))
        self._inputs, self._outputs = inputs.astype(np.float32), outputs.astype(np.float32)
        width = 64 if inputs.shape[1] < 5 else 96  # units of each of the two hidden layers
        self._sizes: Int[np.ndarray, " layers"] = np.array([inputs.shape[1], width, width, outputs.shape[1]])
        linear = np.linalg.lstsq(np.hstack([inputs, np.ones((len(inputs), 1))]), outputs, rcond=1e-6)[0]
        gains = (np.sqrt(2.0), np.sqrt(2.0), 0.3)
        self._weights: list[np.ndarray] = []  # weights and biases of each layer in turn, then the linear map
        for (one, two), gain in zip(pairwise(self._sizes.tolist()), gains, strict=True):
            self._weights += [self._random.normal(0.0, gain / np.sqrt(one), (one, two)), np.zeros(two)]
        self._weights[5] = linear[-1]
        self._weights = [each.astype(np.float32) for each in (*self._weights, linear[:-1])]

    @property
    def network(self) -> Perceptrons:
        """Trained network."""
        return Perceptrons(sizes=self._sizes, numbers=np.concatenate([each.ravel() for each in self._weights])[None])

    def run(self, steps: int, seconds: float | None, progress: Progress) -> bool:
        """Train; return True if time ended it early."""
        began, batch = time.monotonic(), min(128, len(self._inputs))
        first, second = ([np.zeros_like(each) for each in self._weights] for _ in range(2))
        fast, slow, tiny, highest = 0.9, 0.999, 1e-8, 3e-3  # of Adam; its highest rate
        for step in range(steps):
            spent = 0.0 if seconds is None else (time.monotonic() - began) / max(seconds, 1e-9)
            share = max(step / steps, spent)
            if share >= 1.0:
                return True
            rate = highest * 0.5 * (1.0 + np.cos(np.pi * share))
            chosen = self._random.integers(0, len(self._inputs), batch)
            gradients = self._gradients(self._inputs[chosen], self._outputs[chosen])
            for weight, gradient, one, two in zip(self._weights, gradients, first, second, strict=True):
                one += (1 - fast) * (gradient - one)
                two += (1 - slow) * (gradient * gradient - two)
                bias = np.sqrt(1 - slow ** (step + 1)) / (1 - fast ** (step + 1))
                weight -= np.float32(rate * bias) * one / (np.sqrt(two) + np.float32(tiny))
            if step % 50 == 0:
                progress("learning", int(share * steps), steps)
        progress("learning", steps, steps)
        return False

    def _gradients(self, inputs: Rows, outputs: Rows) -> list[Vector]:
        """Gradients of the mean square error with all weights."""
        one, one_bias, two, two_bias, last, last_bias, linear = self._weights
        early, early_rate = _silu(inputs @ one + one_bias)
        late, late_rate = _silu(early @ two + two_bias)
        miss = (2.0 / len(inputs)) * (late @ last + last_bias + inputs @ linear - outputs)
        back = miss @ last.T * late_rate
        further = back @ two.T * early_rate
        return [
            inputs.T @ further, further.sum(axis=0), early.T @ back, back.sum(axis=0), late.T @ miss, miss.sum(axis=0),
            inputs.T @ miss,
        ]  # fmt: skip


def _silu(values: Rows) -> tuple[Rows, Rows]:
    """Compute x sigmoid(x) and its derivatives."""
    share = 1.0 / (1.0 + np.exp(-values))
    return values * share, share * (1.0 + values * (1.0 - share))
