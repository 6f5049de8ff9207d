"""`timeline_table`, `read_timeline`: a timeline as the table of contractions that every command reads."""

from dataclasses import replace
from pathlib import PurePath

import numpy as np

from hydrostat.control.timeline import LONGEST, SAME, SHORTEST, Key, Timeline
from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.simulation import Profile, ProfileTable, profile_text

STEP = 0.02  # a table is read along lines, so a smooth timeline is written in steps of this time [s]
LARGEST = 4_000_000  # no table has more bytes


def timeline_table(robot: Robot, timeline: Timeline) -> bytes:
    """Contractions in time as a CSV of seconds and millimetres; see `ProfileTable` (InputError: no keyframes)."""
    if not timeline.keys:
        raise InputError("there are no keyframes to export; turn the knobs and press Add")
    profile = timeline.profile([winch.name for winch in robot.winches])
    times = _times(timeline)
    return profile_text(robot, Profile(times=times, values=np.array([profile.at(time) for time in times])))


def read_timeline(robot: Robot, name: str, content: bytes) -> Timeline:
    """Read a timeline from the table of a named file, its times counted from its first row.

    Raises:
        InputError: it is too large, or no such table; the text names the line.
    """
    if len(content) > LARGEST:
        raise InputError(f"{name}: a table may have {LARGEST / 1e6:g} MB, not {len(content) / 1e6:.1f} MB")
    shown = PurePath(name.replace("\\", "/")).name or "table"
    profile = ProfileTable.read(content, robot, name=shown).profile
    times = profile.times - profile.times[0]
    if times[-1] > LONGEST:
        raise InputError(f"{shown}: it lasts {times[-1]:.1f} s; a timeline may last {LONGEST:g} s")
    names = [winch.name for winch in robot.winches]
    kept = _needed(times, profile.values)
    keys = tuple(
        Key(time=float(times[row]), contractions=dict(zip(names, profile.values[row].tolist(), strict=True)))
        for row in kept
    )
    try:
        timeline = Timeline(keys=keys)
    except InputError as error:
        raise InputError(f"{shown}: {error}") from None
    return replace(timeline, length=max(float(times[-1]), SHORTEST)) if len(keys) > 1 else timeline


def _times(timeline: Timeline) -> np.ndarray:
    """Rows of the table: the keys, where it ends, and what lies between if it is smooth."""
    times = [key.time for key in timeline.keys]
    if timeline.smooth:
        steps = max(1, round((times[-1] - times[0]) / STEP))
        times += np.linspace(times[0], times[-1], steps + 1).tolist()
    if timeline.seconds > timeline.keys[-1].time + SAME:
        times.append(timeline.seconds)
    rows = np.unique(np.round(times, 6))
    return rows[np.append(True, np.diff(rows) > 1e-4)]


def _needed(times: np.ndarray, values: np.ndarray, *, off: float = 2e-5) -> list[int]:
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
        if misses.max() > off:
            kept.add(worst)
            spans += [(start, worst), (worst, end)]
    return sorted(kept)
