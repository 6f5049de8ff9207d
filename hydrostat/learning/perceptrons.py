"""`Perceptrons`: small networks of one shape, their slopes, and a search on them; no torch is needed to run them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Self, no_type_check

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Vector
from hydrostat.kernel import INNER, KERNEL, njit


@dataclass(frozen=True, kw_only=True, eq=False)
class Perceptrons:
    """Networks of one shape, y = layers(x) + x S: layers with SiLU between them, and a linear map beside them.

    Attributes:
        sizes: of input, hidden layers and output.
        numbers: all of a network in a row: of each layer weights (inputs, outputs) and biases, then S.
    """

    sizes: Int[np.ndarray, " layers"]
    numbers: Float[np.ndarray, "members numbers"]

    def __len__(self) -> int:
        return len(self.numbers)

    @staticmethod
    def count(sizes: Int[np.ndarray, " layers"]) -> int:
        """How many numbers a network has."""
        wide = [int(size) for size in sizes]
        return sum((one + 1) * two for one, two in pairwise(wide)) + wide[0] * wide[-1]

    @classmethod
    def of(cls, arrays: Mapping[str, np.ndarray], name: str, inputs: int, outputs: int) -> Self:
        """Networks of arrays NAME.sizes and NAME.numbers (ValueError: they have not these inputs and outputs)."""
        sizes, numbers = arrays[f"{name}.sizes"], arrays[f"{name}.numbers"]
        if not 2 <= len(sizes) <= _LAYERS or sizes[0] != inputs or sizes[-1] != outputs:
            raise ValueError(f"the {name} network fits no such robot")
        if ((sizes < 1) | (sizes > _WIDEST)).any() or not len(numbers) or numbers.shape[1] != cls.count(sizes):
            raise ValueError(f"the {name} network has wrong sizes")
        return cls(sizes=sizes, numbers=numbers)

    @classmethod
    def of_layers(cls, layers: Sequence[tuple[np.ndarray, np.ndarray]]) -> Self:
        """One network of weights (outputs, inputs) and biases of its layers, with no linear map beside them."""
        sizes = np.array([layers[0][0].shape[1], *(len(offsets) for _, offsets in layers)])
        numbers = [np.concatenate([weights.T.ravel(), offsets]) for weights, offsets in layers]
        return cls(sizes=sizes, numbers=np.concatenate([*numbers, np.zeros(int(sizes[0] * sizes[-1]))])[None])

    def values(self, point: Vector) -> Float[np.ndarray, "members outputs"]:
        """What each network answers at a point."""
        return _values(self.sizes, self.numbers, np.ascontiguousarray(point, dtype=float))

    def agreed(self, point: Vector) -> tuple[Vector, Vector]:
        """The mean answer at a point, and how far the networks are from it: root of the mean square, of each output.

        In single precision, which is what networks are trained and kept in, and takes half as long.
        """
        return _agreed(self.sizes, self._single, np.asarray(point, dtype=np.float32))

    @cached_property
    def _single(self) -> np.ndarray:
        return np.ascontiguousarray(self.numbers, dtype=np.float32)

    def slopes(self, point: Vector) -> tuple[Vector, Float[np.ndarray, "outputs inputs"]]:
        """The mean answer at a point, and its slopes."""
        value, slopes = _mean(self.sizes, self.numbers, np.ascontiguousarray(point, dtype=float))
        return value, slopes.T

    def descend(
        self, start: Vector, goal: Vector, weights: Vector, box: tuple[Vector, Vector] | None = None
    ) -> tuple[Vector, float]:
        """Levenberg-Marquardt from a point in a box to the best one hereabouts, and what is left there.

        Minimises the sum of squares of weights x (mean answer - goal) within the box. The first network leads there,
        all of them finish it.

        Args:
            start: in the box.
            goal: as many numbers as the networks answer.
            weights: 0 where the goal does not matter.
            box: least and most of each input; -1 and 1 if left out.
        """
        low, high = box or (np.full(len(start), -1.0), np.ones(len(start)))
        point = np.clip(start, low, high)
        if len(self) == 1:
            return _descend(self.sizes, self.numbers, point, goal, weights, low, high, _ROUNDS)
        point, _ = _descend(self.sizes, self.numbers[:1], point, goal, weights, low, high, _ROUNDS)
        return _descend(self.sizes, self.numbers, point, goal, weights, low, high, _LAST_ROUNDS)


FINE = {"contract"}  # what of floating point may be rearranged: a product and a sum are one


@njit(fastmath=FINE, **INNER)
@no_type_check
def _answer(sizes, numbers, point, value, slopes):
    """One network at a point; slopes (inputs, outputs) too unless they have no rows."""
    widest, inputs, tangents, kind = sizes.max(), sizes[0], len(slopes), numbers.dtype
    come, gone = np.zeros((1, widest), kind), np.zeros((1, widest), kind)
    old, new, moves, moved, one = come[0], gone[0], np.zeros((tangents, widest), kind), slopes, kind.type(1.0)
    if tangents:
        moved = np.zeros((tangents, widest), kind)
    for each in range(inputs):
        old[each] = point[each]
        if tangents:
            moves[each, each] = one
    at, layers = 0, len(sizes) - 1
    for layer in range(layers):
        rows, columns = sizes[layer], sizes[layer + 1]
        last = at + rows * columns
        _move(numbers[at:last], come, gone, rows, columns)
        for column in range(columns):
            new[column] += numbers[last + column]
        _move(numbers[at:last], moves, moved, rows, columns)
        if layer < layers - 1:
            for column in range(columns):
                gate = one / (one + np.exp(-new[column]))
                out = new[column] * gate
                new[column] = gate + out * (one - gate)  # the slope of SiLU, until it is used
                old[column] = out
            for tangent in range(tangents):
                for column in range(columns):
                    moves[tangent, column] = moved[tangent, column] * new[column]
        at = last + columns
    outputs = sizes[layers]
    for column in range(outputs):
        value[column] = new[column]
        for row in range(inputs):
            value[column] += point[row] * numbers[at + row * outputs + column]
            if tangents:
                slopes[row, column] = moved[row, column] + numbers[at + row * outputs + column]


@njit(fastmath=FINE, **INNER)
@no_type_check
def _move(weights, moves, moved, rows, columns):
    """Rows of moves through a layer: moved = moves @ weights, four rows of weights at a time."""
    for tangent in range(len(moves)):
        out = moved[tangent]
        for column in range(columns):
            out[column] = 0.0
        whole = rows // 4 * 4
        for row in range(0, whole, 4):
            a, b, c, d = moves[tangent, row], moves[tangent, row + 1], moves[tangent, row + 2], moves[tangent, row + 3]
            at = row * columns
            for column in range(columns):
                place = at + column
                out[column] += (a * weights[place] + b * weights[place + columns]) + (
                    c * weights[place + 2 * columns] + d * weights[place + 3 * columns]
                )
        for row in range(whole, rows):
            for column in range(columns):
                out[column] += moves[tangent, row] * weights[row * columns + column]


@njit(**KERNEL)
@no_type_check
def _values(sizes, numbers, point):
    found, none = np.empty((len(numbers), sizes[-1])), np.empty((0, 0))
    for member in range(len(numbers)):
        _answer(sizes, numbers[member], point, found[member], none)
    return found


@njit(**KERNEL)
@no_type_check
def _agreed(sizes, numbers, point):
    members, outputs, kind = len(numbers), sizes[-1], numbers.dtype
    found, none = np.empty((members, outputs), kind), np.empty((0, 0), kind)
    for member in range(members):
        _answer(sizes, numbers[member], point, found[member], none)
    mean, spread = np.zeros(outputs), np.zeros(outputs)
    for column in range(outputs):
        for member in range(members):
            mean[column] += found[member, column] / members
        for member in range(members):
            spread[column] += (found[member, column] - mean[column]) ** 2 / members
        spread[column] = np.sqrt(spread[column])
    return mean, spread


@njit(**KERNEL)
@no_type_check
def _mean(sizes, numbers, point):
    """Mean answer and its slopes (inputs, outputs)."""
    inputs, outputs = sizes[0], sizes[-1]
    value, slopes, one, its = (
        np.zeros(outputs),
        np.zeros((inputs, outputs)),
        np.zeros(outputs),
        np.zeros((inputs, outputs)),
    )
    for member in range(len(numbers)):
        _answer(sizes, numbers[member], point, one, its)
        value += one / len(numbers)
        slopes += its / len(numbers)
    return value, slopes


@njit(**INNER)
@no_type_check
def _left(sizes, numbers, point, goal, weights):
    """Sum of squares that is left at a point."""
    outputs = sizes[-1]
    value, one, none = np.zeros(outputs), np.zeros(outputs), np.empty((0, 0))
    for member in range(len(numbers)):
        _answer(sizes, numbers[member], point, one, none)
        value += one / len(numbers)
    return np.sum((weights * (value - goal)) ** 2)


@njit(**KERNEL)
@no_type_check
def _descend(sizes, numbers, point, goal, weights, low, high, rounds):
    inputs = sizes[0]
    damping, left, step = 1e-3, np.inf, np.zeros(inputs)
    for _ in range(rounds):
        value, slopes = _mean(sizes, numbers, point)
        residual = weights * (value - goal)
        left = np.sum(residual**2)
        normal, gradient = np.zeros((inputs, inputs)), np.zeros(inputs)
        for one in range(inputs):
            for column in range(len(goal)):
                gradient[one] += slopes[one, column] * weights[column] * residual[column]
                for two in range(one + 1):
                    normal[one, two] += slopes[one, column] * slopes[two, column] * weights[column] ** 2
        largest, free = 0.0, 0.0
        for one in range(inputs):
            largest = max(largest, normal[one, one])
        for one in range(inputs):  # what presses against the box stays
            below, above = point[one] <= low[one], point[one] >= high[one]
            step[one] = 0.0 if (below and gradient[one] >= 0.0) or (above and gradient[one] <= 0.0) else 1.0
            free = max(free, step[one] * gradient[one] ** 2)
        if free <= _FLAT * largest * max(left, _FLAT):
            break
        better, moved = False, 0.0
        for _ in range(_TRIES):
            change = _damped(normal, gradient, step, damping, largest)
            trial = np.minimum(np.maximum(point + change, low), high)
            moved = np.max(np.abs(trial - point))
            found = _left(sizes, numbers, trial, goal, weights)
            if found < left:
                better, damping = True, max(0.1 * damping, 1e-9)
                gained, left, point = left - found, found, trial
                break
            damping *= 8.0
        if not better or moved < _STEP or gained < _GAIN * left:
            break
    return point, left


@njit(**INNER)
@no_type_check
def _damped(normal, gradient, free, damping, largest):
    """Solution of (normal + damping) change = -gradient on what is free, by Cholesky's factors."""
    size = len(gradient)
    lower, change = np.zeros((size, size)), np.zeros(size)
    for one in range(size):
        for two in range(one + 1):
            value = normal[one, two] * free[one] * free[two]
            if one == two:
                value += damping * max(normal[one, one], 1e-3 * largest) + (1.0 - free[one]) + _FLAT
            for inner in range(two):
                value -= lower[one, inner] * lower[two, inner]
            lower[one, two] = np.sqrt(max(value, 1e-300)) if one == two else value / lower[two, two]
    for one in range(size):
        value = -gradient[one] * free[one]
        for inner in range(one):
            value -= lower[one, inner] * change[inner]
        change[one] = value / lower[one, one]
    for one in range(size - 1, -1, -1):
        value = change[one]
        for inner in range(one + 1, size):
            value -= lower[inner, one] * change[inner]
        change[one] = value / lower[one, one]
    return change


_ROUNDS = 30
"""Most steps of a descent on one network."""

_LAST_ROUNDS = 5
"""Most steps of all networks together, from where the first one led."""

_TRIES = 8
"""Most dampings tried for one step."""

_STEP = 1e-6
"""A step that changes no contraction by more of half its range is the last."""

_GAIN = 1e-3
"""So is one that takes away less of what is left."""

_FLAT = 1e-14
"""Slopes below this share of what they could be are none."""

_LAYERS, _WIDEST = 64, 100_000
"""Most layers, and most units in one, of networks of a file."""
