"""`Timeline`: keyframes of contractions, and their table as a CSV."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import isfinite
from pathlib import PurePath
from typing import Self

import numpy as np

from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.simulation import ContractionProfile, ProfileTable


@dataclass(frozen=True, kw_only=True)
class Key:
    """Contractions of winches at one time."""

    time: float  # since the start [s]
    contractions: Mapping[str, float]  # by the name of the winch [m]; others take in nothing

    def __post_init__(self) -> None:
        if not (isfinite(self.time) and 0 <= self.time <= MAX_DURATION):
            raise InputError(f"the time of a keyframe must be from 0 to {MAX_DURATION:g} s, not {self.time:g}")
        for name, value in self.contractions.items():
            if not isfinite(value):
                raise InputError(f"keyframe at {self.time:g} s: the contraction of {name} is not a finite number")


@dataclass(frozen=True, kw_only=True)
class Timeline:
    """Keyframes in order of their times, at most one at a time."""

    keys: tuple[Key, ...] = field(default=())  # of all winches
    smooth: bool = False  # gently from key to key, rather than along a line
    length: float = 4.0  # it goes on so long [s], or to its last key if that is later

    def __post_init__(self) -> None:
        times = [key.time for key in self.keys]
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise InputError("keyframes must come in the order of their times, no two at the same time")
        if len(times) > MAX_KEYS:
            raise InputError(f"a timeline may have {MAX_KEYS} keyframes, not {len(times)}")
        if not (isfinite(self.length) and MIN_DURATION <= self.length <= MAX_DURATION):
            raise InputError(
                f"a timeline must be from {MIN_DURATION:g} to {MAX_DURATION:g} s long, not {self.length:g} s"
            )

    @property
    def seconds(self) -> float:
        """Duration [s]."""
        return max(self.length, self.keys[-1].time if self.keys else 0.0)

    def profile(self, winches: Sequence[str]) -> ContractionProfile:
        """Return the contractions of these winches in time, one column each; 0 where a winch has no key."""
        keys = self.keys or (Key(time=0.0, contractions={}),)
        values = [[key.contractions.get(name, 0.0) for name in winches] for key in keys]
        return ContractionProfile(
            times=np.array([key.time for key in keys]),
            values=np.array(values, dtype=float).reshape(len(keys), len(winches)),
            gentle=self.smooth,
        )

    def index_at(self, time: float) -> int | None:
        """Return the index of the key at a time [s]; None without one."""
        return next((index for index, key in enumerate(self.keys) if abs(key.time - time) <= KEY_TOLERANCE), None)

    def with_key(self, key: Key) -> Self:
        """Return a timeline with one more key; it replaces a key at the same time."""
        others = [other for other in self.keys if abs(other.time - key.time) > KEY_TOLERANCE]
        return replace(self, keys=tuple(sorted([*others, key], key=lambda other: other.time)))

    def without(self, index: int) -> Self:
        """Return a timeline without one key."""
        return replace(self, keys=self.keys[:index] + self.keys[index + 1 :])

    def move_key(self, index: int, time: float) -> Self:
        """Return a timeline with one key at another time [s]; it replaces a key at that time."""
        return self.without(index).with_key(replace(self.keys[index], time=time))

    @staticmethod
    def read(robot: Robot, name: str, content: bytes) -> "Timeline":
        """Read a timeline from the table of a named file, with times from its first row.

        The InputError for an invalid or too large table names the line.
        """
        if len(content) > MAX_BYTES:
            raise InputError(f"{name}: a table may have {MAX_BYTES / 1e6:g} MB, not {len(content) / 1e6:.1f} MB")
        shown = PurePath(name.replace("\\", "/")).name or "table"
        profile = ProfileTable.read(content, robot, name=shown).profile
        times = profile.times - profile.times[0]
        if times[-1] > MAX_DURATION:
            raise InputError(f"{shown}: it lasts {times[-1]:.6g} s; a timeline may last {MAX_DURATION:g} s")
        names = [winch.name for winch in robot.winches]
        kept = _essential_rows(times, profile.values)
        keys = tuple(
            Key(time=float(times[row]), contractions=dict(zip(names, profile.values[row].tolist(), strict=True)))
            for row in kept
        )
        try:
            timeline = Timeline(keys=keys)
        except InputError as error:
            raise InputError(f"{shown}: {error}") from None
        return replace(timeline, length=max(float(times[-1]), MIN_DURATION)) if len(keys) > 1 else timeline

    def table(self, robot: Robot) -> bytes:
        """Return the timeline as a CSV of seconds and millimeters; see `ProfileTable` (InputError: no keyframes)."""
        if not self.keys:
            raise InputError("there are no keyframes to export; turn the knobs and press Add")
        profile = self.profile([winch.name for winch in robot.winches])
        times = _times(self)
        return ContractionProfile(times=times, values=np.array([profile.at(time) for time in times])).text(robot)


MIN_DURATION, MAX_DURATION = 0.1, 600.0  # no timeline is shorter, none longer [s]
KEY_TOLERANCE = 5e-3  # keys closer in time than this [s] are one
MAX_KEYS = 2000  # no timeline has more


STEP = 0.02  # a table is read along lines, so a smooth timeline is written in steps of this time [s]
MAX_BYTES = 4_000_000  # no table has more bytes


def _times(timeline: Timeline) -> np.ndarray:
    """Rows of the table: the keys, where it ends, and what lies between if it is smooth."""
    times = [key.time for key in timeline.keys]
    if timeline.smooth:
        steps = max(1, round((times[-1] - times[0]) / STEP))
        times += np.linspace(times[0], times[-1], steps + 1).tolist()
    if timeline.seconds > timeline.keys[-1].time + KEY_TOLERANCE:
        times.append(timeline.seconds)
    rows = np.unique(np.round(times, 6))
    return rows[np.append(True, np.diff(rows) > 1e-4)]


def _essential_rows(times: np.ndarray, values: np.ndarray) -> list[int]:
    """Rows that lines between cannot do without, to 0.02 mm: the row that is off most is kept, then again each side."""
    kept, spans = {0, len(times) - 1}, [(0, len(times) - 1)]
    while spans:
        start, end = spans.pop()
        if end - start < 2:
            continue
        share = ((times[start + 1 : end] - times[start]) / (times[end] - times[start]))[:, None]
        line = (1 - share) * values[start] + share * values[end]
        misses = np.abs(values[start + 1 : end] - line).max(axis=1, initial=0.0)
        worst = start + 1 + int(misses.argmax())
        if misses.max() > 2e-5:
            kept.add(worst)
            spans += [(start, worst), (worst, end)]
    return sorted(kept)
