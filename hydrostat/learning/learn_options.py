"""`LearnOptions`: options for training networks."""

from dataclasses import dataclass
from math import isfinite

from hydrostat.errors import InputError


@dataclass(frozen=True, kw_only=True)
class LearnOptions:
    """Options for training networks. Results with the defaults: docs/decisions/0035-learning.md.

    Attributes:
        members: number of forward networks; each holds out other samples, and their spread is the model's uncertainty.
        width: units in each hidden layer.
        depth: number of hidden layers.
        steps: training steps of the forward networks; if left out, 6,000 plus 3 for each sample.
        inverse_steps: training steps of the inverse network.
        batch: number of samples in a training step.
        rate: peak learning rate; the rate rises, then decays as a cosine.
        jacobians: weight of Jacobian errors relative to value errors; 0 trains on values alone.
        directions: number of random directions in which derivatives are compared, drawn again in each step.
        tensions: weight of tension errors relative to marker errors.
        tension_jacobians: weight of errors of tension derivatives, if the samples have them.
        effort: weight of tension and contraction in the loss of the inverse network; it makes the answer unique.
        held_out: share of the samples that is held out from the training of a network and used to select its weights.
        seed: random seed.
        threads: number of CPU threads for PyTorch.
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
        """Return the number of training steps of the forward networks for a number of samples."""
        return self.steps or 6000 + 3 * samples
