"""`Timeline`: contractions by hand, in time (R58)."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Self

from hydrostat.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Key:
    """What winches take in at one time.

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
    """

    keys: tuple[Key, ...] = field(default=())
    smooth: bool = False

    def __post_init__(self) -> None:
        times = [key.time for key in self.keys]
        if any(later <= earlier for earlier, later in zip(times, times[1:], strict=False)):
            raise InputError("keyframes must come in the order of their times, no two at the same time")

    @property
    def seconds(self) -> float:
        """Time of the last key [s]."""
        return self.keys[-1].time if self.keys else 0.0

    def with_key(self, key: Key) -> Self:
        """The same with one more key, in place of one at the same time."""
        others = [other for other in self.keys if abs(other.time - key.time) > SAME]
        return replace(self, keys=tuple(sorted([*others, key], key=lambda other: other.time)))

    def without(self, index: int) -> Self:
        """The same without one key."""
        return replace(self, keys=self.keys[:index] + self.keys[index + 1 :])


LONGEST = 600.0
"""No timeline is longer [s]."""

SAME = 5e-3
"""Keys closer in time than this [s] are one."""
