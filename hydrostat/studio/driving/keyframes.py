"""`Keyframes`: the timeline of the open robot, edited by hand."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import isfinite

from hydrostat.control import MAX_DURATION, Key, Timeline
from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.studio.document import Document


@dataclass(frozen=True, kw_only=True, eq=False)
class _DraggedKey:
    """A key that is dragged."""

    index: int  # its number before
    before: Timeline  # the timeline then
    made: Timeline  # the timeline that its last move has made; if the robot has another by now, the drag is over


class Keyframes:
    """Adds, moves, copies and removes keys; every change can be undone, and a drag is one change."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._chosen: tuple[Robot, float] | None = None
        self._held: _DraggedKey | None = None

    @property
    def timeline(self) -> Timeline:
        """Keyframes as they are now."""
        return self._document.work.timeline

    @property
    def chosen_index(self) -> int | None:
        """Number of the key that is selected; it follows the knobs, and is one of this robot."""
        chosen = self._chosen
        if chosen is None or chosen[0] is not self._document.robot:
            return None
        return self.timeline.index_at(chosen[1])

    def choose(self, index: int | None) -> None:
        """Select a key, or none (InputError: there is no such key)."""
        self._choose(None if index is None else self._key(index).time)

    def add_key(self, time: float, contractions: Mapping[str, float]) -> None:
        """Add a key and select it; one that is at the same time is replaced (InputError: the time is out of range)."""
        timeline = self.timeline.with_key(Key(time=time, contractions=dict(contractions)))
        self._document.change(f"add keyframe at {time:.2f} s", timeline=timeline)
        self._choose(time)

    def adjust(self, contractions: Mapping[str, float]) -> None:
        """Let the key that is selected have other contractions; changes in a row are one."""
        if (index := self.chosen_index) is not None:
            key = replace(self._key(index), contractions=dict(contractions))
            self._document.change(
                f"change keyframe at {key.time:.2f} s",
                timeline=self.timeline.with_key(key),
                merge=f"adjust key {key.time:.6f}",
            )

    def move(self, index: int, time: float) -> float:
        """Drag a key to a time [s]; where it went (InputError: no such key or time). It ends with `drop`.

        A key that it comes upon is replaced, but stays if the drag goes on.
        """
        if not isfinite(time):
            raise InputError("the time of a keyframe must be a number of seconds")
        held = self._held
        if held is None or held.index != index or held.made is not self.timeline:  # not what this drag has made
            self._key(index)
            self._document.seal()
            held = _DraggedKey(index=index, before=self.timeline, made=self.timeline)
        before = held.before
        time = min(max(time, 0.0), before.seconds)
        timeline = replace(before.move_key(index, time), length=before.seconds)
        self._held = replace(held, made=timeline)
        self._document.change(f"move keyframe to {time:.2f} s", timeline=timeline, merge="move key")
        self._choose(time)
        return time

    def drop(self) -> None:
        """A drag is over."""
        self._held = None
        self._document.seal()

    def duplicate(self) -> float:
        """Copy the selected key to the next free time [s]; select and return that (InputError: no key or place)."""
        key = self._key(self.chosen_index)
        apart = 0.5  # a copy of a key is put so much later [s]
        time = key.time + apart
        while self.timeline.index_at(time) is not None:
            time += apart
        if time > MAX_DURATION:
            raise InputError(f"no free time for another keyframe before {MAX_DURATION:g} s. Move or delete one")
        self._document.change("duplicate keyframe", timeline=self.timeline.with_key(replace(key, time=time)))
        self._choose(time)
        return time

    def delete(self) -> None:
        """Remove the key that is selected (InputError: none is)."""
        key = self._key(self.chosen_index)
        assert self.chosen_index is not None
        self._document.change(f"delete keyframe at {key.time:.2f} s", timeline=self.timeline.without(self.chosen_index))
        self._chosen = None

    def replace_all(self, timeline: Timeline, label: str) -> None:
        """Put another timeline in place of this one."""
        self._chosen = self._held = None
        self._document.change(label, timeline=timeline)

    def set_smooth(self, smooth: bool) -> None:
        """Go gently from key to key, or along a line."""
        if smooth != self.timeline.smooth:
            label = "interpolate smoothly" if smooth else "interpolate linearly"
            self._document.change(label, timeline=replace(self.timeline, smooth=smooth))

    def set_length(self, seconds: float) -> None:
        """Make the timeline longer or shorter [s] (InputError: it is too short, too long, or shorter than its keys)."""
        last = self.timeline.keys[-1].time if self.timeline.keys else 0.0
        if seconds < last:
            raise InputError(f"the last keyframe is at {last:.2f} s. Move or delete it before you shorten the timeline")
        if seconds != self.timeline.length:
            timeline = replace(self.timeline, length=seconds)
            self._document.change(f"set length to {seconds:g} s", timeline=timeline, merge="set length")

    def _choose(self, time: float | None) -> None:
        self._chosen = None if time is None else (self._document.robot, time)

    def _key(self, index: int | None) -> Key:
        if index is None:
            raise InputError("no keyframe selected. Click the diamond of one")
        if not 0 <= index < len(self.timeline.keys):
            raise InputError(f"unknown keyframe {index + 1}. Available: 1 to {len(self.timeline.keys)}")
        return self.timeline.keys[index]
