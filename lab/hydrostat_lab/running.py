"""`Running`: running mean and deviation of observations, for several seeds at once."""

import torch
from torch import Tensor


class Running:
    """Running mean and deviation of what is observed, one for each seed."""

    def __init__(self, seeds: int, size: int) -> None:
        """Nothing seen yet."""
        self.count = 0.0
        self.sum, self.squares = torch.zeros(seeds, 1, size), torch.zeros(seeds, 1, size)

    def see(self, values: Tensor) -> None:
        """Take values into account, (seeds, many, size)."""
        self.count += values.shape[1]
        self.sum += values.sum(1, keepdim=True)
        self.squares += values.square().sum(1, keepdim=True)

    def __call__(self, values: Tensor) -> Tensor:
        """Values counted from the mean, in units of the deviation (0.01 at least), cut off at 5."""
        many = max(self.count, 1.0)
        mean = self.sum / many
        spread = (self.squares / many - mean.square()).clamp(min=1e-4).sqrt()
        return ((values - mean) / spread).clamp(-5.0, 5.0)
