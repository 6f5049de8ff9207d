"""`Timeline`: contractions by hand, in time (R58)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import isfinite
from typing import Self

import numpy as np

from hydrostat.errors import InputError
from hydrostat.simulation import Profile


@dataclass(frozen=True, kw_only=True)
class Key:
    """Contractions of winches at one time.

    Attributes:
        time: since the start [s].
        contractions: by the name of the winch [m]; others take in nothing.
    """

    time: float
    contractions: Mapping[str, float]

    def __post_init__(self) -> None:
        if not (isfinite(self.time) and 0 <= self.time <= LONGEST):
            raise InputError(f"the time of a keyframe must be from 0 to {LONGEST:g} s, not {self.time:g}")
        for name, value in self.contractions.items():
            if not isfinite(value):
                raise InputError(f"keyframe at {self.time:g} s: the contraction of {name} is not a finite number")


@dataclass(frozen=True, kw_only=True)
class Timeline:
    """Keyframes in the order of their times, no two at the same time.

    Attributes:
        keys: of all winches.
        smooth: gently from key to key, rather than along a line.
        length: it goes on so long [s], or to its last key if that is later.
    """

    keys: tuple[Key, ...] = field(default=())
    smooth: bool = False
    length: float = 4.0

    def __post_init__(self) -> None:
        times = [key.time for key in self.keys]
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise InputError("keyframes must come in the order of their times, no two at the same time")
        if len(times) > MOST_KEYS:
            raise InputError(f"a timeline may have {MOST_KEYS} keyframes, not {len(times)}")
        if not (isfinite(self.length) and SHORTEST <= self.length <= LONGEST):
            raise InputError(f"a timeline must be from {SHORTEST:g} to {LONGEST:g} s long, not {self.length:g} s")

    @property
    def seconds(self) -> float:
        """Length in time [s]."""
        return max(self.length, self.keys[-1].time if self.keys else 0.0)

    def profile(self, winches: Sequence[str]) -> Profile:
        """Contractions in time of these winches, a column each; nothing is taken in where there is no key."""
        keys = self.keys or (Key(time=0.0, contractions={}),)
        values = [[key.contractions.get(name, 0.0) for name in winches] for key in keys]
        return Profile(
            times=np.array([key.time for key in keys]),
            values=np.array(values, dtype=float).reshape(len(keys), len(winches)),
            gentle=self.smooth,
        )

    def index_at(self, time: float) -> int | None:
        """Number of the key at a time [s]; None if there is none."""
        return next((index for index, key in enumerate(self.keys) if abs(key.time - time) <= SAME), None)

    def with_key(self, key: Key) -> Self:
        """The same with one more key, in place of one at the same time."""
        others = [other for other in self.keys if abs(other.time - key.time) > SAME]
        return replace(self, keys=tuple(sorted([*others, key], key=lambda other: other.time)))

    def without(self, index: int) -> Self:
        """The same without one key."""
        return replace(self, keys=self.keys[:index] + self.keys[index + 1 :])

    def moved(self, index: int, time: float) -> Self:
        """The same with one key at another time [s], in place of one that is there."""
        return self.without(index).with_key(replace(self.keys[index], time=time))


SHORTEST, LONGEST = 0.1, 600.0  # no timeline is shorter, none longer [s]
SAME = 5e-3  # keys closer in time than this [s] are one
MOST_KEYS = 2000  # no timeline has more
