"""`Deadline`: the time at which a search ends."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

from hydrostat.design.routes.search_rules import RULES


class TimeUpError(Exception):
    """The time of a search is up."""


@dataclass
class Deadline:
    """The time at which a search ends, by some clock; infinite for a search without a limit."""

    end: float = math.inf  # [s] of the clock
    clock: Callable[[], float] = time.monotonic

    @classmethod
    def after(cls, seconds: float | None, clock: Callable[[], float] = time.monotonic) -> Self:
        """Deadline this many seconds from now; None for no limit."""
        return cls(math.inf if seconds is None else clock() + seconds, clock)

    @property
    def left(self) -> float:
        """Seconds until the deadline; negative once it is over."""
        return self.end - self.clock()

    @property
    def is_over(self) -> bool:
        """True once the time is up."""
        return self.left <= 0.0

    def with_grace(self) -> Self:
        """The deadline of the judgement that follows the search: a second later, or from now if it is over."""
        return type(self)(max(self.end, self.clock()) + RULES.grace, self.clock)
