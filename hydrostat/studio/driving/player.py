"""`Player`: the playhead, and how it runs."""

from math import isfinite

from hydrostat.errors import InputError

SPEEDS = (0.1, 4.0)
"""Slowest and fastest, as times the timeline's own."""


class Player:
    """The playhead follows a clock; whoever looks seldom misses what was between, so nothing is ever late.

    Attributes:
        time: of the playhead [s].
        playing: whether it runs.
        loop: whether it begins anew at the end.
        speed: seconds of the timeline in a second.
    """

    def __init__(self) -> None:
        self.time = 0.0
        self.playing = False
        self.loop = True
        self.speed = 1.0
        self._seen: float | None = None

    def play(self, seconds: float) -> None:
        """Run, from the start if it stands at the end of a timeline so long [s]."""
        if self.time >= seconds - 1e-9:
            self.time = 0.0
        self.playing, self._seen = True, None

    def stop(self) -> None:
        """Stand still."""
        self.playing, self._seen = False, None

    def set_speed(self, speed: float) -> None:
        """Run at another speed.

        Raises:
            InputError: it is too slow or too fast.
        """
        if not (isfinite(speed) and SPEEDS[0] <= speed <= SPEEDS[1]):
            raise InputError(f"the speed must be from {SPEEDS[0]:g} to {SPEEDS[1]:g} times, not {speed:g}")
        self.speed = speed

    def advance(self, now: float, seconds: float) -> None:
        """Go on with the clock; at the end begin anew, or stop there.

        Args:
            now: time of the clock [s]; the playhead runs from when it is first told.
            seconds: length of the timeline [s].
        """
        if not self.playing:
            return
        passed = 0.0 if self._seen is None else max(0.0, now - self._seen)
        self._seen = now
        self.time += self.speed * passed
        if self.time >= seconds:
            if self.loop:
                self.time %= seconds
            else:
                self.time = seconds
                self.stop()
