"""`LearnedShape`: all nodes of a body as a function of the contractions of its winches."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float, Nodes, Vector
from hydrostat.learning import Perceptrons


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnedShape:
    """One shape plus basis shapes, with coordinates from a network of the contractions.

    Attributes:
        low: least contraction of each winch [m].
        high: largest [m].
        network: from contractions, scaled to -1 to 1, to the coordinates.
        mean: shape at coordinates of 0 [m].
        basis: displacement of the nodes for a coordinate of 1 [m].
        samples: number of poses that it was trained on.
        held_out: number of other poses, in which its error was measured.
        error: mean distance of a node from its simulated position in the held-out poses [m].
        worst: largest distance of a node in a pose that 95 % of the held-out poses do not exceed [m].
        moved: mean distance of a node from its place at rest in the held-out poses [m].
        stopped: True if training ended early for lack of time.
    """

    low: Vector
    high: Vector
    network: Perceptrons
    mean: Nodes
    basis: Float[np.ndarray, "coordinates nodes dim"]
    samples: int
    held_out: int
    error: float
    worst: float
    moved: float
    stopped: bool

    def scale_inputs(self, contractions: Vector) -> Vector:
        """Contractions [m] scaled to -1 to 1; 0 for a winch without range."""
        span = self.high - self.low
        return np.where(span > 0, 2.0 * (contractions - self.low) / np.where(span > 0, span, 1.0) - 1.0, 0.0)

    def nodes(self, contractions: Vector) -> Nodes:
        """Positions of the nodes at contractions [m]."""
        coordinates = self.network.values(self.scale_inputs(np.asarray(contractions, dtype=float)))[0]
        return self.mean + np.tensordot(coordinates, self.basis, axes=1)
