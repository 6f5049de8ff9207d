"""`LearnOptions`: how networks are trained."""

from dataclasses import dataclass
from math import isfinite

from hydrostat.errors import InputError


@dataclass(frozen=True, kw_only=True)
class LearnOptions:
    """Options for training networks. are trained. What the defaults reach: docs/decisions/0035-learning.md.

    Attributes:
        members: forward networks, each of which holds out other samples; their disagreement is the model's doubt.
        width: units in each hidden layer.
        depth: hidden layers.
        steps: steps of training the forward networks; if left out 6,000, and 3 for each sample.
        inverse_steps: steps of training the inverse network.
        batch: samples in a step.
        rate: largest learning rate; it rises, then falls as a cosine.
        jacobians: weight of errors of Jacobians beside those of values; 0 learns from values alone.
        directions: along which derivatives are compared, drawn again in each step.
        tensions: weight of errors of tensions beside those of markers.
        tension_jacobians: weight of errors of their derivatives, where samples hold them.
        effort: weight of tension and contraction in the inverse network, so that its answer is unique.
        held_out: share of the samples that a network does not learn from, but is chosen by.
        seed: random seed.
        threads: cores that PyTorch may use.
    """

    members: int = 3
    width: int = 128
    depth: int = 3
    steps: int | None = None
    inverse_steps: int = 4000
    batch: int = 128
    rate: float = 1e-2
    jacobians: float = 0.1
    directions: int = 3
    tensions: float = 0.1
    tension_jacobians: float = 0.1
    effort: float = 1e-5
    held_out: float = 0.1
    seed: int = 0
    threads: int = 1

    def __post_init__(self) -> None:
        for name in ("members", "width", "depth", "steps", "inverse_steps", "batch", "directions", "threads"):
            if getattr(self, name) is not None and getattr(self, name) < 1:
                raise InputError(f"{name} must be 1 or more, not {getattr(self, name)}")
        for name in ("rate", "jacobians", "tensions", "tension_jacobians", "effort"):
            value = getattr(self, name)
            if not (isfinite(value) and value >= 0) or (name == "rate" and value == 0):
                raise InputError(f"{name} must be {'above 0' if name == 'rate' else '0 or more'}, not {value:g}")
        if not 0 < self.held_out <= 0.5:
            raise InputError(f"held_out must be above 0 and at most 0.5, not {self.held_out:g}")
        if self.seed < 0:
            raise InputError(f"seed must be 0 or more, not {self.seed}")

    def steps_for(self, samples: int) -> int:
        """Return the training steps of the forward networks for a number of samples."""
        return self.steps or 6000 + 3 * samples
