"""`Perceptrons`: small networks of one shape, their derivatives, and a search on them. Runs without torch."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Self

import numpy as np

from hydrostat.arrays import Float, Int, Vector
from hydrostat.kernel import native


@dataclass(frozen=True, kw_only=True, eq=False)
class Perceptrons:
    """Networks of the same shape, y = layers(x) + x S: layers with SiLU between them, plus a linear skip connection S.

    Attributes:
        sizes: number of inputs, units of each hidden layer, and outputs.
        numbers: parameters, one row for each network: weights (inputs, outputs) and biases of each layer, then S.
    """

    sizes: Int[np.ndarray, " layers"]
    numbers: Float[np.ndarray, "members numbers"]

    def __len__(self) -> int:
        return len(self.numbers)

    @staticmethod
    def count(sizes: Int[np.ndarray, " layers"]) -> int:
        """Return the number of parameters of a network."""
        wide = [int(size) for size in sizes]
        return sum((one + 1) * two for one, two in pairwise(wide)) + wide[0] * wide[-1]

    @classmethod
    def of(cls, arrays: Mapping[str, np.ndarray], name: str, inputs: int, outputs: int) -> Self:
        """Return networks from the arrays NAME.sizes and NAME.numbers (ValueError: wrong inputs or outputs)."""
        sizes, numbers = arrays[f"{name}.sizes"], arrays[f"{name}.numbers"]
        layers, widest = 64, 100_000  # Most layers, and most units in one, of networks of a file
        if not 2 <= len(sizes) <= layers or sizes[0] != inputs or sizes[-1] != outputs:
            raise ValueError(f"the {name} network fits no such robot")
        if ((sizes < 1) | (sizes > widest)).any() or not len(numbers) or numbers.shape[1] != cls.count(sizes):
            raise ValueError(f"the {name} network has wrong sizes")
        return cls(sizes=sizes, numbers=numbers)

    @classmethod
    def of_layers(cls, layers: Sequence[tuple[np.ndarray, np.ndarray]]) -> Self:
        """Return one network from the weights (outputs, inputs) and biases of its layers, without a skip connection."""
        sizes = np.array([layers[0][0].shape[1], *(len(offsets) for _, offsets in layers)])
        numbers = [np.concatenate([weights.T.ravel(), offsets]) for weights, offsets in layers]
        return cls(sizes=sizes, numbers=np.concatenate([*numbers, np.zeros(int(sizes[0] * sizes[-1]))])[None])

    def values(self, point: Vector) -> Float[np.ndarray, "members outputs"]:
        """Return the outputs of each network at a point."""
        found = np.empty((len(self), self.sizes[-1]))
        native.network_values(self.sizes, self.numbers, np.ascontiguousarray(point, dtype=float), found)
        return found

    def average_members(self, point: Vector) -> tuple[Vector, Vector]:
        """Return the mean output of the networks at a point, and their root-mean-square deviation from it.

        Uses single precision, as in training and in the file; it takes half the time.
        """
        mean, spread = np.empty(self.sizes[-1]), np.empty(self.sizes[-1])
        native.network_agreement(self.sizes, self._single, np.asarray(point, dtype=np.float32), mean, spread)
        return mean, spread

    @cached_property
    def _single(self) -> np.ndarray:
        return np.ascontiguousarray(self.numbers, dtype=np.float32)

    def evaluate(self, point: Vector) -> tuple[Vector, Float[np.ndarray, "outputs inputs"]]:
        """Return the mean output at a point, and its derivatives."""
        value, derivatives = np.empty(self.sizes[-1]), np.empty((self.sizes[0], self.sizes[-1]))
        native.network_mean(self.sizes, self.numbers, np.ascontiguousarray(point, dtype=float), value, derivatives)
        return value, derivatives.T

    def descend(
        self, start: Vector, goal: Vector, weights: Vector, box: tuple[Vector, Vector] | None = None
    ) -> tuple[Vector, float]:
        """Run Levenberg-Marquardt from a point in a box to a local optimum; return the optimum and its residual.

        Minimizes the sum of squares of weights x (mean output - goal) within the box. The first network alone makes the
        first steps, the mean of all networks the last.

        Args:
            start: start point, inside the box.
            goal: target value of each output.
            weights: weight of each output; 0 to ignore it.
            box: lower and upper bound of each input; -1 and 1 if left out.
        """
        low, high = box or (np.full(len(start), -1.0), np.ones(len(start)))
        point = np.clip(start, low, high)
        given = [np.ascontiguousarray(array, dtype=float) for array in (goal, weights, low, high)]
        rounds = 30  # Most steps of a descent on one network
        left = native.network_descent(self.sizes, self.numbers[:1], point, *given, rounds)
        last_rounds = 5  # Most steps of all networks together, from where the first one led
        if len(self) > 1:
            left = native.network_descent(self.sizes, self.numbers, point, *given, last_rounds)
        return point, left
