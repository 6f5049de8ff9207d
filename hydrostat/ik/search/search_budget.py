"""`SearchBudget`: deadline of a search, and the callback for its progress."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Self

from hydrostat.errors import InputError

SearchProgress = Callable[[int, float], None]
"""Called with the steps tried so far and the rms error of the best that is known [m]."""


@dataclass(frozen=True, kw_only=True)
class SearchBudget:
    """Deadline of a search, and the callback for its progress; an exception of `tell` ends the search."""

    deadline: float = inf  # deadline on the clock of `time.monotonic` [s]
    tell: SearchProgress | None = None

    @classmethod
    def of(cls, seconds: float | None, tell: SearchProgress | None) -> Self:
        """Patience for so many seconds from now, without end if that is None (InputError: not above 0)."""
        if tell is not None and not callable(tell):
            raise InputError(f"progress must be a function that is called with a step and an error, not {tell!r:.60}")
        if seconds is None:
            return cls(tell=tell)
        if isinstance(seconds, bool) or not isinstance(seconds, int | float) or not seconds > 0:
            raise InputError(f"seconds must be above 0, not {seconds!r}")
        return cls(deadline=time.monotonic() + seconds, tell=tell)

    @property
    def over(self) -> bool:
        """True if the time is up."""
        return time.monotonic() >= self.deadline
